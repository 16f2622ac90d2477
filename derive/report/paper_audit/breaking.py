"""Long brackets broken between their summands, so that a line of the paper may break on a narrow page."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from derive.report.document.formula import Equation, Fenced, Formula, FormulaRow, OperatorToken, Part, Quotient
from derive.report.notation.expressions import row
from derive.report.notation.spacing import factors

LONG = 9
"""A bracket of more names than this is broken."""


def broken(equation: Equation) -> Equation:
    """An equation whose long brackets are several parts: the first opens the bracket, the last closes it."""
    return replace(equation, parts=tuple(piece for part in equation.parts for piece in _pieces(part)))


def _pieces(part: Part) -> Iterator[Part]:
    parts = factors(part.formula) if isinstance(part.formula, FormulaRow) else [part.formula]
    long = [k for k, item in enumerate(parts) if isinstance(item, Fenced) and size(item) > LONG]
    if len(long) != 1:
        yield part
        return
    (at,) = long
    bracket = parts[at]
    assert isinstance(bracket, Fenced)
    terms = list(_terms(bracket.of))
    if len(terms) == 1:
        yield part
        return
    for k, (sign, term) in enumerate(terms):
        first, last = k == 0, k == len(terms) - 1
        opening = [*parts[:at], OperatorToken(bracket.left), *([OperatorToken("-")] if sign == "-" else [])]
        closing = [OperatorToken(bracket.right), *parts[at + 1 :]]
        whole = [*(opening if first else []), *term, *(closing if last else [])]
        yield replace(part, formula=row(whole)) if first else Part("-" if sign == "-" else "+", row(whole))


def _terms(of: Formula) -> Iterator[tuple[str, list[Formula]]]:
    sign, gathered = "+", list[Formula]()
    for item in factors(of) if isinstance(of, FormulaRow) else [of]:
        if isinstance(item, OperatorToken) and item.text in ("+", "-"):
            if gathered:
                yield sign, gathered
            sign, gathered = item.text, []
        else:
            gathered.append(item)
    yield sign, gathered


def size(of: Formula) -> int:
    """The number of names and numbers that a formula has beside each other."""
    match of:
        case FormulaRow():
            return sum(map(size, factors(of)))
        case Quotient(above, below):
            return max(size(above), size(below))
        case OperatorToken():
            return 0
        case Fenced(inside):
            return size(inside)
        case _:
            return 1
