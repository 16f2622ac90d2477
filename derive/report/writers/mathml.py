"""Formulas as MathML Core."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from itertools import pairwise

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
from derive.report.notation.glyphs import index, is_letter, letter, minus, number, styled
from derive.report.notation.line_breaking import width
from derive.report.notation.signs import BIG
from derive.report.notation.signs import SIGNS as KNOWN
from derive.report.notation.spacing import Gap, argument, bare, factors, gap, needs_brackets, row_text, summand
from derive.report.notation.spoken_math import words

GAPS: dict[Gap, str] = {
    "none": "",
    "times": "<mo>\u2062</mo>",
    "thin": '<mo lspace=".17em">\u2062</mo>',
    "dot": "<mo>⋅</mo>",
}
SIGNS = {text: sign.character for sign in KNOWN for text in sign.also}
DOTS = ("", "˙", "¨", "˙˙˙")
BREAKS = {"+", "-", "\u2212", "="}
LONG = 10.0
"""The width (em) above which a sum within text may break."""
TIGHT = {"∂", "δ", "\u2032", "d"}


def math(formula: Formula, display: bool = False) -> str:
    """A formula as a `math` element; those of more than one letter carry their words."""
    alt_text = "" if isinstance(formula, NumberToken | Name) else f' alttext="{escape(words(formula))}"'
    shown = ' display="block"' if display else ""
    return f"<math{shown}{alt_text}>{inside(formula)}</math>"


def math_in_text(formula: Formula) -> str:
    """A formula within text: a long sum is several `math` elements, between which a line may end."""
    parts = factors(formula) if isinstance(formula, FormulaRow) else []
    starts = [k for k, part in enumerate(parts) if k and isinstance(part, OperatorToken) and part.text in BREAKS]
    if not starts or width(formula) < LONG:
        return math(formula)
    pieces = [parts[a:b] for a, b in pairwise([0, *starts, len(parts)])]
    return "".join(_piece(piece, k == 0) for k, piece in enumerate(pieces))


def _piece(parts: Sequence[Formula], first: bool) -> str:
    return f'<math alttext="{escape(words(FormulaRow(tuple(parts))))}">{_row(parts, behind=not first)}</math>'


def summand_math(part: Part, first: bool) -> str:
    """A summand with its sign as a `math` element."""
    sign = "" if first and part.sign == "+" else f'<mo form="{"prefix" if first else "infix"}">{_sign(part.sign)}</mo>'
    return f"<math>{sign}{inside(summand(part.formula, part.sign))}</math>"


def relation_math(text: str) -> str:
    """A relation by itself."""
    return f'<math><mo form="infix">{_sign(text)}</mo></math>'


def inside(formula: Formula) -> str:
    """The content of a `math` element; a row needs no `mrow` there, because `math` lays out its content as a row."""
    return _row(factors(formula)) if isinstance(formula, FormulaRow) else mathml(formula)


def mathml(formula: Formula, last: bool = True) -> str:
    """A formula as one element; `last`: nothing follows that could be read as a part of an argument."""
    match formula:
        case NumberToken(text):
            return _number(text)
        case Name():
            return _name(formula)
        case OperatorToken(text):
            return _operator(text)
        case FormulaRow():
            return f"<mrow>{_row(factors(formula))}</mrow>"
        case Quotient(above, below):
            return f"<mfrac>{mathml(above)}{mathml(below)}</mfrac>"
        case Power(base, exponent):
            return _power(base, exponent, last)
        case Root(of):
            return f"<msqrt>{inside(of)}</msqrt>"
        case Fenced(of, left, right):
            return f"<mrow>{_fence(left, 'prefix')}{inside(of)}{_fence(right, 'postfix')}</mrow>"
        case Call():
            return f"<mrow>{_word(formula.name)}{_argument(formula, last)}</mrow>"
        case Matrix(rows):
            cells = "".join(f"<mtr>{''.join(_cell(item) for item in row)}</mtr>" for row in rows)
            return f"<mrow><mo>[</mo><mtable>{cells}</mtable><mo>]</mo></mrow>"


def _row(parts: Sequence[Formula], behind: bool = False) -> str:
    """Formulas side by side; if they are `behind` others, a sign that they start with is a binary operator."""
    start = parts[0] if parts else None
    if isinstance(start, OperatorToken) and (behind or start.text in ("+", "=")):
        return f'<mo form="infix">{_sign(start.text)}</mo>{_row(parts[1:])}'
    return row_text(parts, mathml, lambda *pair: GAPS[gap(*pair)])


def _number(text: str) -> str:
    mantissa, exponent = number(text)
    digits = f"<mn>{escape(minus(mantissa))}</mn>"
    if not exponent:
        return digits
    power = escape(minus(exponent))
    return f"<mrow>{digits}<mo>⋅</mo><msup><mn>10</mn><mn>{power}</mn></msup></mrow>"


def _operator(text: str) -> str:
    sign = SIGNS.get(text, letter(text))
    if sign in TIGHT or sign.isalpha():
        return f'<mi mathvariant="normal">{escape(sign)}</mi>' if sign == "d" else f"<mi>{escape(sign)}</mi>"
    return f"<mo>{escape(sign)}</mo>"


def _sign(text: str) -> str:
    return escape(SIGNS.get(text, text))


def _fence(text: str, form: str) -> str:
    bar = f' form="{form}" fence="true" stretchy="true"' if text == "|" else ""
    return f"<mo{bar}>{escape(text)}</mo>"


def _name(name: Name) -> str:
    return _scripts(_nucleus(name), _index(name.below), _index(name.above), name.text)


def _scripts(base: str, below: str, above: str, text: str = "") -> str:
    stem = "munder|mover|munderover" if text in BIG and text != "∫" else "msub|msup|msubsup"
    under, over, both = stem.split("|")
    if below and above:
        return f"<{both}>{base}{below}{above}</{both}>"
    if below or above:
        tag = under if below else over
        return f"<{tag}>{base}{below}{above}</{tag}>"
    return base


def _nucleus(name: Name) -> str:
    text = letter(name.text)
    if text in BIG:
        return f"<mo>{text}</mo>"
    match name.style:
        case "vector":
            base = f"<mi>{escape(styled(text, 'BOLD ITALIC'))}</mi>"
        case "tensor":
            base = f"<mi>{escape(styled(text, 'BOLD'))}</mi>"
        case "word":
            base = _word(text)
        case _:
            base = f"<mi>{escape(text if is_letter(text) else styled(text, 'ITALIC'))}</mi>"
    if not name.dots:
        return base
    return f'<mover accent="true">{base}<mo>{DOTS[min(name.dots, 3)]}</mo></mover>'


def _word(text: str) -> str:
    return f"<mi>{escape(text)}</mi>" if len(text) > 1 else f'<mi mathvariant="normal">{escape(text)}</mi>'


def _index(indices: tuple[str, ...]) -> str:
    """Indices beside each other; numbers and commas alone are one element, which keeps large pages small."""
    words = index(indices)
    if len(words) > 1 and all(word == "," or word.isdigit() for word in words):
        return f"<mn>{''.join(words)}</mn>"
    out = (
        [_index_word(item) for item in index(indices)] if not any(" " in item for item in indices) else _spaced(indices)
    )
    return "".join(out) if len(out) < 2 else f"<mrow>{''.join(out)}</mrow>"


def _spaced(indices: tuple[str, ...]) -> list[str]:
    """Indices of several words, such as the piece of a rod, with room between the words."""
    out: list[str] = []
    for k, item in enumerate(indices):
        out += ["<mo>,</mo>"] if k else []
        for j, word in enumerate(item.split(" ")):
            out += ['<mspace width=".25em"/>'] if j else []
            out += map(_index_word, index((word,)))
    return out


def _index_word(text: str) -> str:
    if text[0].isdigit():
        return f"<mn>{text}</mn>"
    if letter(text).isalpha():
        return f"<mi>{letter(text)}</mi>"
    return f"<mo>{_sign(text)}</mo>"


def _power(base: Formula, exponent: Formula, last: bool) -> str:
    above = mathml(exponent)
    if isinstance(base, Name) and not base.above:
        return _scripts(_nucleus(base), _index(base.below), above, base.text)
    if isinstance(base, Call):
        return f"<mrow><msup>{_word(base.name)}{above}</msup>{_argument(base, last)}</mrow>"
    inner = Fenced(base) if needs_brackets(base) or isinstance(base, Name) else base
    return f"<msup>{mathml(inner)}{above}</msup>"


def _argument(call: Call, last: bool) -> str:
    if bare(call, last):
        return f'<mo rspace=".17em">\u2061</mo>{mathml(call.of)}'
    return f"<mo>\u2061</mo>{mathml(argument(call))}"


def _cell(formula: Formula | None) -> str:
    return "<mtd><mo>·</mo></mtd>" if formula is None else f"<mtd>{inside(formula)}</mtd>"
