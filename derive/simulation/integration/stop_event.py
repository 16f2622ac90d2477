"""The time at which a stop condition is met, within a step of an integrator with dense output."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from derive.runtime.native_call import Vector

SAMPLES = 8
"""The parts of a step at whose ends the condition is looked at: it may be met and not be met any more in one step."""


@dataclass(frozen=True)
class StopEvent:
    """A condition that ends an integration where `value(t, y)` becomes positive; with `crossing`, where it changes
    its sign. It has to be zero or negative, or different from zero, before. `text`: the condition as it is written.
    """

    text: str
    value: Callable[[float, Vector], float]
    crossing: bool

    def time(self, first: float, last: float, dense: Callable[[float], Vector]) -> float | None:
        """The first time (s) between `first` and `last` at which it is met, to rounding errors; None if it is not.

        dense: the state y at a time within the step.
        """

        def value(t: float) -> float:
            return self.value(float(t), np.asarray(dense(t)))

        before, at = value(first), first
        for t in np.linspace(first, last, SAMPLES + 1)[1:]:
            after = value(t)
            rises, falls = before <= 0.0 < after, before >= 0.0 > after
            if (rises or (self.crossing and falls)) and not (self.crossing and before == 0.0):
                return float(brentq(value, at, t, xtol=1e-15, rtol=8.9e-16)) if before else at
            before, at = after, float(t)
        return None
