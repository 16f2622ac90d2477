"""The largest stable step of each integrator: by theory from the highest natural frequency, and by experiment."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from derive.simulation.integration.step_limit import natural_frequencies
from derive.study.methods import stability_functions as theory
from derive.study.methods.scene_methods import DAMPED, Method, MethodScene, survives
from derive.study.states import State

GROWTH: dict[Method, Callable[[], theory.Growth]] = {
    Method.RK4: theory.classical,
    Method.ADAPTIVE: theory.dormand_prince_8,
    Method.RK45: theory.dormand_prince_5,
    Method.GENERALISED_ALPHA: lambda: theory.generalised_alpha(DAMPED),
    Method.TRAPEZOIDAL: lambda: theory.generalised_alpha(1.0),
}
"""The stability function of each method."""

STEPS = 2000
"""The steps of a run that shows growth or its absence."""
SAFE = 0.25
"""The step of the run with which others are compared, divided by the limit of theory."""
GROWN = 4.0
"""A run whose strain energy exceeds that of the safe run by this factor has grown."""
CLOSE = 0.002
"""The relative width at which the bisection ends."""
LONGEST = 20
"""Steps of a period that the longest step of an experiment divides it into, which has to resolve the motion."""
LARGE = (300.0, 100.0, 30.0, 10.0, 3.0)
"""The omega h at which methods without a limit are tried."""


@dataclass(frozen=True)
class StepLimit:
    """The largest stable step of a method.

    theory: omega h of the stability function, infinite if there is no limit. growth: the factor by which a step 5 %
    beyond it makes vibrations grow. predicted, measured: the steps (s) by theory and by experiment; without a limit,
    `measured` is the longest that was tried and did not grow. below, above: whether 0.95 and 1.05 of the predicted step
    are stable; None where no step is predicted.
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


@dataclass(frozen=True)
class HighestFrequency:
    """The highest natural frequency (rad/s): undeformed at rest at the start, and the largest along the motion."""

    unloaded: float
    largest: float


def highest_frequency(of: MethodScene, states: Sequence[State]) -> HighestFrequency:
    """The highest natural frequency in some states of the motion."""
    native, k = of.native, of.k
    rest = natural_frequencies(native, k, 0.0, of.q, of.v, loaded=False)
    loaded = [natural_frequencies(native, k, *state) for state in states]
    return HighestFrequency(float(rest.max(initial=0.0)), max(float(w.max(initial=0.0)) for w in loaded))


def step_limits(
    of: MethodScene, omega: float, methods: Sequence[Method], progress: Callable[[str], None]
) -> list[StepLimit]:
    """The limits of the methods at the highest frequency omega (rad/s). Raises TisserandError if no run succeeds."""
    result = []
    for method in methods:
        progress(f"{of.scene.name}: largest stable step of {method.value}")
        growth = GROWTH[method]()
        limit = theory.step_limit(growth)
        result.append(
            _unlimited(of, method, omega) if limit == float("inf") else _limited(of, method, omega, growth, limit)
        )
    return result


def _limited(of: MethodScene, method: Method, omega: float, growth: theory.Growth, limit: float) -> StepLimit:
    predicted = limit / omega
    safe = of.strain_energy(of.run(method, SAFE * predicted, round(STEPS / SAFE)))
    allowed = GROWN * safe

    def stable(factor: float) -> bool:
        return survives(of, method, factor * predicted, STEPS, allowed)

    low, high = SAFE, 2.0
    while high / low > 1 + CLOSE:
        middle = (low * high) ** 0.5
        low, high = (middle, high) if stable(middle) else (low, middle)
    return StepLimit(method, limit, growth(1.05 * limit), predicted, low * predicted, stable(0.95), stable(1.05))


def _unlimited(of: MethodScene, method: Method, omega: float) -> StepLimit:
    safe = of.strain_energy(of.run(Method.RK4, 1.0 / omega, STEPS))
    tried = [y / omega for y in LARGE if y / omega <= of.period / LONGEST]
    measured = next((h for h in tried if survives(of, method, h, STEPS, GROWN * safe)), 0.0)
    return StepLimit(method, float("inf"), 1.0, float("inf"), measured, None, None)
