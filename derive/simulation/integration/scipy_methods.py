"""Explicit integration of a compiled scene by SciPy: adaptive Runge-Kutta steps, projected onto the constraints."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from ctypes import POINTER, c_double, c_void_p, cast
from typing import Any, Literal, assert_never, get_args

import numpy as np

from derive.runtime.compiled_model import Native
from derive.runtime.native_call import ModelError, Vector, checked_vector
from derive.simulation.compiled_scene import ConstrainedSystem
from derive.simulation.errors import DriftTooLarge, IntegrationStopped
from derive.simulation.integration.failure_diagnosis import diagnose_error, diagnose_failure
from derive.simulation.integration.solution import Cost, Progress, Solution, SolutionWriter, row_times
from derive.simulation.integration.stop_event import StopEvent
from derive.simulation.integration.time_segments import smooth_ends
from derive.simulation.integration.tolerances import absolute_tolerances, rounding_note

MAX_STEPS_PER_ROW = 20_000
Method = Literal["DOP853", "RK45"]
"""The largest mean number of steps for each row; an integration that needs more is stopped."""


def integrate(
    native: ConstrainedSystem,
    k: Vector,
    q: Vector,
    v: Vector,
    times: Sequence[float] | Vector,
    *,
    method: Method = "DOP853",
    tolerance: float = 1e-9,
    size: float = 1.0,
    drift: float = 1e-9,
    projected: bool = True,
    max_step: float = np.inf,
    breaks: Sequence[float] = (),
    until: StopEvent | None = None,
    progress: Progress | None = None,
) -> Solution:
    """The motion of a compiled scene from a consistent state.

    Arguments:
        native: the compiled scene.
        k: the constants (nk,) of `native.setup`.
        q: the consistent coordinates (nq,) at times[0], SI units.
        v: the consistent generalised velocities (nv,) at times[0], SI units.
        times: those of the rows (n,), s, increasing.
        method: "DOP853" or "RK45", those of SciPy.
        tolerance: the error of a step, relative and absolute (SI).
        size: that of the scene, m, see `absolute_tolerances`.
        drift: the limit of constraints (m, rad) and their rates (m/s, rad/s) in every row and after projected steps.
        projected: whether the state is projected onto the constraints after each step, and rows within a step as well.
        max_step: the longest step, s.
        breaks: times, s, at which the right-hand side may jump, where the method stops and starts anew.
        until: ends the integration, with a row at its time.
        progress: called with the time reached after each step.

    Raises:
        SingularConfiguration: at a dead centre.
        DriveCannotBeFollowed: where a drive moves a joint beyond one.
        DriftTooLarge: if constraints are violated by more than `drift`.
        IntegrationStopped: if the method fails.
        ValueError: if arrays have other lengths, and for another method.

    Examples:
        >>> import derive
        >>> ball = derive.scene("fall", gravity=(0, -10), bodies={"ball": {"mass": 1, "inertia": 1}})
        >>> native = derive.load_scene(derive.model_files(derive.lower(derive.derive(ball)), ball))
        >>> solution = derive.integrate(native, native.setup(), [0, 0, 0], [3, 4, 0], [0, 0.4, 0.8])
        >>> solution.q[:, 1].round(6) + 0.0
        array([0. , 0.8, 0. ])
    """
    if method not in get_args(Method):
        raise ValueError(f'the method is one of {", ".join(get_args(Method))}, not "{method}"')
    began = time.process_time()
    q, v = checked_vector(native.nq, q, "q"), checked_vector(native.nv, v, "v")
    solver_type = _solver_type(method)
    instants = row_times(times)
    evaluator = Evaluator(native, k)
    rows = SolutionWriter(native, k, instants, drift, projected, until)
    absolute, notes = absolute_tolerances(native, tolerance, size, q), rounding_note(tolerance, q)
    t, y, steps = float(instants[0]), np.concatenate([q, v]), 0
    try:
        rows.append(t, y)
        ends = smooth_ends(instants, breaks)
        solver = None
        while rows.count < len(instants):
            if solver is None or solver.status == "finished":
                end = ends.pop(0)
                evaluator.until = np.nextafter(end, t) if ends else end
                solver = solver_type(evaluator, t, y, end, rtol=max(tolerance, 1e-13), atol=absolute, max_step=max_step)
            evaluator.refused = None
            message = solver.step()
            if message is not None:
                raise diagnose_failure(native, k, t, y, evaluator.refused, message)
            steps += 1
            if steps > MAX_STEPS_PER_ROW * len(instants):
                raise IntegrationStopped(t, f"{steps} steps do not reach the next row")
            stop = None if until is None else rows.stop_time(t, float(solver.t), solver.dense_output())
            if stop is not None:
                return rows.stopped_solution(stop, solver.dense_output(), evaluator.cost(steps, began), notes)
            if rows.following < solver.t:
                dense = solver.dense_output()
                while rows.count < len(instants) and rows.following < solver.t:
                    rows.append(rows.following, dense(rows.following))
            if rows.count < len(instants) and rows.following == solver.t:
                rows.append(float(solver.t), solver.y)
            if projected:
                solver.y = rows.projected_state(solver.t, solver.y)
                solver.f = evaluator(solver.t, solver.y)
            t, y = float(solver.t), solver.y
            if progress is not None:
                progress(t)
    except (ModelError, DriftTooLarge) as error:
        raise diagnose_error(native, k, t, y, error) from error
    return rows.solution(evaluator.cost(steps, began), notes)


def _solver_type(method: Method) -> Any:
    """The class of SciPy, or one derived from it, that takes the steps; SciPy's integrators are loaded here alone."""
    match method:
        case "DOP853":
            from derive.simulation.integration.dormand_prince import DormandPrince

            return DormandPrince
        case "RK45":
            from scipy.integrate import RK45

            return RK45
        case _ as never:
            assert_never(never)


class Evaluator:
    """The function f(t, y) -> ydot for explicit integrators, with y and ydot = [v; vdot] (nq + nv,).

    Where the model returns an error the derivative is NaN, so that integrators take a smaller step; `refused` then is
    the time and the error. `until` is the last time at which the model is evaluated: just before a break, where the
    step that ends there needs the values of its own side. `evaluations` counts calls. Buffers are reused and C is
    called through their addresses, because a call through NumPy takes longer than the C.
    """

    def __init__(self, native: ConstrainedSystem, k: Vector) -> None:
        self.evaluations, self.until = 0, np.inf
        self.refused: tuple[float, ModelError] | None = None
        self._nq, self._name = native.nq, native.name
        self._y, self._ydot = np.zeros(native.nq + native.nv), np.zeros(native.nq + native.nv)
        self._k = np.ascontiguousarray(k, dtype=float)
        if isinstance(native, Native) and not native.follows_functions:
            self._accel = self._compiled(native)
        else:
            self._accel = self._interpreted(native)
        self._rates = self._of_quaternion(native) if native.nq != native.nv else None

    def cost(self, steps: int, began: float) -> Cost:
        """The cost of a number of steps, since the CPU time `began` (s)."""
        return Cost(self.evaluations, steps, time.process_time() - began)

    def __call__(self, t: float, y: Vector) -> Vector:
        """The derivative [v; vdot] of the state, as a new array."""
        self.evaluations += 1
        self._y[:] = y
        if code := self._accel(min(t, self.until)):
            self.refused = (t, ModelError(f"{self._name}_accel", code))
            return np.full(len(self._y), np.nan)
        ydot = self._ydot.copy()
        ydot[: self._nq] = y[self._nq :] if self._rates is None else self._rates(y)
        return ydot

    def _compiled(self, native: Native) -> Callable[[float], int]:
        size = np.dtype(float).itemsize
        q, v = _address(self._y), _address(self._y, self._nq * size)
        k, vdot = _address(self._k), _address(self._ydot, self._nq * size)
        accel: Callable[..., int] = native.function("accel")
        return lambda t: accel(t, q, v, k, vdot)

    def _of_quaternion(self, native: ConstrainedSystem) -> Callable[[Vector], Vector]:
        """The function of y that returns qdot (nq,), where the generalised velocities v differ from qdot."""
        return lambda y: native.rates(y[: self._nq], y[self._nq :], self._k)

    def _interpreted(self, native: ConstrainedSystem) -> Callable[[float], int]:
        def accel(t: float) -> int:
            try:
                self._ydot[self._nq :] = native.accel(t, self._y[: self._nq], self._y[self._nq :], self._k)
            except ModelError as error:
                return error.code
            return 0

        return accel


def _address(array: Vector, offset: int = 0) -> Any:
    """A pointer to an element of an array, which must outlive it."""
    return cast(c_void_p(array.ctypes.data + offset), POINTER(c_double))
