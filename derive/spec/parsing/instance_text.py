"""Texts of a table with `count`, in which `i` is the index of an instance: formulas, and references to instances."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

from derive.errors import quoted
from derive.spec.parsing.names import INDEX
from derive.spec.parsing.parser import ExpressionError, names_of
from derive.spec.parsing.time_expression import CONSTANT, number_formula

MAX_POWER = 10_000
"""The highest power in a formula, such as that of 0.9^i, whose value may have so many digits that it is rounded."""

_REFERENCE = re.compile(r"([A-Za-z][A-Za-z0-9_]*)\[([^\[\]]*)\](\.[^.\[\]]+)?")
_SHIFTED = re.compile(rf" *(?:([0-9]{{1,9}})|{INDEX} *(?:([+-]) *([0-9]{{1,9}}))?) *")
_INDEX_WORD = re.compile(rf"\b{INDEX}\b")


@dataclass(frozen=True)
class InstanceReference:
    """A reference to an instance of a table: one with a certain index, or, if `relative`, one so far from instance i.

    ending: the marker with its dot, or nothing.
    """

    table: str
    ending: str
    shift: int
    relative: bool

    def index(self, i: int) -> int:
        """The index that it refers to in instance i."""
        return self.shift + i if self.relative else self.shift


def reference(text: str) -> InstanceReference | None:
    """The reference to an instance that a text is; None for other texts. Raises ExpressionError."""
    parts = _REFERENCE.fullmatch(text)
    if parts is None:
        return None
    table, inside, ending = parts.groups(default="")
    index = _SHIFTED.fullmatch(inside)
    if index is None:
        such = f"{table}[{INDEX}], {table}[{INDEX}+1], {table}[{INDEX}-1] or {table}[3]"
        raise ExpressionError(f"{quoted(inside)} is no index of an instance; write {such}")
    number, sign, shift = index.groups(default="")
    return InstanceReference(table, ending, int(number or f"{sign}{shift or 0}"), relative=not number)


def symbol_at(text: str, i: int) -> str:
    """The symbol of a parameter in instance i, such as m_3 for m[i]. Raises ExpressionError."""
    instance = reference(text)
    return f"{instance.table}_{instance.index(i)}" if instance and not instance.ending else text


def contains_index(text: str) -> bool:
    """Whether a text is an expression that contains the index."""
    return INDEX in names_of(text)


def at_index(text: str, i: int) -> int | Fraction | str:
    """The value of an expression with the index for instance i, or the expression in which i is a number.

    The latter is the case where it contains other names, such as t or xi. The value is exact where it has few digits,
    otherwise it is that of doubles. Raises ExpressionError.
    """
    text = _INDEX_WORD.sub(str(i), text)
    if not {*names_of(text)} <= CONSTANT:
        return text
    value = number_formula(text, max_power=MAX_POWER)
    return value if value.denominator > 1 else int(value)
