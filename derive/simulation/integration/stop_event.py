"""The time at which a stop condition is met, within a step or an interval of an integrator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from derive.runtime.native_call import Vector

SAMPLES = 8
"""The number of parts of a step at whose ends the condition is evaluated, as it may be met only briefly in a step."""

BEHIND = 4
"""The distance behind the root of its condition at which a run ends, in units in the last place of the time, so that a
run that continues from there does not meet the condition again by rounding errors."""


@dataclass(frozen=True)
class StopEvent:
    """A condition that ends an integration where `value(t, y)` becomes positive; with `crossing`, where it changes
    its sign or becomes zero. `text`: the condition as it is written.
    """

    text: str
    value: Callable[[float, Vector], float]
    crossing: bool

    def holds(self, value: float) -> bool:
        """Whether the condition holds at this value of the function."""
        return value == 0.0 if self.crossing else value > 0.0

    def met(self, before: float, after: float) -> bool:
        """Whether the condition comes to hold between two values, one after the other."""
        if self.crossing:
            return before < 0.0 <= after or before > 0.0 >= after
        return before <= 0.0 < after

    def notes(self, last: float, met_from: float | None, met: bool) -> tuple[str, ...]:
        """The notes on a run up to `last` (s) that the condition has ended, or not.

        met_from: the time (s) of the start if the condition is met there already.
        """
        until, anew = f"until {self.text}", "" if met_from is None else " anew"
        end = f"{until}: met{anew} at" if met else f"{until}: not met{anew} up to"
        notes = (f"{end} t = {last:.9g} s",)
        if met_from is None:
            return notes
        return (
            f"{until}: holds at t = {met_from:.9g} s already; the run goes on until the condition is met anew",
            *notes,
        )

    def time(self, first: float, last: float, dense: Callable[[float], Vector]) -> float | None:
        """The first time (s) between `first` and `last` at which it is met, to rounding errors; None if it is not.

        The condition holds there, or has changed its sign. dense: the state y at a time within the step.
        """

        from scipy.optimize import brentq

        def value(t: float) -> float:
            return self.value(float(t), np.asarray(dense(t)))

        before, at = value(first), first
        for t in map(float, np.linspace(first, last, SAMPLES + 1)[1:]):
            after = value(t)
            if self.met(before, after):
                root = float(brentq(value, at, t, xtol=1e-15, rtol=8.9e-16)) if before else at
                step = BEHIND * float(np.spacing(max(abs(root), t - at)))
                while root < t:
                    root, step = min(root + step, t), 2 * step
                    if self.met(before, value(root)):
                        break
                return root
            before, at = after, t
        return None
