"""The largest stable step of each integrator: by theory from the highest natural frequency, and by experiment."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from derive.errors import TisserandError
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import mass_matrix
from derive.simulation.integration.step_limit import natural_frequencies, natural_modes
from derive.study.methods import stability_functions as theory
from derive.study.methods.scene_methods import DAMPED, Method, MethodScene
from derive.study.states import State

GROWTH: dict[Method, Callable[[], theory.Growth]] = {
    Method.RK4: theory.classical,
    Method.ADAPTIVE: theory.dormand_prince_8,
    Method.RK45: theory.dormand_prince_5,
    Method.GENERALISED_ALPHA: lambda: theory.generalised_alpha(DAMPED),
    Method.TRAPEZOIDAL: lambda: theory.generalised_alpha(1.0),
}
"""The stability function of each method."""

STEPS = 100
"""The number of steps of a run that shows growth or its absence."""
SAFE = 0.25
"""The shortest step of the bisection, divided by the limit of theory."""
DISTURBED = 1e-6
"""The velocity of a disturbance, relative to the largest of the motion, both in the metric of the mass matrix."""
GROWN = 10.0
"""A disturbance counts as growing if it becomes larger by this factor."""
CLOSE = 0.002
"""The relative width at which the bisection ends."""
LONGEST = 20
"""The number of longest steps of an experiment in a period, since they have to resolve the motion."""
LARGE = (300.0, 100.0, 30.0, 10.0, 3.0)
"""The omega h at which methods without a limit are tried."""


@dataclass(frozen=True)
class StepLimit:
    """The largest stable step of a method.

    theory: omega h of the stability function, infinite if there is no limit. growth: the factor by which a step 5 %
    beyond it makes vibrations grow. predicted, measured: the steps (s) by theory and by experiment; without a limit,
    `measured` is the longest that was tried and did not grow, 0 if all did, and not a number if none resolved the
    motion. below, above: whether 0.95 and 1.05 of the predicted step are stable; None where no step is predicted.
    """

    method: Method
    theory: float
    growth: float
    predicted: float
    measured: float
    below: bool | None
    above: bool | None

    @property
    def ratio(self) -> float:
        """The measured step over the predicted one."""
        return self.measured / self.predicted


@dataclass(frozen=True, eq=False)
class HighestFrequency:
    """The highest natural frequency (rad/s): at rest in the initial configuration, and the largest along the motion.

    worst: the state of the largest. speed: the largest speed of the motion, sqrt(v . M v).
    """

    unloaded: float
    largest: float
    worst: State
    speed: float


def highest_frequency(of: MethodScene, states: Sequence[State]) -> HighestFrequency:
    """The highest natural frequency in some states of the motion."""
    native, k = of.native, of.k
    rest = natural_frequencies(native, k, *of.start, loaded=False)
    loaded = [float(natural_frequencies(native, k, *state).max(initial=0.0)) for state in states]
    speed = max(_speed(mass_matrix(native, q, k), v) for _, q, v in states)
    worst = max(range(len(states)), key=lambda n: loaded[n])
    return HighestFrequency(float(rest.max(initial=0.0)), loaded[worst], states[worst], speed)


def step_limits(
    of: MethodScene, frequency: HighestFrequency, methods: Sequence[Method], progress: Callable[[str], None]
) -> list[StepLimit]:
    """The limits of the methods in the state with the highest frequency."""
    result = []
    for method in methods:
        progress(f"{of.scene.name}: largest stable step of {method.value} ...")
        growth = GROWTH[method]()
        limit = theory.step_limit(growth)
        result.append(
            _unlimited(of, method, frequency) if limit == float("inf") else _limited(of, method, frequency, growth)
        )
    return result


def _limited(of: MethodScene, method: Method, frequency: HighestFrequency, growth: theory.Growth) -> StepLimit:
    limit = theory.step_limit(growth)
    predicted = limit / frequency.largest

    def stable(factor: float) -> bool:
        return disturbance_growth(of, method, factor * predicted, frequency) < GROWN

    low, high = SAFE, 2.0
    while high / low > 1 + CLOSE:
        middle = (low * high) ** 0.5
        low, high = (middle, high) if stable(middle) else (low, middle)
    return StepLimit(method, limit, growth(1.05 * limit), predicted, low * predicted, stable(0.95), stable(1.05))


def _unlimited(of: MethodScene, method: Method, frequency: HighestFrequency) -> StepLimit:
    tried = [y / frequency.largest for y in LARGE if y / frequency.largest <= of.period / LONGEST]
    none = 0.0 if tried else float("nan")
    measured = next((h for h in tried if disturbance_growth(of, method, h, frequency) < GROWN), none)
    return StepLimit(method, float("inf"), 1.0, float("inf"), measured, None, None)


def disturbance_growth(of: MethodScene, method: Method, h: float, frequency: HighestFrequency) -> float:
    """The factor by which a small disturbance of the velocities grows within `STEPS` steps of h (s).

    Two runs start in the state with the highest frequency, one of them disturbed in the mode that has it; their
    difference is measured in the metric of the mass matrix there. Infinite if a run fails.
    """
    native, k = of.native, of.k
    t, q, v = frequency.worst
    M, mode = mass_matrix(native, q, k), natural_modes(native, k, t, q, v)[1][:, -1]
    disturbance = DISTURBED * (frequency.speed or 1.0) / _speed(M, mode) * mode
    try:
        plain, disturbed = (of.run(method, h, STEPS, start=(t, q, v + dv)).v for dv in (0 * v, disturbance))
    except TisserandError:
        return float("inf")
    differences = disturbed - plain
    if not np.all(np.isfinite(differences)):
        return float("inf")
    return max(_speed(M, dv) for dv in differences) / _speed(M, disturbance)


def _speed(M: Matrix, v: Vector) -> float:
    return float(np.sqrt(max(float(v @ M @ v), 0.0)))
