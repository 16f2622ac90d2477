"""The remaining time of work in steps, as lines of progress state it."""

from __future__ import annotations

import time

from derive.durations import duration_text

SOON = 1.0
"""The time (s) for which nothing is stated: the first steps are too short for an estimate."""


class RemainingTime:
    """The time that is left of a number of steps, at the average speed since the first of them began."""

    def __init__(self, steps: int) -> None:
        self.steps, self.finished, self._began = steps, 0, time.monotonic()

    def next(self) -> str:
        """The text of the next step, which begins now: "2 of 5, about 8 s left"."""
        text = f"{self.finished + 1} of {self.steps}{self.left}"
        self.finished += 1
        return text

    def named(self, label: str) -> str:
        """The label of the next step with its text in brackets, if there are others."""
        text = self.next()
        return f"{label} ({text})" if self.steps > 1 else label

    @property
    def left(self) -> str:
        """The text of the remaining time, if it can be estimated: ", about 8 s left"."""
        passed = time.monotonic() - self._began
        if not 0 < self.finished < self.steps or passed < SOON:
            return ""
        return f", about {duration_text((self.steps - self.finished) / self.finished * passed)} left"


def remaining_seconds(predicted: float, done: float, passed: float, prior: float) -> float:
    """The time (s) that work takes whose predicted time is given, after other work.

    done, passed: the predicted and the measured time of the finished work. prior: the predicted time that counts as
    finished in just this time, so that the first steps, which are short, do not decide alone.
    """
    return predicted * (passed + prior) / (done + prior)
