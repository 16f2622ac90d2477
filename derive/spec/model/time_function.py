"""Functions of the time t as data: expressions, piecewise functions, steps and tables; and their evaluation."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations, pairwise

from derive.short_text import record_text
from derive.spec.model.quantity import Parameter


@dataclass(frozen=True)
class Spline:
    """A piecewise polynomial through the rows of a table: a cubic spline, or one of its antiderivatives.

    knots: x_0 < x_1 < ..., at least two; coefficients: for each interval i the values c0, c1, c2, ... of
    c0 + c1 d + c2 d^2 + ... with d = x - x_i. Before the first knot and behind the last one the value is constant, and
    the derivatives are zero.
    """

    name: str
    knots: tuple[float, ...]
    coefficients: tuple[tuple[float, ...], ...]

    @property
    def degree(self) -> int:
        """The degree of the polynomials."""
        return len(self.coefficients[0]) - 1

    def __call__(self, x: float, order: int = 0) -> float:
        """Return the value at x, or the derivative of the given order."""
        if order and not self.knots[0] <= x < self.knots[-1]:
            return 0.0
        x = min(max(x, self.knots[0]), self.knots[-1])
        i = min(bisect_right(self.knots, x), len(self.knots) - 1) - 1
        return _polynomial(self.coefficients[i], x - self.knots[i], order)

    def antiderivative(self, name: str) -> Spline:
        """The integral from the first knot, between the knots, under a name of its own."""
        rows, area = [], 0.0
        for row, step in zip(self.coefficients, (b - a for a, b in pairwise(self.knots)), strict=True):
            rows.append((area, *(c / power for power, c in enumerate(row, 1))))
            area = _polynomial(rows[-1], step, 0)
        return Spline(name, self.knots, tuple(rows))


def _polynomial(c: tuple[float, ...], d: float, order: int) -> float:
    """The value or a derivative of a polynomial, with the operations of the generated code in their order."""
    value = 0.0
    for j in range(len(c) - 1, order - 1, -1):
        value = math.perm(j, order) * c[j] + d * value
    return value


@dataclass(frozen=True)
class TimeFunction:
    """An expression of the time t, as `time_function` reads it.

    Attributes:
        kind: number, t, parameter, input or spline; add, sub, mul, div, pow, neg; sin, cos, sqrt, exp, log, tanh, abs;
            min, max, atan2; step (x, x0, x1: from 0 at x0 to 1 at x1, with two continuous derivatives); less (a < b,
            only in a piecewise function); or piecewise (condition, value, condition, value, ..., value: the value of
            the first condition that holds, or else the last one).
        args: its operands.
        value: that of a number (pi is the double next to it, exactly).
        name: that of a run-time input.
        parameter: that of the scene.
        spline: that of a table.

    Examples:
        >>> import derive
        >>> half = derive.TimeFunction("number", value=0.5)
        >>> derive.TimeFunction("mul", (half, derive.TimeFunction("t"))) == derive.time_function("0.5*t")
        True
    """

    kind: str
    args: tuple[TimeFunction, ...] = ()
    value: Fraction = Fraction(0)
    name: str = ""
    parameter: Parameter | None = None
    spline: Spline | None = None
    __repr__ = record_text


def smooth_step(x: float, x0: float, x1: float) -> float:
    """The polynomial of degree five from 0 at x0 to 1 at x1 whose first two derivatives vanish at both ends."""
    s = min(max((x - x0) / (x1 - x0), 0.0), 1.0)
    return s * s * s * (10.0 + s * (6.0 * s - 15.0))


OPERATIONS: Mapping[str, Callable[..., float]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "pow": math.pow,
    "neg": lambda a: -a,
    "sin": math.sin,
    "cos": math.cos,
    "sqrt": math.sqrt,
    "exp": math.exp,
    "log": math.log,
    "tanh": math.tanh,
    "abs": abs,
    "min": min,
    "max": max,
    "atan2": math.atan2,
    "step": smooth_step,
    "less": lambda a, b: float(a < b),
}
"""The evaluation of each kind from the values of its operands; piecewise functions evaluate only what they need."""


def value_at(function: TimeFunction, t: float, parameters: Mapping[str, float] | None = None) -> float:
    """The number that a function is at t (s); `parameters` are by symbol, defaults where they are not given.

    Raises ArithmeticError or ValueError where the function has no value, as one of a run-time input has none.
    """

    def value(of: TimeFunction) -> float:
        match of.kind:
            case "number":
                return float(of.value)
            case "t":
                return t
            case "input":
                raise ValueError(f"the run-time input {of.name} has no value here")
            case "parameter":
                assert of.parameter is not None
                return (parameters or {}).get(of.parameter.symbol, of.parameter.default)
            case "spline":
                assert of.spline is not None
                return of.spline(value(of.args[0]))
            case "piecewise":
                pairs = zip(of.args[:-1:2], of.args[1::2], strict=True)
                return value(next((then for condition, then in pairs if value(condition)), of.args[-1]))
            case _:
                return OPERATIONS[of.kind](*map(value, of.args))

    return value(function)


def parts(function: TimeFunction) -> Iterator[TimeFunction]:
    """A function and all its operands, operands first."""
    for arg in function.args:
        yield from parts(arg)
    yield function


def depends_on_time(function: TimeFunction) -> bool:
    """Whether the time occurs in a function, or a run-time input."""
    return any(part.kind in ("t", "input") for part in parts(function))


def function_at(function: TimeFunction, t: float) -> TimeFunction:
    """The value of a function at t (s), as a function of its parameters that does not depend on time."""
    if function.kind == "t":
        return TimeFunction("number", value=Fraction(t))
    return replace(function, args=tuple(function_at(arg, t) for arg in function.args))


SAMPLES = 4096
"""The number of parts of a simulation at whose ends operands that are not linear in t are compared."""


def break_times(function: TimeFunction, end: float, parameters: Mapping[str, float] | None = None) -> Iterator[float]:
    """The times at which a function or one of its first three derivatives jumps, as far as they are known.

    These are the conditions of piecewise functions, both ends of steps and tables, and where the operand of abs or the
    difference of those of min and max changes its sign. Where operands are linear in t all times are computed; where
    they are not, those from 0 to `end` (s) between which some of SAMPLES + 1 equally spaced times lie.
    """
    zero = TimeFunction("number")
    for part in parts(function):
        match part.kind:
            case "less":
                edges = [(part.args[0], part.args[1])]
            case "min" | "max":
                edges = [*combinations(_operands(part), 2)]
            case "abs":
                edges = [(part.args[0], zero)]
            case "step":
                edges = [(part.args[0], end) for end in part.args[1:]]
            case "spline":
                assert part.spline is not None
                ends = part.spline.knots[0], part.spline.knots[-1]
                edges = [(part.args[0], TimeFunction("number", value=Fraction(end))) for end in ends]
            case _:
                edges = []
        for left, right in edges:
            yield from _crossings(left, right, end, parameters)


def _operands(function: TimeFunction) -> list[TimeFunction]:
    """The operands of min or max, where operands of the same kind are replaced by their own operands."""
    return [operand for arg in function.args for operand in (_operands(arg) if arg.kind == function.kind else [arg])]


def _crossings(
    left: TimeFunction, right: TimeFunction, end: float, parameters: Mapping[str, float] | None
) -> Iterator[float]:
    """The times at which the difference of two functions changes its sign."""
    first, second = (_linear(side, parameters) for side in (left, right))
    if first is None or second is None:
        difference = TimeFunction("sub", (left, right))
        yield from _sign_changes(lambda t: _finite(difference, t, parameters), end)
    elif first[1] != second[1]:
        yield (second[0] - first[0]) / (first[1] - second[1])


def _finite(function: TimeFunction, t: float, parameters: Mapping[str, float] | None) -> float:
    """The value of a function at t (s), NaN where it has none."""
    try:
        return value_at(function, t, parameters)
    except (ArithmeticError, ValueError):
        return math.nan


def _sign_changes(of: Callable[[float], float], end: float) -> Iterator[float]:
    """The times from 0 to `end` (s) at which a function changes its sign, to the last digit: by bisection."""
    last = (0.0, 0.0)  # the last sample that is neither zero nor NaN
    for t in (end * k / SAMPLES for k in range(SAMPLES + 1)):
        value = of(t)
        if value < 0.0 < last[1] or last[1] < 0.0 < value:
            before, after = last[0], t
            while before < (middle := 0.5 * (before + after)) < after:
                before, after = (middle, after) if of(middle) * last[1] > 0.0 else (before, middle)
            yield after
        if value:
            last = (t, 0.0 if math.isnan(value) else value)


def _linear(function: TimeFunction, parameters: Mapping[str, float] | None) -> tuple[float, float] | None:
    """The coefficients of 1 and t of a function; None if it is not linear."""
    if not depends_on_time(function):
        return value_at(function, 0.0, parameters), 0.0
    if function.kind == "t":
        return 0.0, 1.0
    args = [_linear(arg, parameters) for arg in function.args]
    known = [arg for arg in args if arg is not None]
    if len(known) < len(args):
        return None
    match function.kind, known:
        case "neg", [a]:
            return -a[0], -a[1]
        case "add", [a, b]:
            return a[0] + b[0], a[1] + b[1]
        case "sub", [a, b]:
            return a[0] - b[0], a[1] - b[1]
        case "mul", [a, b] if a[1] == 0 or b[1] == 0:
            return a[0] * b[0], a[0] * b[1] + a[1] * b[0]
        case "div", [a, b] if b[1] == 0:
            return a[0] / b[0], a[1] / b[0]
        case _:
            return None
