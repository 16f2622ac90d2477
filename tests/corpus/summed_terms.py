"""How much is added up on the way to each result of a kernel: what rounding errors are measured by.

The kernel runs on numbers that carry the sum of the magnitudes of their terms beside their value. 1e-14 of that sum is
some 45 units in the last place, however much of it cancels.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from derive.ir.interpreter import interpret
from derive.ir.model import Model
from derive.ir.operator_functions import LIBRARY

SMALL = 1e-7
"""The change of an argument, relative to its terms, from which the slope of a function follows."""


@dataclass(frozen=True)
class Summed:
    """A number, and the sum of the magnitudes of the terms that it consists of."""

    value: float
    size: float

    def __add__(self, other: Any) -> Summed:
        b = summed(other)
        return Summed(self.value + b.value, self.size + b.size)

    def __sub__(self, other: Any) -> Summed:
        b = summed(other)
        return Summed(self.value - b.value, self.size + b.size)

    def __mul__(self, other: Any) -> Summed:
        b = summed(other)
        return Summed(self.value * b.value, self.size * b.size)

    def __truediv__(self, other: Any) -> Summed:
        b = summed(other)
        return Summed(self.value / b.value, self.size * b.size / b.value**2)

    def __radd__(self, other: Any) -> Summed:
        return summed(other) + self

    def __rsub__(self, other: Any) -> Summed:
        return summed(other) - self

    def __rmul__(self, other: Any) -> Summed:
        return summed(other) * self

    def __rtruediv__(self, other: Any) -> Summed:
        return summed(other) / self

    def __neg__(self) -> Summed:
        return Summed(-self.value, self.size)

    def __lt__(self, other: Any) -> bool:
        return self.value < summed(other).value

    def __le__(self, other: Any) -> bool:
        return self.value <= summed(other).value

    def __gt__(self, other: Any) -> bool:
        return self.value > summed(other).value

    def __bool__(self) -> bool:
        return self.value != 0

    def __float__(self) -> float:
        return self.value


def summed(number: Any) -> Summed:
    """A number of another type, as one term."""
    return number if isinstance(number, Summed) else Summed(float(number), abs(float(number)))


def of_function(function: Callable[..., float], *arguments: Any) -> Summed:
    """The value of a function; its terms grow with those of its arguments by its slope."""
    given = [summed(argument) for argument in arguments]
    values = [each.value for each in given]
    value = function(*values)
    size = abs(value)
    for i, each in enumerate(given):
        beside = [*values[:i], each.value + SMALL * each.size, *values[i + 1 :]]
        size += abs(function(*beside) - value) / SMALL
    return Summed(value, size)


def summed_terms(model: Model, name: str, *arguments: Any) -> np.ndarray:
    """The sums of magnitudes behind the results of a function, one behind the other.

    arguments: numbers and vectors in the order of the function.
    """
    kernel = model.kernel(name)
    given = {
        a.name: summed(value) if a.scalar else [summed(x) for x in value]
        for a, value in zip(kernel.arguments, arguments, strict=True)
    }
    results = interpret(
        kernel,
        given,
        number=lambda exact: summed(Fraction(exact)),
        functions={operator.value: _lifted(function) for operator, function in LIBRARY.items()},
        check=False,
        tables={spline.name: _table(spline) for spline in model.splines},
    )
    return np.array([summed(x).size for values in results.values() for x in values])


def _lifted(function: Callable[..., float]) -> Callable[..., Summed]:
    return lambda *arguments: of_function(function, *arguments)


def _table(spline: Callable[[Any, int], Any]) -> Callable[[Any, int], Summed]:
    return lambda argument, order: of_function(lambda x: float(spline(x, order)), argument)


def worst(by_python: Sequence[float], by_c: Sequence[float], sizes: np.ndarray) -> float:
    """The largest difference, relative to the terms; infinite where nothing is added up and yet they differ."""
    differences = np.abs(np.ravel(by_python) - np.ravel(by_c))
    if np.any(np.isnan(differences)):
        return math.inf
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.max(np.where(differences > 0, differences / sizes, 0.0), initial=0.0))
