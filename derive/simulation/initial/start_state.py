"""The initial state of a scene as data of its generated code, the same digits on every machine.

Linear algebra in doubles differs between machines in the last digits. The state is therefore rounded, and the rounded
state is projected onto the constraints in decimal arithmetic of many digits, which is the same everywhere.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np

from derive.errors import TisserandError
from derive.ir.interpreter import interpret
from derive.ir.model import Model, StartState
from derive.roles import Role
from derive.runtime.interpreted_scene import InterpretedScene
from derive.simulation.compiled_scene import rounding
from derive.simulation.initial.spatial_state import spatial_state
from derive.simulation.inputs import with_functions
from derive.simulation.scene_start import state_of
from derive.spec.model.body import NodalBody
from derive.spec.model.specification import AnyScene

DIGITS = 10
"""Significant digits of the rounded state."""
SMALLEST = 12
"""Decimals of the rounded state, in SI units: smaller values have fewer digits."""
WORKING_DIGITS = 50
MET = 1e-30
"""Constraints (m, rad) and their rates (m/s, rad/s) below this are met."""
STIFFNESS = 1e-15
"""The change of a number that is exact, relative to that of others, where constraints leave a choice."""
DEPENDENT = mpmath.mpf("1e-25")
"""The relative addition to a diagonal that makes a matrix of constraints that depend on each other regular."""
UNSEEN = 1e-16
"""Changes (SI units) of exact numbers below this are ignored."""
CONTRADICTION = 1e-9
"""The part of the largest number of a state by which redundant constraints contradict each other, since the numbers of
the specification are rounded."""
ITERATIONS = 8
COMPONENTS = 4
"""The number of coordinates of a quaternion."""


class NoStartState(TisserandError):
    """The rounded initial state does not come back to the constraints."""


def start_state(spec: AnyScene | NodalBody, model: Model) -> StartState:
    """The initial state of a scene or a body with the defaults of its parameters, exact to the last digit of a double.

    model: its kernels. Run-time inputs have their values at the start of a simulation, since a prescribed motion may be
    one of them. Raises SpecError where an input has no value, what `initial_state` raises, and NoStartState.
    """
    from derive.derivation import derive
    from derive.model_lowering import lower

    if isinstance(spec, NodalBody):
        state = spatial_state(model, spec.start)
        return StartState(tuple(state.q.tolist()), tuple(state.v.tolist()))
    if spec.inputs:
        redundant = "resolve" if model.proximal else spec.redundant
        spec = replace(with_functions(spec, {}), outputs=(), redundant=redundant)
        model = lower(derive(spec), explicit=True)
    state = state_of(spec, InterpretedScene(model))
    with mpmath.workdps(WORKING_DIGITS):
        q, v = _projected(model, *([_rounded(float(x)) for x in part] for part in (state.q, state.v)))
        return StartState(tuple(float(x) + 0.0 for x in q), tuple(float(x) + 0.0 for x in v))


@dataclass
class _Rounded:
    """A rounded number; `exact` if it had no more digits, as numbers have that stand in a specification."""

    value: Any
    exact: bool


def _rounded(value: float) -> _Rounded:
    """A number with DIGITS digits, but no more than SMALLEST decimals."""
    decimals = DIGITS - 1 - math.floor(math.log10(abs(value))) if value else 0
    text = f"{value:.{min(max(decimals, 0), SMALLEST)}f}"
    return _Rounded(mpmath.mpf(text), abs(float(text) - value) <= 1e-14 * max(abs(value), 1.0))


def _projected(model: Model, q_start: list[_Rounded], v_start: list[_Rounded]) -> tuple[list[Any], list[Any]]:
    """The state q, v at t = 0 with g = 0 and gdot = 0; exact numbers are kept if the others can give way."""
    q, v = [x.value for x in q_start], [x.value for x in v_start]
    (k,) = _evaluated(model, "setup", [mpmath.mpf(x) for x in model.defaults])
    zero, before = mpmath.mpf(0), mpmath.inf
    _normalise(model, q)
    for _ in range(ITERATIONS):
        (g,) = _evaluated(model, "constraints", zero, q, k)
        (rates,) = _evaluated(model, "constraint_rates", zero, q, v, k)
        violation = max((abs(x) for x in (*g, *rates)), default=zero)
        contradicted = CONTRADICTION * max(1, *map(abs, (*q, *v)))
        if violation < MET or (model.proximal and before / 2 < violation < contradicted):
            return _unchanged(q, q_start), _unchanged(v, v_start)
        before = violation
        for residual, values, start in ((g, q, q_start), (rates, v, v_start)):
            change = _change(model, q, k, residual, start)
            if values is q and len(q) != len(v):
                (change,) = _evaluated(model, "rates", q, change, k)
            values[:] = [x + dx for x, dx in zip(values, change, strict=True)]
            if values is q:
                _normalise(model, q)
    raise NoStartState(f"{model.name}: the rounded initial state does not come back to the constraints")


def _change(model: Model, q: list[Any], k: list[Any], residual: list[Any], start: list[_Rounded]) -> list[Any]:
    """The change of q or v with G change = -residual that has the smallest sum of weighted squares."""
    if all(x == 0 for x in residual):
        return [mpmath.mpf(0)] * len(model.velocities)
    (values,) = _evaluated(model, "constraint_jacobian", mpmath.mpf(0), q, k)
    G = mpmath.zeros(len(residual), len(model.velocities))
    least = rounding(np.array(q, dtype=float)) if model.proximal else 0  # smaller entries are rounding errors
    for (i, j), value in zip(model.pattern("constraint_jacobian", "G").entries, values, strict=True):
        G[i, j] = value if abs(value) > least else 0
    exact = _exact(model, start)
    weighted = mpmath.diag([STIFFNESS if of else 1 for of in exact]) * G.T
    matrix = G * weighted
    if model.proximal:
        for i in range(len(residual)):
            matrix[i, i] += DEPENDENT * (matrix[i, i] or 1)
    try:
        return list(weighted * mpmath.lu_solve(matrix, -mpmath.matrix(residual)))
    except ZeroDivisionError as error:
        raise NoStartState(f"{model.name}: the constraints do not determine the initial state") from error


def _exact(model: Model, start: list[_Rounded]) -> list[bool]:
    """Of each velocity whether the rounded number that changes with it is exact; of a quaternion none is."""
    if len(start) == len(model.velocities):
        return [x.exact for x in start]
    result: list[bool] = []
    places = iter(zip(model.coordinates, start, strict=True))
    for coordinate, x in places:
        if coordinate.role is Role.QUATERNION:
            for _ in range(COMPONENTS - 1):
                next(places)
            result += [False] * (COMPONENTS - 1)
        else:
            result.append(x.exact)
    return result


def _normalise(model: Model, q: list[Any]) -> None:
    """Scale the quaternions among coordinates to length 1."""
    places = [i for i, variable in enumerate(model.coordinates) if variable.role is Role.QUATERNION]
    for start in range(0, len(places), COMPONENTS):
        own = places[start : start + COMPONENTS]
        length = mpmath.sqrt(sum(q[i] ** 2 for i in own))
        for i in own:
            q[i] /= length


def _unchanged(values: list[Any], start: list[_Rounded]) -> list[Any]:
    """The values, without changes that no double shows."""
    return [x.value if abs(value - x.value) < UNSEEN else value for value, x in zip(values, start, strict=True)]


def _evaluated(model: Model, name: str, *arguments: Any) -> Sequence[list[Any]]:
    """The outputs of a function in decimal arithmetic."""

    def number(value: Fraction) -> Any:
        return mpmath.mpf(value.numerator) / value.denominator

    kernel = model.kernel(name)
    given = {a.name: value for a, value in zip(kernel.arguments, arguments, strict=True)}
    functions = {"sin": mpmath.sin, "cos": mpmath.cos, "sqrt": mpmath.sqrt, "atan2": mpmath.atan2}
    tables = {spline.name: spline for spline in model.splines}
    return list(interpret(kernel, given, number=number, functions=functions, tables=tables).values())
