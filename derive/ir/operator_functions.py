"""The operators of a kernel as Python functions: those for any type of number, and those of the C library."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any

from derive.ir.expressions import LIBRARY_OPERATORS, Operator

ARITHMETIC: dict[Operator, Callable[..., Any]] = {
    Operator.ADD: operator.add,
    Operator.SUB: operator.sub,
    Operator.MUL: operator.mul,
    Operator.DIV: operator.truediv,
    Operator.MIN: lambda a, b: a if a < b else b,
    Operator.MAX: lambda a, b: b if a < b else a,
    Operator.LESS: lambda a, b: int(a < b),
    Operator.NOT_GREATER: lambda a, b: int(a <= b),
    Operator.WHEN: lambda condition, a: a if condition else 0,
    Operator.NEG: operator.neg,
    Operator.SIGN: lambda a: (a > 0) - (a < 0),
    Operator.NOT: lambda a: int(not a),
}
"""The operators that need no function of a type of number."""


def _quiet(function: Callable[..., float]) -> Callable[..., float]:
    """A function of `math` as the C library has it: with NaN and infinity in place of an error."""

    def call(*args: float) -> float:
        try:
            return function(*args)
        except ValueError:
            return math.nan
        except OverflowError:
            return math.inf

    return call


LIBRARY = {operation: _quiet(getattr(math, operation.value)) for operation in (*LIBRARY_OPERATORS, Operator.SQRT)}
"""The operators that are functions of a type of number, for doubles."""
