"""The numbers of a study of methods: as tables, as CSV, and as plain data."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from math import isfinite
from typing import Any

import numpy as np

from derive.percentages import percent
from derive.study.methods.drift import exponent
from derive.study.methods.failures import MethodFailure, failures
from derive.study.methods.formulations import FORM_NAMES
from derive.study.methods.free_flight import AMPLITUDE
from derive.study.methods.method_study import MethodStudy
from derive.study.methods.stability_functions import bdf, last_growth
from derive.study.methods.step_control import PHASES
from derive.study.methods.step_limits import GROWN, LARGE, STEPS, StepLimit
from derive.terminal import magnitude, table, wrapped


@dataclass(frozen=True)
class StudyTable:
    """A table: its title, its head and its rows, with the first `left` columns left-aligned; notes below it."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    left: int = 1
    notes: tuple[str, ...] = ()


def tables(study: MethodStudy) -> tuple[StudyTable, ...]:
    """All tables of a study."""
    made = (
        _limits(study),
        _controls(study),
        _drift(study),
        _forms(study),
        _conditioning(study),
        _ringing(study),
        _dead_centres(study),
    )
    return tuple(one for one in (*made, _momentum(study), _bases(study)) if one.rows)


def methods_text(study: MethodStudy) -> str:
    """The text of the tables, and of the failures with the measurements of each."""
    lines = [f"{study.name}: stability of methods"]
    for one in tables(study):
        lines += ["", one.title, *table([one.head, *one.rows], one.left), *wrapped(one.notes, "  ")]
    lines += ["", "where methods fail: criterion, and what was measured here"]
    for line in failures(study):
        lines += wrapped([f"{line.failure}: {line.criterion}"], "  ")
        lines += wrapped([f"{line.verdict}: {line.measured}"], "      ")
    return "\n".join([*lines, *wrapped(study.notes)])


def methods_csv(study: MethodStudy) -> str:
    """The CSV text with a row for each failure."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([field.name for field in fields(MethodFailure)])
    writer.writerows((f.failure, f.criterion, f.measured, f.agrees) for f in failures(study))
    return stream.getvalue()


def methods_data(study: MethodStudy) -> dict[str, Any]:
    """All numbers as plain data; a number that is not finite becomes None."""
    data: dict[str, Any] = _plain(study)
    return {**data, "failures": _plain(failures(study))}


def _plain(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.value
    if is_dataclass(value):
        return {field.name: _plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, np.ndarray | list | tuple):
        return [_plain(x) for x in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def _limits(study: MethodStudy) -> StudyTable:
    rows: list[tuple[str, ...]] = []
    for line in study.limits:
        if isfinite(line.theory):
            cells = (f"{line.theory:.4g}", _seconds(line.predicted), _seconds(line.measured), f"{line.ratio:.3f}")
            rows.append((line.method.value, *cells, _grows(line.below), _grows(line.above), f"{line.growth:.5g}"))
        else:
            rows.append((line.method.value, "no limit", "", _tried(study, line), "", "", "", ""))
    w = study.frequency
    title = (
        f"largest stable step; omega_max {w.unloaded:.0f} rad/s undeformed at rest, {w.largest:.0f} at most in "
        f"{study.along}"
    )
    head = (
        "integrator",
        "omega h",
        "theory, s",
        "experiment, s",
        "ratio",
        "at 0.95",
        "at 1.05",
        "growth per step at 1.05",
    )
    return StudyTable(title, head, tuple(rows), 1, (EXPERIMENT, _bdf_note()))


def _bdf_note() -> str:
    """The note on the theory of the formulas of IDA, which have no fixed step that could be tried."""
    last = {order: last_growth(bdf(order)) for order in range(1, 6)}
    growing = ", ".join(f"{y:.2f} (order {order})" for order, y in last.items() if y)
    return f"ida and c_ida choose steps and orders by their tolerance: vibrations grow with omega h up to {growing}"


EXPERIMENT = (
    f"experiment: the longest step with which a disturbance of the fastest mode grows by less than {GROWN:g} times in "
    f"{STEPS} steps, from the state with the highest frequency"
)


def _tried(study: MethodStudy, line: StepLimit) -> str:
    if not line.measured:
        return f"grows at omega h = {LARGE[-1]:g}"
    return f">= {_seconds(line.measured)}"


def _grows(stable: bool | None) -> str:
    return "" if stable is None else "stable" if stable else "grows"


def _seconds(h: float) -> str:
    return f"{h:.3e}"


def _controls(study: MethodStudy) -> StudyTable:
    rows = [
        (f"{c.product:g}", magnitude(c.classical), f"{c.own:.2f}", f"{c.interpolated:.1f}", f"{c.row:.2f}")
        for c in study.controls
    ]
    title = f"errors of a vibration over their estimates, adaptive steps, worst of {len(PHASES)} phases"
    head = ("omega h", "step, as SciPy's DOP853", "step", "row, interpolated", "row")
    notes = (
        "row, interpolated: the largest error within the step, over the estimate of the step; row: with a shorter step "
        "where the estimate of the interpolant asks for it",
    )
    return StudyTable(title, head, tuple(rows), 0, notes)


def _drift(study: MethodStudy) -> StudyTable:
    rows: list[tuple[str, ...]] = []
    for run in study.drifts:
        if not len(run.t):
            rows.append((run.label, "0", "", "", "", "", "", run.failure))
            continue
        lost = magnitude(run.energy[-1]) if len(run.energy) else ""
        powers = [_power(exponent(run.t, of)) for of in (run.position, run.energy)]
        cells = (magnitude(run.position[-1]), powers[0], magnitude(run.velocity[-1]), lost, powers[1])
        rows.append((run.label, str(run.steps), *cells, run.failure and f"fails after {run.t[-1]:.3g} s"))
    title = f"drift over {study.steps} steps of {_seconds(study.h)} s, half the limit of rk4"
    head = ("method", "steps", "|g|", "as t^", "|gdot|", "energy", "as t^", "")
    notes = [
        "|g| (m, rad) and |gdot| (m/s, rad/s): the largest; energy: |E - E0 - W| over the largest kinetic energy, with "
        "the work W of the drives"
    ]
    notes += filter(None, [study.missing_energies])
    if any(len(run.t) and not isfinite(exponent(run.t, run.position)) for run in study.drifts):
        notes.append("no powers of t where there is no drift, or where a run is too short")
    return StudyTable(title, head, tuple(rows), 1, tuple(notes))


def _power(p: float) -> str:
    return f"{round(p, 1) + 0.0:g}" if isfinite(p) else ""


def _forms(study: MethodStudy) -> StudyTable:
    rows: list[tuple[str, ...]] = []
    for run in study.forms:
        condition = (magnitude(run.conditions[0]), f"{run.exponent:.1f}")
        if run.failure:
            rows.append((FORM_NAMES[run.form], run.rule.value, "", "", "", "", "", *condition, run.failure))
            continue
        sizes = (run.position, run.velocity, run.early, run.late)
        rows.append((FORM_NAMES[run.form], run.rule.value, *map(magnitude, sizes), f"{run.iterations:.1f}", *condition))
    title = f"formulations under one rule, steps of {_seconds(study.h)} s"
    head = ("form", "rule", "|g|", "|gdot|", "ringing, first", "last", "iterations", "condition", "as h^")
    notes = (
        "ringing: the part of the multipliers that alternates from step to step, over the largest, in the first and "
        "the last tenth of the run; condition: of the scaled iteration matrix",
    )
    return StudyTable(title, head, tuple(rows), 2, notes)


def _conditioning(study: MethodStudy) -> StudyTable:
    c = study.conditioning
    rows = [
        _along("cond(M)", c.t, c.mass, int(np.argmax(c.mass))),
        _along("cond(KKT)", c.t, c.kkt, int(np.argmax(c.kkt))),
    ]
    notes: tuple[str, ...] = ("condition numbers are in SI units; G is scaled, so that its typical value is 1",)
    if c.weakest:
        rows.append(_along("smallest singular value of G", c.t, c.singular, int(np.argmin(c.singular))))
        notes += (f"the weakest constraints are {', '.join(c.weakest)}",)
    title = f"conditioning in {len(c.t)} states of {study.along}"
    return StudyTable(title, ("", "least", "most", "worst at, s"), tuple(rows), 1, notes)


def _along(name: str, t: Any, values: Any, worst: int) -> tuple[str, ...]:
    return name, f"{values.min():.3g}", f"{values.max():.3g}", f"{t[worst]:.4g}"


def _ringing(study: MethodStudy) -> StudyTable:
    rows = [
        (f"{r.rho:g}", f"{r.factor:.3f}", *(magnitude(r.amplitude[n - 1]) for n in (1, 20, len(r.amplitude))))
        for r in study.ringing
    ]
    last = len(study.ringing[0].amplitude) if study.ringing else 0
    title = "ringing of multipliers, rigid crank-slider, generalised-alpha on index 3"
    return StudyTable(title, ("rho", "factor per step", "step 1", "step 20", f"step {last}"), tuple(rows))


def _dead_centres(study: MethodStudy) -> StudyTable:
    rows = []
    for case in study.dead_centres:
        dead = ", ".join(f"{np.degrees(angle):.0f}" for angle in case.dead) or "none"
        end = "stops with an error" if case.failure else "passes"
        rows.append((case.driven.value, f"{case.rod:g}", magnitude(float(case.singular.min())), dead, end))
    head = ("driven", "rod / crank", "smallest singular value", "dead centres, deg", "a run")
    return StudyTable("dead centres of a rigid crank-slider over a revolution of the crank", head, tuple(rows))


def _momentum(study: MethodStudy) -> StudyTable:
    rules = list(dict.fromkeys(m.rule for m in study.momentum))
    rows = [(rule.value, *(percent(m.drift) for m in study.momentum if m.rule is rule)) for rule in rules]
    products = [f"omega_1 h = {m.product:g}" for m in study.momentum if m.rule is rules[0]]
    return StudyTable(
        f"angular momentum of a free beam that vibrates by {AMPLITUDE:.2f} l", ("rule", *products), tuple(rows)
    )


def _bases(study: MethodStudy) -> StudyTable:
    chosen: Sequence[int] = (2, 4, 8, 12, 16, 20)
    rows = [
        (
            str(b.count),
            magnitude(b.monomials),
            magnitude(b.error_monomials),
            f"{b.legendre:.1f}",
            magnitude(b.error_legendre),
        )
        for b in study.bases
        if b.count in chosen
    ]
    head = ("N", "monomials, cond(c8)", "error of c8 x = b", "Legendre, cond(c8)", "error of c8 x = b")
    return StudyTable("monomials against Legendre polynomials", head, tuple(rows))
