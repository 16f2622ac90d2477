"""Expressions as text: the order of operations of the Kernel, no parentheses more than that needs."""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction

from derive.ir.expressions import ArrayAccess, Expr, MatrixEntry, Number, Operator, ScalarRef
from derive.rendering import WIDTH

SIGN = {Operator.ADD: " + ", Operator.SUB: " - ", Operator.MUL: " * ", Operator.DIV: " / "}
STRENGTH = {Operator.ADD: 1, Operator.SUB: 1, Operator.NEG: 2, Operator.MUL: 2, Operator.DIV: 2}


def text(
    expr: Expr,
    number: Callable[[Fraction], str],
    call: str = "",
    index: str = "i",
    name: Callable[[ScalarRef | ArrayAccess | MatrixEntry], str] | None = None,
) -> str:
    """An expression; `number` writes constants, `call` is what sine and cosine are members of.

    `index` is what a loop counts with; `name` writes names and elements, as C does if it is not given.
    """
    return _text(expr, number, call, name or (lambda leaf: element(leaf, index)))[0]


def element(leaf: ScalarRef | ArrayAccess | MatrixEntry, index: str) -> str:
    """A name, or an element of an array in a loop, in C."""
    if isinstance(leaf, ScalarRef):
        return leaf.name
    if isinstance(leaf, MatrixEntry):
        return f"{leaf.table}[{index}]"
    place = (
        index if leaf.stride == 1 else f"{leaf.stride} * {index}" if index.isalpha() else f"{leaf.stride} * ({index})"
    )
    return f"{leaf.array}[{f'{place} + {leaf.offset}' if leaf.offset else place}]"


def _text(
    expr: Expr,
    number: Callable[[Fraction], str],
    call: str,
    name: Callable[[ScalarRef | ArrayAccess | MatrixEntry], str],
) -> tuple[str, int]:
    """The text and how strongly it binds."""
    if isinstance(expr, Number):
        written = number(expr.value)
        return written, 2 if expr.value < 0 else 3
    if isinstance(expr, ScalarRef | ArrayAccess | MatrixEntry):
        return name(expr), 3
    if expr.kind.function:
        return f"{call}{expr.kind.value}({_text(expr.args[0], number, call, name)[0]})", 3
    strength = STRENGTH[expr.kind]
    parts = [_text(arg, number, call, name) for arg in expr.args]
    if expr.kind is Operator.NEG:
        inner, binds = parts[0]
        return f"-{inner}" if binds > strength else f"-({inner})", strength
    (left, left_binds), (right, right_binds) = parts
    left = left if left_binds >= strength and not left.startswith("-") or strength == 1 else f"({left})"
    right = right if right_binds > strength else f"({right})"
    return f"{left}{SIGN[expr.kind]}{right}", strength


def c_number(value: Fraction) -> str:
    """An exact number in C: a quotient of integers, or the nearest double where that is the number itself."""
    if value.denominator == 1 and abs(value.numerator) < 2**53:
        return f"{value.numerator}.0"
    if Fraction(float(value)) == value or max(abs(value.numerator), value.denominator) >= 2**53:
        return repr(float(value))
    return f"({value.numerator}.0 / {value.denominator}.0)"


def python_number(value: Fraction) -> str:
    """An exact number in Python; integers stay integers, so that exact types stay exact."""
    if value.denominator == 1 and abs(value.numerator) < 2**53:
        return str(value.numerator)
    if Fraction(float(value)) == value or max(abs(value.numerator), value.denominator) >= 2**53:
        return repr(float(value))
    return f"({value.numerator} / {value.denominator})"


def statement(indent: str, head: str, expression: str, end: str) -> list[str]:
    """`head expression end` on as many lines as it needs, broken before a plus or a minus."""
    lines, current = [], f"{indent}{head}"
    for piece in _pieces(f"{expression}{end}"):
        if len(current) + len(piece) > WIDTH and current.strip():
            lines.append(current.rstrip())
            current = f"{indent}    {piece.lstrip()}"
        else:
            current += piece
    return [*lines, current]


def _pieces(expression: str) -> list[str]:
    """The text cut before each ` + ` and ` - `."""
    return re.split(r"(?= [+-] )", expression)
