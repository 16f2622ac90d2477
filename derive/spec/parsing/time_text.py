"""Functions of time as text, in the notation that `time_expression` reads."""

from __future__ import annotations

from fractions import Fraction

from derive.spec.model.time_function import TimeFunction
from derive.spec.parsing.time_expression import PI

SUM, PRODUCT, POWER, ATOM = range(4)
"""The precedence of operations."""
OPERATORS = {
    "add": (" + ", SUM),
    "sub": (" - ", SUM),
    "mul": ("*", PRODUCT),
    "div": ("/", PRODUCT),
    "less": (" < ", SUM),
}
"""The notation of the operations of two operands, with their precedence."""


def function_text(function: TimeFunction) -> str:
    """The text of a function of time; numbers have at most twelve significant digits."""
    return _text(function)[0]


def _text(of: TimeFunction) -> tuple[str, int]:
    """The text of a function, with the precedence of its outermost operation."""
    match of.kind:
        case "number":
            return _number(of.value)
        case "t":
            return "t", ATOM
        case "parameter":
            assert of.parameter is not None
            return of.parameter.symbol, ATOM
        case "input":
            return of.name, ATOM
        case "neg":
            return f"-{_inside(of.args[0], PRODUCT)}", SUM
        case "pow":
            return f"{_inside(of.args[0], ATOM)}^{_inside(of.args[1], ATOM)}", POWER
        case kind if kind in OPERATORS:
            sign, binds = OPERATORS[kind]
            left, right = of.args
            return f"{_inside(left, binds)}{sign}{_inside(right, binds + (kind in ('sub', 'div')))}", binds
    name = of.spline.name if of.spline is not None else of.kind
    return f"{name}({', '.join(function_text(arg) for arg in of.args)})", ATOM


def _inside(function: TimeFunction, binds: int) -> str:
    """The text of an operand, in parentheses if its precedence is lower."""
    text, own = _text(function)
    return f"({text})" if own < binds else text


def _number(value: Fraction) -> tuple[str, int]:
    if value == PI:
        return "pi", ATOM
    text = str(value) if max(abs(value.numerator), value.denominator) < 10**6 else f"{float(value):.12g}"
    return text, SUM if value < 0 else PRODUCT if "/" in text else ATOM
