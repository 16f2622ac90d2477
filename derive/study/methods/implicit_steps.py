"""Implicit rules with fixed steps for any form F(t, y, ydot) = 0 of a compiled scene: to compare rules and forms.

The rules of a simulation are in C; here a step is a Newton iteration in Python with the generated residual and
iteration matrix, so that one rule can be applied to the forms of index 3, 2 and 1, and several rules to one form.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import assert_never

import numpy as np

from derive.errors import TisserandError
from derive.runtime.native_call import Matrix, ModelError, Vector
from derive.runtime.native_scene import Dae, NativeScene
from derive.simulation.compiled_scene import max_norm

ITERATIONS, REACHED, ROUNDING = 50, 1e-12, 4e-15
"""The limit of Newton iterations, and the last correction, relative to 1 and, where rounding prevents that, to y."""


class Rule(Enum):
    """The rule by which ydot follows from y at the ends of a step of length h."""

    TRAPEZOIDAL = "trapezoidal rule"
    """(ydot_0 + ydot_1) / 2 = (y_1 - y_0) / h, with F = 0 at the end of the step."""
    MIDPOINT = "midpoint rule"
    """F = 0 at (y_0 + y_1) / 2 with ydot = (y_1 - y_0) / h."""
    BDF2 = "BDF of order 2"
    """h ydot_1 = 3/2 y_1 - 2 y_0 + 1/2 y_-1, with F = 0 at the end of the step."""


class StepFailed(TisserandError):
    """Newton's method does not converge in a step."""


@dataclass(frozen=True, eq=False)
class ImplicitRun:
    """The result of a run of a form: t (n,) in s and y (n, size) at the start and after each step, and the number of
    iterations of all steps."""

    t: Vector
    y: Matrix
    iterations: int


def initial_values(native: NativeScene, form: Dae, k: Vector, t: float, q: Vector, v: Vector) -> tuple[Vector, Vector]:
    """The initial y = [q; v; lambda; ...] and ydot (size,) of a form in a consistent state. Raises ModelError."""
    vdot, lam = native.solve(t, q, v, k)
    y, ydot = np.zeros(form.size), np.zeros(form.size)
    n, m = native.nq, native.nq + native.nv
    y[:n], y[n:m], y[m : m + native.nlambda] = q, v, lam
    ydot[:n], ydot[n:m] = native.rates(q, v, k), vdot
    return y, ydot


def march(
    form: Dae, k: Vector, t: float, y: Vector, ydot: Vector, h: float, steps: int, rule: Rule, nq: int, nv: int
) -> ImplicitRun:
    """Integrate a form by `steps` steps of h (s) from y = [q; v; ...], ydot (size,) at t (s), with q (nq,), v (nv,).

    The first step of the BDF is one of the trapezoidal rule. Raises StepFailed.
    """
    rows, iterations, before = [y], 0, None
    for i in range(steps):
        used = Rule.TRAPEZOIDAL if before is None and rule is Rule.BDF2 else rule
        try:
            after, rate, count = _step(form, k, t + i * h, before, y, ydot, h, used, nq, nv)
        except (ModelError, np.linalg.LinAlgError) as error:
            raise StepFailed(f"step {i + 1}: {error}") from error
        before, y, ydot, iterations = y, after, rate, iterations + count
        rows.append(y)
    return ImplicitRun(np.asarray(t + h * np.arange(steps + 1), dtype=np.float64), np.array(rows), iterations)


def _step(
    form: Dae,
    k: Vector,
    t: float,
    before: Vector | None,
    y: Vector,
    ydot: Vector,
    h: float,
    rule: Rule,
    nq: int,
    nv: int,
) -> tuple[Vector, Vector, int]:
    """The values of y and ydot after a step, and the number of iterations."""
    match rule:
        case Rule.TRAPEZOIDAL:
            cj, rest, part = 2 / h, -2 / h * y - ydot, 1.0
        case Rule.MIDPOINT:
            cj, rest, part = 1 / h, -y / h, 0.5
        case Rule.BDF2:
            assert before is not None
            cj, rest, part = 1.5 / h, (-2 * y + before / 2) / h, 1.0
        case _ as never:
            assert_never(never)
    at, after = t + part * h, y.copy()
    for iteration in range(1, ITERATIONS + 1):
        inside = (1 - part) * y + part * after
        rate = cj * after + rest
        r = form.residual(at, inside, rate, k)
        J = form.pattern.dense(form.jacobian(at, inside, rate, cj / part, k)) * part
        change = np.asarray(np.linalg.solve(J, r), dtype=np.float64)
        after = after - change
        if not max_norm(after) < np.inf:
            break
        moved = max_norm(change[:nq]) + h * max_norm(change[nq : nq + nv])
        if moved <= REACHED + ROUNDING * max_norm(after[:nq]):
            return after, cj * after + rest, iteration
    raise StepFailed(f"Newton's method does not converge in the step from {t:.6g} s")
