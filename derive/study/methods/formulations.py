"""The forms of index 3, 2 and 1 of one scene under one implicit rule: drift, ringing of multipliers, conditioning.

Index 3 enforces g = 0, the stabilised form of index 2 (Gear, Gupta & Leimkuhler 1985) g = 0 and gdot = 0, index 1 only
the second derivative of g. Rows and columns of the iteration matrix dF/dy + dF/dydot / h are scaled to largest
entries of 1, so that its condition number does not depend on units.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from derive.errors import TisserandError
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import Dae, NativeScene
from derive.simulation.compiled_scene import max_norm
from derive.simulation.configurations import QUATERNION, attitudes
from derive.study.methods.implicit_steps import Rule, initial_values, march
from derive.study.methods.scene_methods import MethodScene

FORM_NAMES = {"index3": "index 3: g = 0", "ggl": "index 2, stabilised: g = 0, gdot = 0", "index1": "index 1: gddot = 0"}
"""The texts of the forms of a scene."""

STEPS = 400
"""The number of steps of a run."""
REFINED = (1.0, 0.1, 0.01)
"""The steps for which the condition numbers of iteration matrices are computed, divided by that of the run."""
SCALINGS = 10
"""The number of sweeps of the scaling of rows and columns."""


@dataclass(frozen=True)
class FormRun:
    """A run of one form under one rule with steps of h (s).

    position (m, rad), velocity (m/s, rad/s): the largest |g| and |gdot|. early, late: the part of the multipliers that
    alternates from step to step, over their largest value, in the first and in the last tenth of the run. iterations:
    of Newton's method per step. quaternion: the largest difference of the length of a quaternion from 1, which no form
    keeps; None if there are none. conditions: of the scaled iteration matrix with the steps of `REFINED`. failure: why
    the run ended; its numbers are NaN then.
    """

    form: str
    rule: Rule
    h: float
    position: float
    velocity: float
    early: float
    late: float
    iterations: float
    quaternion: float | None
    conditions: tuple[float, ...]
    failure: str = ""

    @property
    def exponent(self) -> float:
        """The exponent p of the condition number ~ h^p."""
        return float(np.polyfit(np.log(REFINED), np.log(self.conditions), 1)[0])


def form_runs(of: MethodScene, h: float, progress: Callable[[str], None], steps: int = STEPS) -> list[FormRun]:
    """The runs of all forms of a scene under the trapezoidal rule and the BDF of order 2, with steps of h (s)."""
    result = []
    for name in FORM_NAMES:
        for rule in (Rule.TRAPEZOIDAL, Rule.BDF2):
            progress(f"{of.scene.name}: {name}, {rule.value} ...")
            result.append(form_run(of, name, rule, h, steps))
    return result


def form_run(of: MethodScene, name: str, rule: Rule, h: float, steps: int = STEPS) -> FormRun:
    """The run of one form, a key of `FORM_NAMES`, under a rule with steps of h (s)."""
    native, k, form = of.native, of.k, of.native.dae[name]
    y, ydot = initial_values(native, form, k, 0.0, of.q, of.v)
    conditions = tuple(condition(form, k, y, ydot, h * part) for part in REFINED)
    nan = float("nan")
    try:
        run = march(form, k, 0.0, y, ydot, h, steps, rule, native.nq, native.nv)
    except TisserandError as error:
        return FormRun(name, rule, h, nan, nan, nan, nan, nan, None, conditions, str(error))
    n, m = native.nq, native.nq + native.nv
    pairs = [(t, y[:n], y[n:m]) for t, y in zip(run.t, run.y, strict=True)]
    lam = run.y[:, m : m + native.nlambda]
    ringing, tenth = alternation(lam) / (max_norm(lam.ravel()) or 1.0), max(1, steps // 10)
    return FormRun(
        name,
        rule,
        h,
        max(max_norm(native.constraints(t, q, k)) for t, q, _ in pairs),
        max(max_norm(native.constraint_rates(t, q, v, k)) for t, q, v in pairs),
        float(ringing[:tenth].max(initial=0.0)),
        float(ringing[-tenth:].max(initial=0.0)),
        run.iterations / steps,
        _from_unit_length(native, run.y),
        conditions,
    )


def _from_unit_length(native: NativeScene, q: Matrix) -> float | None:
    """The largest difference of the length of a quaternion from 1 in rows q (n, at least nq); None without any."""
    lengths = [np.linalg.norm(q[:, i : i + QUATERNION], axis=1) for i, _ in attitudes(native)]
    return float(np.abs(np.array(lengths) - 1.0).max()) if lengths else None


def alternation(lam: Matrix, order: int = 2) -> Vector:
    """The part of rows lam (n, nlambda) that alternates from row to row, (n - order,): differences over 2^order."""
    differences = np.diff(lam, order, axis=0)
    return np.asarray(np.abs(differences).max(axis=1, initial=0.0) / 2**order)


def condition(form: Dae, k: Vector, y: Vector, ydot: Vector, h: float) -> float:
    """The condition number of the scaled iteration matrix of a form at y, ydot (size,), t = 0, for a step of h (s)."""
    J = form.pattern.dense(form.jacobian(0.0, y, ydot, 1 / h, k))
    for _ in range(SCALINGS):
        J = J / np.sqrt(np.abs(J).max(axis=1))[:, None]
        J = J / np.sqrt(np.abs(J).max(axis=0))
    return float(np.linalg.cond(J))
