"""The failures of methods: a line for each one, with its criterion, the prediction of theory, and the measurement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from derive.study.methods.method_study import MethodStudy
from derive.study.methods.scene_methods import Method
from derive.study.methods.step_limits import LONGEST
from derive.study.table import StudyColumn, StudyTable
from derive.terminal import magnitude, wrapped

MET = 1e-9
"""Constraints (m, rad) are met below this."""
ORDER = 0.7
"""A measured power of the step may be less than the order of a method by this."""
NEAR = 0.05
"""A measured value agrees with a predicted one within this part."""


@dataclass(frozen=True)
class MethodFailure:
    """A failure of methods: the criterion by theory, the measurement as text, and whether they agree.

    agrees: None where the theory does not apply to the scene, as `measured` says.
    """

    failure: str
    criterion: str
    measured: str
    agrees: bool | None

    @property
    def verdict(self) -> str:
        """The text of the verdict."""
        return {True: "agrees", False: "DIFFERS", None: "does not apply"}[self.agrees]


COLUMNS = (StudyColumn("failure"), StudyColumn("criterion"), StudyColumn("measured"), StudyColumn("agrees"))


def failure_table(of: Sequence[MethodFailure]) -> StudyTable:
    """The table with a row for each failure."""
    return StudyTable(COLUMNS, tuple((f.failure, f.criterion, f.measured, f.agrees) for f in of))


def failure_lines(of: Sequence[MethodFailure]) -> list[str]:
    """The lines of text on each failure: its criterion, the verdict, and the measurement."""
    lines = ["where methods fail: the criterion, and the measurement on this scene"]
    for failure in of:
        lines += wrapped([f"{failure.failure}: {failure.criterion}"], "  ")
        lines += wrapped([f"{failure.verdict}: {failure.measured}"], "      ")
    return lines


def failures(study: MethodStudy) -> tuple[MethodFailure, ...]:
    """The failures of methods, each with the measurements of this study."""
    return tuple(line for line in (_step_limit(study), _drift(study)) if line)


def _step_limit(study: MethodStudy) -> MethodFailure | None:
    limited = [line for line in study.limits if line.method in (Method.RK4, Method.ADAPTIVE)]
    if not limited:
        return None
    theory = ", ".join(f"{line.theory:.3g} ({line.method.value})" for line in limited)
    measured = "; ".join(
        f"{line.method.value}: {line.measured:.3g} s, which is {line.ratio:.3f} of the theory; steps of 0.95 of the "
        f"theory are {'stable' if line.below else 'unstable'}, steps of 1.05 are "
        f"{'stable' if line.above else 'unstable'}"
        for line in limited
    )
    agrees: bool | None = all(line.below and not line.above and abs(line.ratio - 1) < NEAR for line in limited)
    longest = max(line.predicted for line in limited)
    if not agrees and longest > study.period / LONGEST:
        measured += f"; steps of {longest:.2g} s resolve neither the motion of {study.period:.2g} s nor its frequencies"
        agrees = None
    elif not agrees and not study.conserved:
        measured += "; the theory assumes undamped vibrations, but this scene does not conserve energy"
        agrees = None
    return MethodFailure("explicit step limit", f"omega_max h < {theory}", measured, agrees)


def _drift(study: MethodStudy) -> MethodFailure | None:
    projected = next((r for r in study.drifts if r.method is Method.RK4 and r.projected and len(r.t)), None)
    if study.order is None or projected is None:
        return None
    free = study.order
    measured = (
        f"rk4: without projection {magnitude(free.position)} m after {free.steps} steps, growing as t^{free.time:.1f} "
        f"and h^{free.step:.1f}; with projection at most {magnitude(projected.position[-1])} m in "
        f"{projected.steps} steps"
    )
    less, slow = projected.position[-1] < free.position, free.time < 2 + ORDER
    agrees: bool | None = bool(projected.position[-1] < MET and less and slow and free.step > 4 - ORDER)
    if not agrees and free.kinks:
        times = ", ".join(f"{time:.4g}" for time in free.kinks)
        measured += f"; the theory assumes smooth motions, but functions of time have kinks at t = {times} s"
        agrees = None
    criterion = "acceleration-level drift grows at most as t^2, and as h^4 or a higher power"
    return MethodFailure("index 3 drift", criterion, measured, agrees)
