"""Expressions as code: the order of operations of the Kernel, no parentheses more than that needs.

A text carries the strength with which it binds and its sign as data, so that no printer reads its own text again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby
from typing import NamedTuple, assert_never

from derive.backends.wrapping import BreakableText, join
from derive.ir.expressions import (
    CONDITIONS,
    Element,
    Ends,
    Expr,
    LaneSum,
    MatrixEntry,
    Number,
    Operation,
    Operator,
    ScalarRef,
    TableValue,
)
from derive.ir.indices import LANES, ElementIndex, Of

SIGN = {Operator.ADD: " + ", Operator.SUB: " - ", Operator.MUL: " * ", Operator.DIV: " / "}
SUM, PRODUCT, ATOM = 1, 2, 3
"""The binding strengths of a text: sums, products with signed numbers, and texts that never need parentheses."""
QUANTITIES = {
    Of.VALUE: "{0}",
    Of.BLOCK: f"{{0}} / {LANES}",
    Of.LANE: f"{{0}} % {LANES}",
    Of.CEILING: f"({{0}} + {LANES - 1}) / {LANES}",
    Of.PAIRS: "{0} * ({0} - 1) / 2",
}
"""The quantities of variables in indices, in C."""
BINDING = {
    **dict.fromkeys((Operator.ADD, Operator.SUB), SUM),
    **dict.fromkeys((Operator.MUL, Operator.DIV, Operator.NEG), PRODUCT),
}
CHOICES = CONDITIONS | {Operator.WHEN, Operator.SIGN}
"""The operators that are written as a choice between two values."""


Named = ScalarRef | Element | Ends | MatrixEntry
"""A leaf of an expression that code refers to by a name."""


@dataclass(frozen=True)
class Dialect:
    """The way in which a language writes numbers, calls functions and makes choices.

    suffix: what follows an integer, so that quotients are not those of integers; namespace: what precedes a function;
    names: those of functions that have other names than their operators; choice: the four texts around a condition, the
    value where it holds, and the other value; negation: what precedes a condition; lookup: the first arguments of a
    table.
    """

    suffix: str
    namespace: str
    names: Mapping[Operator, str]
    choice: tuple[str, str, str, str]
    negation: str
    lookup: str

    def number(self, value: Fraction) -> _Text:
        """An exact number: an integer, a quotient of integers, or the nearest double where that is the number itself.

        Integers of Python have no suffix, so that exact types stay exact.
        """
        binding = PRODUCT if value < 0 else ATOM
        if value.denominator == 1 and abs(value.numerator) < 2**53:
            return _Text(BreakableText((f"{value.numerator}{self.suffix}",)), binding, value < 0)
        exact = float(value).as_integer_ratio() == value.as_integer_ratio()
        if exact or max(abs(value.numerator), value.denominator) >= 2**53:
            return _Text(BreakableText((repr(float(value)),)), binding, value < 0)
        quotient = f"({value.numerator}{self.suffix} / {value.denominator}{self.suffix})"
        return _Text(BreakableText((quotient,)), binding, False)


C = Dialect(".0", "", {Operator.SIN: "tisserand_sin", Operator.COS: "tisserand_cos"}, ("(", " ? ", " : ", ")"), "!", "")
PYTHON = Dialect(
    "",
    "xp.",
    {Operator.MIN: "minimum", Operator.MAX: "maximum"},
    ("xp.where(", ", ", ", ", ")"),
    "xp.logical_not",
    "xp, ",
)


class _Text(NamedTuple):
    """Code of an expression, how strongly it binds, and whether it begins with a minus sign."""

    code: BreakableText
    binding: int
    signed: bool


def text(expr: Expr, dialect: Dialect, name: Callable[[Named], BreakableText] | None = None) -> BreakableText:
    """The code of an expression; `name` writes names and elements, as `element` does if not given."""
    return _text(expr, dialect, name or element).code


def element(leaf: Named) -> BreakableText:
    """A name, or an element of an array, in C."""
    match leaf:
        case ScalarRef():
            return BreakableText((leaf.name,))
        case Element():
            assert leaf.index
            return BreakableText((f"{leaf.array}[{index_text(leaf.index)}]",))
        case Ends() | MatrixEntry():
            raise AssertionError("entries of matrices and elements of ends have texts of their own")
        case _:
            assert_never(leaf)


def index_text(index: ElementIndex, offset_first: bool = True) -> str:
    """An index in C; its offset is first unless that is negative."""
    first = not index.terms or (index.offset > 0 and offset_first)
    parts = [str(index.offset)] if first else []
    for stride, group in groupby(index.terms, lambda term: term.stride):
        quantities = [(term.of, QUANTITIES[term.of].format(term.variable)) for term in group]
        total = " + ".join(quantity for _, quantity in quantities)
        single = len(quantities) == 1 and quantities[0][0] is Of.VALUE
        factor = total if single or stride == 1 else f"({total})"
        product = factor if abs(stride) == 1 else f"{abs(stride)} * {factor}"
        if parts:
            parts.append(f"{'-' if stride < 0 else '+'} {product}")
        else:
            parts.append(f"-{product}" if stride < 0 else product)
    if not first and index.offset:
        parts.append(f"{'-' if index.offset < 0 else '+'} {abs(index.offset)}")
    return " ".join(parts)


def _text(expr: Expr, dialect: Dialect, name: Callable[[Named], BreakableText]) -> _Text:
    match expr:
        case Number():
            return dialect.number(expr.value)
        case ScalarRef() | Element() | Ends() | MatrixEntry():
            return _Text(name(expr), ATOM, False)
        case LaneSum():
            return _text(expr.expr, dialect, name)
        case TableValue():
            argument = _text(expr.argument, dialect, name).code
            return _Text(join(f"{expr.table}({dialect.lookup}", argument, f", {expr.order})"), ATOM, False)
        case Operation():
            return _operation(expr, dialect, name)
        case _:
            assert_never(expr)


def _operation(expr: Operation, dialect: Dialect, name: Callable[[Named], BreakableText]) -> _Text:
    if expr.kind in CHOICES:
        return _chosen(expr, dialect, name)
    operands = [_text(arg, dialect, name) for arg in expr.args]
    if expr.kind not in BINDING:
        function = dialect.names.get(expr.kind, expr.kind.value)
        code = operands[0].code if len(operands) == 1 else join(operands[0].code, ", ", operands[1].code)
        return _Text(join(f"{dialect.namespace}{function}(", code, ")"), ATOM, False)
    binding = BINDING[expr.kind]
    if expr.kind is Operator.NEG:
        return _Text(join("-", _enclosed(operands[0], operands[0].binding <= binding)), binding, True)
    left, right = operands
    enclosed = binding != SUM and (left.binding < binding or left.signed)
    sign = SIGN[expr.kind]
    code = join(
        _enclosed(left, enclosed),
        BreakableText(("", sign)) if binding == SUM else sign,
        _enclosed(right, right.binding <= binding),
    )
    return _Text(code, binding, left.signed and not enclosed)


def _chosen(expr: Operation, dialect: Dialect, name: Callable[[Named], BreakableText]) -> _Text:
    """An operation whose value is chosen by a condition."""
    one, zero = (dialect.number(Fraction(value)).code for value in (1, 0))
    if expr.kind is Operator.WHEN:
        return _choice(_condition(expr.args[0], dialect, name), text(expr.args[1], dialect, name), zero, dialect)
    if expr.kind is Operator.SIGN:
        operand = _text(expr.args[0], dialect, name)
        below, above = (_compared(operand, sign, dialect.number(Fraction(0))) for sign in (" < ", " > "))
        negative = _choice(below, dialect.number(Fraction(-1)).code, zero, dialect).code
        return _choice(above, one, negative, dialect)
    return _choice(_condition(expr, dialect, name), one, zero, dialect)


def _condition(expr: Expr, dialect: Dialect, name: Callable[[Named], BreakableText]) -> BreakableText:
    """An expression as a condition: whether it is not 0."""
    match expr:
        case Operation(Operator.LESS | Operator.NOT_GREATER as kind, (left, right)):
            sign = " < " if kind is Operator.LESS else " <= "
            return _compared(_text(left, dialect, name), sign, _text(right, dialect, name))
        case Operation(Operator.NOT, (operand,)):
            return join(f"{dialect.negation}(", _condition(operand, dialect, name), ")")
        case _:
            return _compared(_text(expr, dialect, name), " != ", dialect.number(Fraction(0)))


def _compared(left: _Text, sign: str, right: _Text) -> BreakableText:
    return join(left.code, sign, right.code)


def _choice(condition: BreakableText, then: BreakableText, otherwise: BreakableText, dialect: Dialect) -> _Text:
    before, between, behind, end = dialect.choice
    return _Text(join(before, condition, between, then, behind, otherwise, end), ATOM, False)


def _enclosed(operand: _Text, enclosed: bool) -> BreakableText:
    return join("(", operand.code, ")") if enclosed else operand.code
