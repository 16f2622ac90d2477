"""Random numbers and choices of a scene, the same from a seed on every machine and in every version of Python."""

from __future__ import annotations

import math
from collections.abc import Sequence
from random import Random
from typing import TypeVar

from derive.spec.model.keys import declared_keys

T = TypeVar("T")


def words(of: type, name: str) -> tuple[str, ...]:
    """The words that the key of a frozen type may be."""
    return next(key.choices for key in declared_keys(of) if key.name == name)


class Draws:
    """The random draws for the scene of a seed. Everything comes from `Random.random`, whose sequence is guaranteed."""

    def __init__(self, seed: int | str) -> None:
        self._random = Random(f"tisserand {seed}").random

    def chance(self, probability: float) -> bool:
        """Whether an event of that probability happens."""
        return self._random() < probability

    def between(self, low: float, high: float) -> float:
        """A number, uniformly distributed."""
        return low + (high - low) * self._random()

    def scale(self, low: float, high: float) -> float:
        """A positive number whose logarithm is uniformly distributed, with two or three significant digits."""
        return rounded(math.exp(self.between(math.log(low), math.log(high))), 2 + self.whole(0, 1))

    def sign(self) -> int:
        """1 or -1."""
        return 1 if self.chance(0.5) else -1

    def whole(self, low: int, high: int) -> int:
        """A whole number from low to high, both included."""
        return low + int(self._random() * (high - low + 1))

    def choice(self, options: Sequence[T]) -> T:
        """One of several."""
        return options[self.whole(0, len(options) - 1)]

    def shuffled(self, options: Sequence[T]) -> list[T]:
        """All of them in another order."""
        rest = list(options)
        return [rest.pop(self.whole(0, len(rest) - 1)) for _ in options]

    def some(self, options: Sequence[T], probability: float) -> list[T]:
        """Each of them with that probability."""
        return [option for option in options if self.chance(probability)]


def rounded(value: float, digits: int = 3) -> float:
    """A number with so many significant digits, as a person writes it."""
    result = float(f"{value:.{digits}g}")
    return 0.0 if result == 0 else result
