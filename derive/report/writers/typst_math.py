"""Formulas as Typst: what is no letter, number or known sign is a string there, and never markup."""

from __future__ import annotations

from collections.abc import Sequence

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
from derive.report.notation.glyphs import GREEK, index, letter, minus, number
from derive.report.notation.signs import BIG
from derive.report.notation.signs import SIGNS as KNOWN
from derive.report.notation.spacing import Gap, argument, bare, factors, gap, needs_brackets, row_text, summand

GAPS: dict[Gap, str] = {"none": " ", "times": " ", "thin": " thin ", "dot": " dot.op "}
SIGNS = {text: sign.typst for sign in KNOWN for text in sign.texts}
DOTS = ("", "dot", "dot.double", "dot.triple")


def string(text: str) -> str:
    """Text as a string of Typst."""
    plain = "".join(c if c.isprintable() else " " for c in text)
    return '"' + plain.replace("\\", "\\\\").replace('"', '\\"') + '"'


def typst_math(formula: Formula, last: bool = True) -> str:
    """A formula within dollars of Typst; `last`: nothing follows that could be read as a part of an argument."""
    match formula:
        case NumberToken(text):
            return _number(text)
        case Name():
            return _scripts(_nucleus(formula), _index(formula.below), _index(formula.above))
        case OperatorToken(text):
            return _sign(text)
        case FormulaRow():
            return _row(factors(formula))
        case Quotient(above, below):
            return f"frac({typst_math(above)}, {typst_math(below)})"
        case Power(base, exponent):
            return _power(base, typst_math(exponent), last)
        case Root(of):
            return f"sqrt({typst_math(of)})"
        case Fenced(of, left, right):
            return f"lr({_sign(left) if left else ''} {typst_math(of)} {_sign(right) if right else ''})"
        case Call():
            return f"op({string(formula.name)}) {_argument(formula, last)}"
        case Matrix(rows):
            lines = "; ".join(", ".join("dot.op" if item is None else typst_math(item) for item in row) for row in rows)
            return f'mat(delim: "[", {lines})'


def summand_typst(part: Part, first: bool) -> str:
    """A summand with its sign; the sign of the first summand is set close to it."""
    sign = "" if first and part.sign == "+" else _sign(part.sign)
    kind = f'class("{"unary" if first else "binary"}", {sign}) ' if sign else ""
    return f"{'' if first else 'zws '}{kind}{typst_math(summand(part.formula, part.sign))}"


def relation_typst(text: str) -> str:
    """A relation."""
    return _sign(text) if text else ""


def _row(parts: Sequence[Formula]) -> str:
    return row_text(parts, typst_math, lambda *pair: " " if Call in map(type, pair) else GAPS[gap(*pair)])


def _number(text: str) -> str:
    mantissa, exponent = number(text)
    digits = minus(mantissa)
    shown = mantissa if mantissa.replace(".", "", 1).isdecimal() and mantissa.isascii() else string(digits)
    return f"{shown} dot.op 10^{string(minus(exponent))}" if exponent else shown


def _sign(text: str) -> str:
    if text in SIGNS:
        return SIGNS[text]
    item = letter(text)
    return item if len(item) == 1 and item.isalpha() else string(text)


def _nucleus(name: Name) -> str:
    text = letter(name.text)
    if text in BIG:
        return SIGNS[text]
    plain = text if len(text) == 1 and (text in GREEK.values() or text.isalpha()) else string(text)
    match name.style:
        case "vector":
            base = f"bold(italic({plain}))"
        case "tensor":
            base = f"bold(upright({plain}))"
        case "word":
            base = f"upright({plain})"
        case _:
            base = f"italic({plain})" if len(text) > 1 or text.isupper() else plain
    return f"{DOTS[min(name.dots, 3)]}({base})" if name.dots else base


def _scripts(base: str, below: str, above: str) -> str:
    scripts = [f"{place}: {item}" for place, item in (("b", below), ("t", above)) if item]
    return f"attach({', '.join([base, *scripts])})" if scripts else base


def _index(indices: tuple[str, ...]) -> str:
    return " ".join(_index_word(item) for item in index(indices))


def _index_word(text: str) -> str:
    if text[0].isdigit():
        return text
    return _sign(text) if text in SIGNS and text != "d" else letter(text) if len(letter(text)) == 1 else string(text)


def _power(base: Formula, exponent: str, last: bool) -> str:
    if isinstance(base, Call):
        return f"{_scripts(f'op({string(base.name)})', '', exponent)} {_argument(base, last)}"
    if isinstance(base, Name) and not base.above:
        return _scripts(_nucleus(base), _index(base.below), exponent)
    fenced = needs_brackets(base) or isinstance(base, Name)
    return _scripts(typst_math(Fenced(base) if fenced else base), "", exponent)


def _argument(call: Call, last: bool) -> str:
    return typst_math(call.of if bare(call, last) else argument(call))
