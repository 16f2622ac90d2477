"""Formulas in words, as one reads them aloud."""

from __future__ import annotations

from itertools import pairwise

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
    Root,
)
from derive.report.notation.glyphs import NAMES, index, number
from derive.report.notation.signs import BIG
from derive.report.notation.signs import SIGNS as KNOWN
from derive.report.notation.spacing import bare, factors, gap, needs_brackets, summand

SIGNS = {text: sign.words for sign in KNOWN if sign.words for text in sign.texts} | {"*": "star"}
DOTS = ("", " dot", " double dot", " triple dot")
POWERS = {"2": "squared", "3": "cubed"}


def words(formula: Formula) -> str:
    """A formula in words."""
    match formula:
        case NumberToken(text):
            return _number(text)
        case Name():
            return _name(formula)
        case OperatorToken(text):
            return SIGNS.get(text, NAMES.get(text, text))
        case FormulaRow():
            return _row(factors(formula))
        case Quotient(above, below):
            plain = all(isinstance(item, Name | NumberToken) for item in (above, below))
            phrase = f"{words(above)} over {words(below)}"
            return phrase if plain else f"fraction {phrase} end fraction"
        case Power(base, exponent):
            inner = Fenced(base) if needs_brackets(base) else base
            raised = POWERS.get(exponent.text) if isinstance(exponent, NumberToken) else None
            return f"{words(inner)} {raised or f'to the power {words(exponent)}'}"
        case Root(of):
            return f"root of {words(of)} end root"
        case Fenced(of, left, right):
            kind = {"(": "bracket", "[": "square bracket", "{": "brace", "|": "bar"}.get(left, "bracket")
            return f"{'open ' + kind if left else ''} {words(of)} {'close ' + kind if right else ''}".strip()
        case Call(name, of):
            inner = of if bare(formula, True) or isinstance(of, Fenced) else Fenced(of)
            return f"{name} of {words(inner)}"
        case Matrix(rows):
            phrase = "; ".join(
                f"row {k}: {', '.join('zero' if item is None else words(item) for item in row)}"
                for k, row in enumerate(rows, 1)
            )
            return f"{len(rows)} by {len(rows[0]) if rows else 0} matrix, {phrase}, end matrix"


def equation_words(equation: Equation) -> str:
    """An equation in words."""
    relation = equation.relation if equation.relation == ":" else SIGNS.get(equation.relation, equation.relation)
    phrase = [words(equation.left), relation]
    for k, part in enumerate(equation.parts):
        phrase += [SIGNS[part.sign]] if k or part.sign == "-" else []
        phrase.append(words(summand(part.formula, part.sign)))
    return " ".join(item for item in phrase if item)


def _number(text: str) -> str:
    mantissa, exponent = number(text)
    phrase = mantissa.replace("-", "minus ").replace("\u2212", "minus ")
    return f"{phrase} times 10 to the power {exponent.replace('-', 'minus ')}" if exponent else phrase


def _name(name: Name) -> str:
    phrase = SIGNS.get(name.text, NAMES.get(name.text, name.text)) + DOTS[min(name.dots, 3)]
    links = (" from", " to") if name.text in BIG else (" sub", " super")
    for link, indices in zip(links, (name.below, name.above), strict=True):
        spoken = [SIGNS.get(item, NAMES.get(item, item)) for item in index(indices) if item != ","]
        phrase += f"{link} {' '.join(spoken)}" if spoken else ""
    return phrase


def _row(parts: list[Formula]) -> str:
    phrase = [words(part) for part in parts[:1]]
    for left, right in pairwise(parts):
        phrase += ["times"] if gap(left, right) == "dot" else []
        phrase.append(words(right))
    return " ".join(item for item in phrase if item)
