"""The widths of formulas, and the lines of a long sum: for languages that cannot break lines by themselves."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby, pairwise

from derive.report.document.formula import (
    Call,
    Fenced,
    Formula,
    FormulaRow,
    Matrix,
    Name,
    NumberToken,
    OperatorToken,
    Part,
    Power,
    Quotient,
    Root,
)
from derive.report.notation.glyphs import index, letter, number
from derive.report.notation.signs import BIG
from derive.report.notation.spacing import bare, factors, gap, summand

LETTER, SMALL, SIGN = 0.57, 0.4, 1.4
GAPS = {"none": 0.0, "times": 0.0, "thin": 0.17, "dot": 0.7}


def lines(parts: Sequence[Part], room: float) -> tuple[tuple[int, ...], ...]:
    """The indices of the parts of each line, no wider than `room` em if possible. A group that does not fit behind the
    last one starts a line of its own."""
    result: list[list[int]] = [[]]
    used = 0.0
    for _, group in groupby(range(len(parts)), lambda k: parts[k].group):
        places = list(group)
        whole = sum(part_width(parts[k]) for k in places)
        if result[-1] and used + whole > room:
            result.append([])
            used = 0.0
        for k in places:
            own = part_width(parts[k])
            if result[-1] and used + own > room:
                result.append([])
                used = 0.0
            result[-1].append(k)
            used += own
    return tuple(tuple(line) for line in result if line)


def part_width(part: Part) -> float:
    """The width of a summand with its sign, in em."""
    return SIGN + width(summand(part.formula, part.sign))


def width(formula: Formula) -> float:
    """The width of a formula, in em, about."""
    match formula:
        case NumberToken(text):
            mantissa, exponent = number(text)
            return 0.5 * len(mantissa) + (1.7 + SMALL * len(exponent) if exponent else 0)
        case Name():
            return _name(formula)
        case OperatorToken(text):
            return LETTER if text.isalpha() else 0.6 if text in "∫∂" else SIGN
        case FormulaRow():
            parts = factors(formula)
            return sum(width(part) for part in parts) + sum(GAPS[gap(a, b)] for a, b in pairwise(parts))
        case Quotient(above, below):
            return 0.25 + max(width(above), width(below))
        case Power(base, exponent):
            return width(base) + 0.7 * width(exponent)
        case Root(of):
            return 0.9 + width(of)
        case Fenced(of):
            return 0.9 + width(of)
        case Call(name, of):
            return 0.5 * len(name) + width(of) + (0.17 if bare(formula, True) else 0.9)
        case Matrix(rows):
            columns = list(zip(*rows, strict=True))
            cells = [max(0.3 if item is None else width(item) for item in column) for column in columns]
            return 1.0 + sum(cells) + 0.9 * len(cells)


def _name(name: Name) -> float:
    below, above = (sum(SMALL * len(letter(item)) for item in index(indices)) for indices in (name.below, name.above))
    return (1.0 if name.text in BIG else LETTER * len(letter(name.text))) + max(below, above)
