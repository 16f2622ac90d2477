"""The drift of the constraints and of the energy over many steps, with and without projection.

The energy of a scene without damping and loads changes by the work of its drives alone. With M vdot + h = G^T lambda
and gdot = G v + dg/dt = 0 the power is dE/dt = lambda . G v = -lambda . dg/dt, which is integrated along the rows of a
run by a spline of order 5. What remains of E(t) - E(0) - W(t) is the error of the method.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from derive.errors import TisserandError, first_line
from derive.runtime.integrators.c_integrator import IntegratorError
from derive.runtime.native_call import Vector
from derive.simulation.compiled_scene import max_norm
from derive.simulation.configurations import displaced
from derive.simulation.errors import SimulationError
from derive.spec.model.scene_functions import breaks
from derive.study.methods.scene_methods import IMPLICIT, Method, MethodRun, MethodScene, equal_times
from derive.study.states import State
from derive.terminal import magnitude

POINTS = 240
"""The largest number of times of a run at which its drift is evaluated."""
ENDLESS = 1e30
"""A run in which a number becomes larger than this diverges."""
CONSERVED = 1e-5
"""Power that drives do not account for, relative to that of all parts, above which the energy is no measure."""
ORDER_STEPS = 10_000
"""The number of short steps of the run that shows the order of the drift: fewer would drift by rounding errors."""
ROUNDED = 1e-13
"""Drift below this, relative to the size of the scene, may be rounding errors of ORDER_STEPS steps."""
FAR = 0.01
"""Drift above this, relative to the size of the scene, is not a small error any more."""
FEWEST = 6
"""The least number of steps for the spline of the power."""
LATE, FITTED = 0.3, 3
"""The part of the time of a run after which exponents of growth are fitted, and the least number of points for that."""


@dataclass(frozen=True, eq=False)
class DriftRun:
    """The drift of a run: t (n,) in s, the largest |g| (m, rad) and |gdot| (m/s, rad/s) up to then, and |E - E0 - W|
    up to then over the largest kinetic energy; energy is empty where energy is not conserved or not evaluated.

    steps: their number. failure: why the run ended early, if it did.
    """

    method: Method
    projected: bool
    h: float
    steps: int
    t: Vector
    position: Vector
    velocity: Vector
    energy: Vector
    failure: str = ""

    @property
    def label(self) -> str:
        """The text of the method."""
        if self.method in IMPLICIT:
            return f"{self.method.value}, index 3"
        return f"{self.method.value}, {'projected' if self.projected else 'not projected'}"


KINDS = tuple((method, projected) for method in (Method.RK4, Method.ADAPTIVE) for projected in (False, True)) + tuple(
    (method, True) for method in IMPLICIT
)
"""Methods with and without projection; those of index 3 meet g = 0 in every step."""


def drift_runs(
    of: MethodScene, h: float, steps: int, methods: Sequence[Method], energy: bool, progress: Callable[[str], None]
) -> list[DriftRun]:
    """Runs of `steps` steps of h (s); the adaptive method covers the same time with the tolerance of the scene.

    energy: whether the energy of the scene is conserved, and evaluated.
    """
    result = []
    for method, projected in KINDS:
        if method in methods:
            progress(f"{of.scene.name}: drift over {steps} steps of {method.value} ...")
            result.append(drift_run(of, method, projected, h, steps, energy))
    return result


def drift_run(of: MethodScene, method: Method, projected: bool, h: float, steps: int, energy: bool = True) -> DriftRun:
    """The drift of one run; energy: whether the energy of the scene is conserved, and evaluated."""
    none, failure = np.zeros(0), ""
    try:
        if method is Method.ADAPTIVE:
            assert of.scene.simulation is not None
            run = of.adaptive_run(equal_times(0.0, h, steps), of.scene.simulation.tolerance, projected)
        else:
            run = of.run(method, h, steps, projected)
    except IntegratorError as error:
        partial = error.partial
        run, failure = MethodRun(partial.t, partial.q, partial.v, partial.lam, steps), first_line(error)
    except TisserandError as error:
        return DriftRun(method, projected, h, 0, none, none, none, none, first_line(error))
    sizes = np.abs(np.hstack([run.q, run.v, run.lam])).max(axis=1)
    good = len(sizes) if np.all(sizes < ENDLESS) else int(np.argmin(sizes < ENDLESS))  # a NaN is not below it either
    if good < len(sizes):
        failure = failure or f"diverges after t = {run.t[max(good - 1, 0)]:.6g} s"
        run = MethodRun(run.t[:good], run.q[:good], run.v[:good], run.lam[:good], max(good - 1, 0))
    steps = len(run.t) - 1
    if steps < 1:
        return DriftRun(method, projected, h, 0, none, none, none, none, failure)
    chosen = np.unique(np.geomspace(1, steps, POINTS).astype(int))
    native, k = of.native, of.k
    g = [max_norm(native.constraints(run.t[i], run.q[i], k)) for i in chosen]
    rates = [max_norm(native.constraint_rates(run.t[i], run.q[i], run.v[i], k)) for i in chosen]
    lost = energy_error(of, run, chosen) if energy and steps >= FEWEST else none
    worst = np.maximum.accumulate
    return DriftRun(method, projected, h, run.steps, run.t[chosen], worst(g), worst(rates), worst(lost), failure)


def energy_error(of: MethodScene, run: MethodRun, chosen: NDArray[np.intp]) -> Vector:
    """The energy error |E - E0 - W| in some rows of a run, of increasing index, over their largest kinetic energy."""
    parts = np.array([of.native.energy(run.q[i], run.v[i], of.k) for i in (0, *chosen)])
    work = np.zeros(len(chosen))
    if of.scene.drives:
        power = np.array([_power(of, *row) for row in zip(run.t, run.q, run.lam, strict=True)])
        integral = make_interp_spline(run.t, power, k=5).antiderivative()
        work = integral(run.t[chosen]) - integral(run.t[0])
    total = parts.sum(axis=1)
    return np.asarray(np.abs(total[1:] - total[0] - work) / (parts[:, 0].max() or 1.0))


def conserves(of: MethodScene, states: Sequence[State]) -> bool:
    """Whether the work of drives alone changes the energy, in some states of the motion."""
    native, k = of.native, of.k
    for t, q, v in states:
        vdot, lam = native.solve(t, q, v, k)
        h = 1e-6 * of.period
        after, before = (native.energy(displaced(native, q, x * v), v + x * vdot, k) for x in (h, -h))
        rates = (after - before) / (2 * h)
        unit = np.abs(rates).sum() + 1e-2 * native.energy(q, v, k)[0] / of.period
        if abs(rates.sum() - _power(of, t, q, lam)) > CONSERVED * unit:
            return False
    return True


def _power(of: MethodScene, t: float, q: Vector, lam: Vector) -> float:
    """The power of the drives, W."""
    return -float(lam @ of.native.constraint_rates(t, q, np.zeros(of.native.nv), of.k))


@dataclass(frozen=True)
class DriftOrder:
    """The drift of the constraints under RK4 without projection, over `steps` steps: the largest |g| (m, rad), and the
    powers of the time and of the step with which it grows.

    kinks: the times (s) within the run at which a function of the scene or one of its first three derivatives jumps;
    a step across one of them has a lower order.
    """

    steps: int
    position: float
    time: float
    step: float
    kinks: tuple[float, ...] = ()


def drift_order(of: MethodScene, h: float, steps: int) -> DriftOrder:
    """The order of the drift, from runs over the same time with steps of h and h/2 (s).

    Raises TisserandError where a run fails, where there is no more drift than rounding errors, and where there is so
    much that it follows no power.
    """
    whole, half = (drift_run(of, Method.RK4, False, h / n, n * steps, energy=False) for n in (1, 2))
    if failure := whole.failure or half.failure:
        raise SimulationError(failure)
    most, least, size = float(whole.position[-1]), float(half.position[-1]), max(of.size, max_norm(of.q))
    drifts = f"without projection rk4 drifts by {magnitude(most)} m in {steps} steps"
    if least < ROUNDED * size:
        raise SimulationError(f"{drifts}, and by {magnitude(least)} m in shorter ones, which may be rounding errors")
    if most > FAR * size:
        raise SimulationError(f"{drifts}, which is too far to follow a power of the step")
    kinks = tuple(time for time in breaks(of.scene) if 0.0 < time < whole.t[-1])
    return DriftOrder(steps, most, exponent(whole.t, whole.position), float(np.log2(most / least)), kinks)


def exponent(t: Vector, size: Vector) -> float:
    """The exponent p with which a drift (n,) grows as t^p, t > 0 (n,), over the last part of a run.

    NaN if there is no drift, or if the run is too short for a fit; `size` may be empty.
    """
    late = t >= LATE * t[-1] if len(size) else np.zeros(len(t), dtype=bool)
    if late.sum() < FITTED or not np.all(size[late] > 0):
        return float("nan")
    return float(np.polyfit(np.log(t[late]), np.log(size[late]), 1)[0])
