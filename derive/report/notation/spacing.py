"""The separators between the factors of a formula, and where brackets are needed: the same in every language."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import zip_longest
from typing import Literal

from derive.report.document.formula import (
    Call,
    Equation,
    Fenced,
    Formula,
    FormulaRow,
    Matrix,
    Name,
    NumberToken,
    OperatorToken,
    Power,
    Quotient,
)
from derive.report.notation.glyphs import is_letter
from derive.report.notation.signs import BIG

Gap = Literal["none", "times", "thin", "dot"]
SUMS = {"+", "-", "\u2212", "±"}


def factors(row: FormulaRow) -> list[Formula]:
    """The formulas of a row, with those of rows in it."""
    return [item for part in row.parts for item in (factors(part) if isinstance(part, FormulaRow) else [part])]


def gap(left: Formula, right: Formula) -> Gap:
    """The separator of two formulas: nothing, an invisible times, that and a thin space, or a dot."""
    if _is_sign(left) or isinstance(right, OperatorToken):
        differential = right == OperatorToken("d") and not _is_sign(left)
        return "thin" if differential else "none"
    if isinstance(left, NumberToken) and _starts_with_digit(right):
        return "dot"
    return "thin" if _is_word(left) or _is_word(right) else "times"


def row_text(
    parts: Sequence[Formula], write: Callable[[Formula, bool], str], between: Callable[[Formula, Formula], str]
) -> str:
    """Formulas side by side; write: one of them, and whether nothing follows that could be a part of its argument."""
    pieces = []
    for part, following in zip_longest(parts, parts[1:]):
        pieces.append(write(part, following is None or isinstance(following, OperatorToken)))
        pieces.append("" if following is None else between(part, following))
    return "".join(pieces)


def argument(call: Call) -> Formula:
    """The argument of a function, in brackets."""
    return call.of if isinstance(call.of, Fenced) else Fenced(call.of)


def _is_sign(formula: Formula) -> bool:
    return isinstance(formula, OperatorToken) or (isinstance(formula, Name) and formula.text in BIG)


def _starts_with_digit(formula: Formula) -> bool:
    inner = formula.base if isinstance(formula, Power) else formula
    return isinstance(inner, NumberToken) or (isinstance(inner, Quotient) and isinstance(inner.above, NumberToken))


def _is_word(formula: Formula) -> bool:
    inner = formula.base if isinstance(formula, Power) else formula
    return isinstance(inner, Call) or (isinstance(inner, Name) and (not is_letter(inner.text) or inner.text in BIG))


def needs_brackets(base: Formula) -> bool:
    """Whether the base of a power needs brackets."""
    many = isinstance(base, FormulaRow) and len(factors(base)) != 1
    return many or isinstance(base, Quotient | Power) or (isinstance(base, NumberToken) and not base.text.isdecimal())


def is_sum(formula: Formula) -> bool:
    """Whether there is a plus or minus after the start of a formula, outside brackets."""
    return isinstance(formula, FormulaRow) and any(
        isinstance(item, OperatorToken) and item.text in SUMS for item in factors(formula)[1:]
    )


def summand(formula: Formula, sign: str) -> Formula:
    """A formula behind a sign; a sum behind a minus gets brackets."""
    return Fenced(formula) if sign == "-" and is_sum(formula) else formula


def bare(call: Call, last: bool) -> bool:
    """Whether the argument of a function needs no brackets: one letter or number, and nothing that follows it."""
    return last and isinstance(call.of, Name | NumberToken)


def is_tall(formula: Formula) -> bool:
    """Whether brackets around a formula have to be higher than a line."""
    match formula:
        case Quotient() | Matrix():
            return True
        case FormulaRow(parts):
            return any(is_tall(part) for part in parts)
        case Power(base, _):
            return is_tall(base)
        case Fenced(of):
            return is_tall(of)
        case _:
            return False


def has_matrix(equation: Equation) -> bool:
    """Whether an equation holds a matrix, which cannot be broken."""
    return any(_has_matrix(item) for item in (equation.left, *(part.formula for part in equation.parts)))


def _has_matrix(formula: Formula) -> bool:
    match formula:
        case Matrix():
            return True
        case FormulaRow(parts):
            return any(_has_matrix(part) for part in parts)
        case Fenced(of):
            return _has_matrix(of)
        case Power(base, _):
            return _has_matrix(base)
        case _:
            return False
