"""Functions of the time t, read from text by a parser that knows nothing else.

They are made of numbers, t, pi, + - * / ^ with whole powers, sin, cos, sqrt and parentheses. Numbers are exact, and
what is made of numbers alone is computed at once, exactly, as long as it has few digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import ClassVar

from derive.spec.model.scene import TimeFunction
from derive.spec.parsing.parser import Parser, Token, fits

TIME = TimeFunction("t")
PI = Fraction(math.pi)


def time_function(text: str) -> TimeFunction:
    """The function of t that `text` denotes, such as "2*pi*t - sin(2*pi*t)"."""
    return _Functions(text).parse()


def number_function(value: Fraction) -> TimeFunction:
    """A number as a function of t."""
    return TimeFunction("number", value=value)


def constant_value(function: TimeFunction) -> float | None:
    """What a function is that does not depend on t, in doubles; None if it does. Raises ArithmeticError, ValueError."""
    if function.kind == "number":
        return float(function.value)
    args = [constant_value(arg) for arg in function.args]
    known = [arg for arg in args if arg is not None]
    if function.kind in ("t", "input") or len(known) < len(args):
        return None
    return _OPERATIONS[function.kind](*known)


_OPERATIONS: dict[str, Callable[..., float]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "pow": math.pow,
    "neg": lambda a: -a,
    "sin": math.sin,
    "cos": math.cos,
    "sqrt": math.sqrt,
}


class _Functions(Parser[TimeFunction]):
    made_of = "a function of the time is made of numbers, t, pi, + - * / ^, sin, cos, sqrt and parentheses"
    names: ClassVar[tuple[str, ...]] = ("t", "pi")
    functions: ClassVar[tuple[str, ...]] = ("sin", "cos", "sqrt")

    def constant(self, value: Fraction, at: Token) -> TimeFunction:
        return number_function(value)

    def named(self, name: str, at: Token) -> TimeFunction:
        return TIME if name == "t" else number_function(PI)

    def called(self, function: str, argument: TimeFunction, at: Token) -> TimeFunction:
        if argument.kind == "number":
            exact = _exact_call(function, argument.value)
            if exact is not None:
                return number_function(exact)
        return self._made(function, (argument,), at)

    def added(self, a: TimeFunction, b: TimeFunction, at: Token) -> TimeFunction:
        return self._made("add", (a, b), at)

    def subtracted(self, a: TimeFunction, b: TimeFunction, at: Token) -> TimeFunction:
        return self._made("sub", (a, b), at)

    def negative(self, a: TimeFunction, at: Token) -> TimeFunction:
        return self._made("neg", (a,), at)

    def times(self, a: TimeFunction, b: TimeFunction, at: Token) -> TimeFunction:
        return self._made("mul", (a, b), at)

    def divided(self, a: TimeFunction, b: TimeFunction, at: Token, divisor_at: Token) -> TimeFunction:
        if constant_value(b) == 0:
            self.fail(divisor_at, "division by zero")
        return self._made("div", (a, b), at)

    def raised(self, a: TimeFunction, power: int, at: Token) -> TimeFunction:
        return self._made("pow", (a, number_function(Fraction(power))), at)

    def _made(self, kind: str, args: tuple[TimeFunction, ...], at: Token) -> TimeFunction:
        """An operation; a number if all it works on are numbers and the result has few digits."""
        if kind in _EXACT and all(arg.kind == "number" for arg in args):
            exact = _EXACT[kind](*(arg.value for arg in args))
            if fits(exact):
                return number_function(exact)
        function = TimeFunction(kind, args)
        try:
            value = constant_value(function)
        except OverflowError:
            value = math.inf
        except ValueError:
            self.fail(at, "the square root of a negative number is not real")
        if value is not None and not math.isfinite(value):
            self.fail(at, "the number is too large for the code, which computes in doubles")
        return function


_EXACT: dict[str, Callable[..., Fraction]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "pow": lambda a, b: a ** int(b),
    "neg": lambda a: -a,
}


def _exact_call(function: str, value: Fraction) -> Fraction | None:
    """sin(0), cos(0), and roots of squares."""
    if function != "sqrt":
        return {"sin": Fraction(0), "cos": Fraction(1)}[function] if value == 0 else None
    if value < 0:
        return None
    root = Fraction(math.isqrt(value.numerator), math.isqrt(value.denominator))
    return root if root**2 == value else None
