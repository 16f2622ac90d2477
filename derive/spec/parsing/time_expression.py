"""Functions of the time t, read from text by a parser that accepts nothing else.

They are made of numbers, t, pi, parameters of the scene, + - * / ^ with whole powers, parentheses, and functions: sin,
cos, sqrt, exp, log, tanh, abs; min, max, atan2; step; piecewise; and the tables of the scene. Numbers are exact, and
what is made of numbers alone is computed at once, exactly, as long as it has few digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from typing import ClassVar, NoReturn

from derive.errors import quoted
from derive.spec.model.time_function import Spline, TimeFunction, depends_on_time, parts, value_at
from derive.spec.parsing.names import INDEX, NO_INDEX
from derive.spec.parsing.parser import MAX_POWER, Parser, Token, fits

TIME = TimeFunction("t")
PI = Fraction(math.pi)

OPERANDS = {
    **dict.fromkeys(("sin", "cos", "sqrt", "exp", "log", "tanh", "abs"), 1),
    **dict.fromkeys(("min", "max", "atan2"), 2),
    "step": 3,
}
"""The functions with a fixed number of operands; min and max take more than two as well."""
WHOLE = {"floor": 1, "mod": 2}
"""Functions of numbers alone, for rows and grids of instances, with their numbers of operands; they have jumps."""
FUNCTIONS = (*OPERANDS, "piecewise", *WHOLE)
"""The functions that an expression may call besides tables."""
CONSTANT = frozenset(("pi", *FUNCTIONS))
"""The names in expressions that are numbers."""

FORMS = {
    "step": "write step(t, 1, 2) for a smooth step from 0 at t = 1 to 1 at t = 2",
    "piecewise": "write piecewise(t < 1, 0, t < 2, t - 1, 1): conditions with their values, then the last value",
}
"""The notation of the functions of several operands."""


@dataclass(frozen=True)
class Known:
    """The names to which a function of time may refer: names of functions such as parameters, and tables."""

    names: Mapping[str, TimeFunction] = field(default_factory=dict)
    splines: Mapping[str, Spline] = field(default_factory=dict)


def time_function(text: str, known: Known | None = None, max_power: int = MAX_POWER) -> TimeFunction:
    """The function of t that a text denotes, such as "2*pi*t - sin(2*pi*t)".

    Arguments:
        text: numbers, t, pi, names, + - * / ^, parentheses, and the functions that `TimeFunction` lists.
        known: the parameters and tables that the text may call by name.
        max_power: the largest exponent.

    Raises:
        ExpressionError: with the column of the fault.
        TypeError: for anything but a text.

    Examples:
        >>> import derive
        >>> function = derive.time_function("2*t + sin(t)")
        >>> function.kind, [part.kind for part in function.args]
        ('add', ['mul', 'sin'])
    """
    if not isinstance(text, str):
        raise TypeError(f'a text is needed, such as "2*pi*t", not {type(text).__name__}')
    return _Functions(text, known or Known(), max_power).parse()


def number_function(value: Fraction) -> TimeFunction:
    """A number as a function of t."""
    return TimeFunction("number", value=value)


def number_formula(text: str, max_power: int = MAX_POWER) -> Fraction:
    """The number that a text denotes, made of numbers, pi and functions, such as "sqrt(2)/2".

    It is exact where it has few digits, otherwise the shortest decimal that reads as its value in doubles. Raises
    ExpressionError.
    """
    function = _NumberFormulas(text, Known(), max_power).parse()
    if function.kind == "number":
        return function.value
    value = constant_value(function)
    assert value is not None, "the text has no other names"
    return Fraction(repr(value))


def constant_value(function: TimeFunction) -> float | None:
    """The value of a function of numbers alone, in doubles; None for others. Raises ArithmeticError, ValueError."""
    if any(part.kind in ("t", "parameter", "input") for part in parts(function)):
        return None
    return value_at(function, 0.0)


class _Functions(Parser[TimeFunction]):
    made_of = (
        "a function of the time is made of numbers, t, pi, parameters, + - * / ^, parentheses, the functions "
        f"{', '.join((*OPERANDS, 'piecewise'))}, and tables"
    )
    names: ClassVar[tuple[str, ...]] = ("t", "pi")
    functions: ClassVar[tuple[str, ...]] = FUNCTIONS

    def __init__(self, text: str, known: Known, max_power: int) -> None:
        self.known, self.max_power = known, max_power
        self.names = ("t", "pi", *known.names)  # type: ignore[misc]  # those of the class and of the scene
        self.functions = (*FUNCTIONS, *known.splines)  # type: ignore[misc]
        super().__init__(text)

    def constant(self, value: Fraction, at: Token) -> TimeFunction:
        return number_function(value)

    def named(self, name: str, at: Token) -> TimeFunction:
        if name in self.known.names:
            return self.known.names[name]
        return TIME if name == "t" else number_function(PI)

    def called(self, function: str, arguments: tuple[TimeFunction, ...], at: Token) -> TimeFunction:
        if function == "piecewise":
            return self._piecewise(arguments, at)
        if any(argument.kind == "less" for argument in arguments):
            self.fail(at, "only piecewise has conditions; " + FORMS["piecewise"])
        if function in self.known.splines:
            return self._table(function, arguments, at)
        count = (OPERANDS | WHOLE)[function]
        if len(arguments) != count and not (function in ("min", "max") and len(arguments) > count):
            such = ("7/2", "2") if function in WHOLE else ("t", "1")
            form = FORMS.get(function, f"write {function}({', '.join(such[:count])})")
            self.fail(at, f"{function} has {count} operand{'s' * (count > 1)}, not {len(arguments)}; {form}")
        if function in WHOLE:
            return self._whole(function, arguments, at)
        if function == "step":
            self._ends(arguments, at)
        if len(arguments) > count:
            *others, last = arguments
            arguments = self.called(function, tuple(others), at), last
        exact = _exact_call(function, arguments)
        return number_function(exact) if exact is not None else self._made(function, arguments, at)

    def compared(self, a: TimeFunction, b: TimeFunction, at: Token) -> TimeFunction:
        return TimeFunction("less", (a, b))

    def _piecewise(self, arguments: tuple[TimeFunction, ...], at: Token) -> TimeFunction:
        """Check and build a piecewise function: conditions are t < x, where the numbers x increase."""
        if len(arguments) < 3 or len(arguments) % 2 == 0:
            self.fail(at, f"a piecewise function has conditions with values, and a last value; {FORMS['piecewise']}")
        conditions = arguments[:-1:2]
        if any(c.kind == "less" for c in (*arguments[1::2], arguments[-1])) or any(
            c.kind != "less" or c.args[0] != TIME or depends_on_time(c.args[1]) for c in conditions
        ):
            self.fail(at, f"the conditions are t < x, with a number or a parameter x; {FORMS['piecewise']}")
        ends = [constant_value(c.args[1]) for c in conditions]
        numbers = [end for end in ends if end is not None]
        if any(b <= a for a, b in pairwise(numbers)):
            self.fail(at, "the times of a piecewise function increase")
        return TimeFunction("piecewise", arguments)

    def _table(self, name: str, arguments: tuple[TimeFunction, ...], at: Token) -> TimeFunction:
        linear = {"number", "t", "parameter", "add", "sub", "mul", "div", "neg"}
        if len(arguments) != 1 or any(part.kind not in linear for part in parts(arguments[0])):
            text = "its argument is made of t, numbers and parameters with + - * /"
            self.fail(at, f"the table {name} has one operand; write {name}(t); {text}")
        return TimeFunction("spline", arguments, spline=self.known.splines[name])

    def _whole(self, function: str, arguments: tuple[TimeFunction, ...], at: Token) -> TimeFunction:
        """The largest whole number that is not above a number, or the remainder of the division by a positive one."""
        values = [a.value if a.kind == "number" else constant_value(a) for a in arguments]
        numbers = [Fraction(value) for value in values if value is not None]
        if len(numbers) < len(values):
            self.fail(at, f"{function} jumps, and is a function of numbers alone")
        if function == "floor":
            return number_function(Fraction(math.floor(numbers[0])))
        if numbers[1] <= 0:
            self.fail(at, "the remainder is that of a division by a positive number")
        return number_function(numbers[0] % numbers[1])

    def _ends(self, arguments: tuple[TimeFunction, ...], at: Token) -> None:
        """Check both ends of a step."""
        _, first, last = arguments
        if depends_on_time(first) or depends_on_time(last):
            self.fail(at, f"both ends of a step are numbers or parameters; {FORMS['step']}")
        ends = constant_value(first), constant_value(last)
        if ends[0] is not None and ends[1] is not None and ends[0] >= ends[1]:
            self.fail(at, f"a step ends behind its beginning, and {ends[0]:g} is not below {ends[1]:g}")

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
        return self._made("pow", (a, number_function(Fraction(power))), at, exact=power <= MAX_POWER)

    def whole(self, value: TimeFunction) -> int | None:
        return int(value.value) if value.kind == "number" and value.value.denominator == 1 else None

    def inverse(self, a: TimeFunction, at: Token) -> TimeFunction:
        return self.divided(number_function(Fraction(1)), a, at, at)

    def _made(self, kind: str, args: tuple[TimeFunction, ...], at: Token, exact: bool = True) -> TimeFunction:
        """The result of an operation: a number if all operands are numbers and the result has few digits."""
        if exact and kind in _EXACT and all(arg.kind == "number" for arg in args):
            number = _EXACT[kind](*(arg.value for arg in args))
            if fits(number):
                return number_function(number)
        function = TimeFunction(kind, args)
        try:
            value = constant_value(function)
        except OverflowError:
            value = math.inf
        except ValueError:
            such = (
                "the logarithm of a number that is not positive"
                if kind == "log"
                else "the square root of a negative number"
            )
            self.fail(at, f"{such} is not real")
        if value is not None and not math.isfinite(value):
            self.fail(at, "the number is too large for the code, which computes in doubles")
        return function


class _NumberFormulas(_Functions):
    made_of = "a number is written like 2, 0.5 or 1/3"

    def __init__(self, text: str, known: Known, max_power: int) -> None:
        super().__init__(text, known, max_power)
        self.names = ()  # type: ignore[misc]  # pi is no example of a name that has powers

    def _name(self, token: Token) -> TimeFunction:
        return self.named(token.text, token) if token.text == "pi" else super()._name(token)

    def unknown(self, token: Token, called: bool) -> NoReturn:
        if called:
            super().unknown(token, called)
        hint = self.made_of
        if token.text == INDEX:
            hint = NO_INDEX
        self.fail(token, f"{quoted(token.text)} is no number; {hint}")


_EXACT: dict[str, Callable[..., Fraction]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "pow": lambda a, b: a ** int(b),
    "neg": lambda a: -a,
    "abs": abs,
    "min": min,
    "max": max,
}

_AT_ZERO = {"sin": 0, "cos": 1, "exp": 1, "tanh": 0}


def _exact_call(function: str, args: tuple[TimeFunction, ...]) -> Fraction | None:
    """The exact value of a function of 0, of the logarithm of 1, or of the root of a square; None for others."""
    if len(args) != 1 or args[0].kind != "number":
        return None
    value = args[0].value
    if value == 0 and function in _AT_ZERO:
        return Fraction(_AT_ZERO[function])
    if value == 1 and function == "log":
        return Fraction(0)
    if function != "sqrt" or value < 0:
        return None
    root = Fraction(math.isqrt(value.numerator), math.isqrt(value.denominator))
    return root if root**2 == value else None
