"""Formulas as LaTeX with amsmath, which Markdown understands as well."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

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
    Part,
    Power,
    Quotient,
    Root,
)
from derive.report.notation.glyphs import index, is_letter, letter, number
from derive.report.notation.line_breaking import lines, width
from derive.report.notation.signs import BIG
from derive.report.notation.signs import SIGNS as KNOWN
from derive.report.notation.spacing import Gap, argument, bare, factors, gap, is_tall, needs_brackets, row_text, summand
from derive.report.writers.latex_text import GREEK, escaped

GAPS: dict[Gap, str] = {"none": " ", "times": " ", "thin": " \\, ", "dot": " \\cdot "}
SIGNS = {text: sign.latex for sign in KNOWN for text in sign.texts} | GREEK
FUNCTIONS = {
    "sin",
    "cos",
    "tan",
    "cot",
    "exp",
    "log",
    "ln",
    "sinh",
    "cosh",
    "tanh",
    "arcsin",
    "arccos",
    "arctan",
    "det",
}
DOTS = ("", "\\dot", "\\ddot", "\\dddot")
ITALIC = {c: f"\\var{command[1:]}" for c, command in GREEK.items() if c.isupper() and "mathrm" not in command}


def latex_math(formula: Formula, text: Callable[[str], str] = escaped) -> str:
    """A formula as LaTeX; `text` is how words are shown that are no letters and digits of English."""
    return _resolved(_tree(formula), text)


def equation_latex(equation: Equation, room: float, tag: str, text: Callable[[str], str] = escaped) -> str:
    """An equation of `align` on lines of `room` em, if possible, with the command of its number."""
    summands = [_summand(part, k == 0, text) for k, part in enumerate(equation.parts)]
    broken = lines(equation.parts, room - width(equation.left))
    rows = [" ".join(summands[k] for k in places) for places in broken] or [""]
    body = " \\notag \\\\\n  &\\quad ".join(rows)
    return f"{latex_math(equation.left, text)} &{_relation(equation.relation)} {body} {tag}"


def _summand(part: Part, first: bool, text: Callable[[str], str]) -> str:
    """A summand with its sign."""
    sign = "" if first and part.sign == "+" else f"{part.sign} " if not first else part.sign
    return f"{sign}{latex_math(summand(part.formula, part.sign), text)}"


def _relation(text: str) -> str:
    """A relation; a colon behind the name of a row is set close to it."""
    return "\\colon\\quad" if text == ":" else _resolved(_sign(text), escaped) if text else ""


def _odd(text: str) -> str:
    """A word of other characters, put aside until it is known how to show it."""
    return f"\\text{{\0{text.encode().hex()}\0}}"


def _resolved(shown: str, text: Callable[[str], str]) -> str:
    return re.sub("\0([0-9a-f]*)\0", lambda result: text(bytes.fromhex(result[1]).decode()), shown)


def _tree(formula: Formula, last: bool = True) -> str:
    """A formula as LaTeX; `last`: nothing follows that could be read as a part of an argument."""
    match formula:
        case NumberToken(text):
            return _number(text)
        case Name():
            return _name(formula)
        case OperatorToken(text):
            return _sign(text)
        case FormulaRow():
            return _row(factors(formula))
        case Quotient(above, below):
            return f"\\frac{{{_tree(above)}}}{{{_tree(below)}}}"
        case Power(base, exponent):
            return _power(base, _tree(exponent), last)
        case Root(of):
            return f"\\sqrt{{{_tree(of)}}}"
        case Fenced():
            return _fenced(formula)
        case Call():
            return f"{_function(formula.name)}{_argument(formula, last)}"
        case Matrix(rows):
            lines = " \\\\{} ".join(
                " & ".join("\\cdot" if item is None else _tree(item) for item in row) for row in rows
            )
            columns = "c" * max((len(row) for row in rows), default=1)
            return f"\\left[\\begin{{array}}{{{columns}}} {lines} \\end{{array}}\\right]"


def _row(parts: Sequence[Formula]) -> str:
    return row_text(parts, _tree, lambda part, after: " " if isinstance(after, Call) else GAPS[gap(part, after)])


def _number(text: str) -> str:
    mantissa, exponent = number(text)
    digits = mantissa if set(mantissa) <= set("-+.0123456789") else _odd(mantissa)
    return f"{digits} \\cdot 10^{{{exponent}}}" if exponent else digits


def _sign(text: str) -> str:
    if text.isascii() and text.isalpha() and len(text) == 1:
        return SIGNS.get(text, text)
    return SIGNS.get(letter(text)) or _odd(text)


def _name(name: Name) -> str:
    below, above = _index(name.below), _index(name.above)
    return f"{_nucleus(name)}{f'_{{{below}}}' if below else ''}{f'^{{{above}}}' if above else ''}"


def _nucleus(name: Name) -> str:
    text = letter(name.text)
    if text in BIG:
        return SIGNS[text]
    base = _styled(text, name.style)
    return f"{DOTS[min(name.dots, 3)]}{{{base}}}" if name.dots else base


def _styled(text: str, style: str) -> str:
    if text.isascii() and not text.isalnum() or text not in SIGNS and not text.isascii():
        return _odd(text)
    upright = text if text.isascii() else SIGNS[text]
    italic = ITALIC.get(text, upright)
    match style:
        case "vector":
            return f"\\boldsymbol{{{italic}}}"
        case "tensor":
            return f"\\mathbf{{{text}}}" if text.isascii() else f"\\boldsymbol{{{upright}}}"
        case "word":
            return f"\\mathrm{{{text}}}" if text.isascii() else upright
        case _:
            return italic if is_letter(text) else f"\\mathit{{{text}}}"


def _index(indices: tuple[str, ...]) -> str:
    return " ".join(_index_word(item) for item in index(indices))


def _index_word(text: str) -> str:
    if text[0].isdigit() or (is_letter(text) and letter(text).isascii() and text.isalpha()):
        return text
    return f"\\mathrm{{{text}}}" if text.isascii() and text.isalpha() and letter(text) == text else _sign(text)


def _power(base: Formula, exponent: str, last: bool) -> str:
    if isinstance(base, Call):
        return f"{_function(base.name)}^{{{exponent}}}{_argument(base, last)}"
    fenced = needs_brackets(base) or (isinstance(base, Name) and bool(base.above))
    return f"{_tree(Fenced(base) if fenced else base)}^{{{exponent}}}"


def _fenced(formula: Fenced) -> str:
    left, right = (_sign(item) if item else "." for item in (formula.left, formula.right))
    inner = _tree(formula.of)
    if is_tall(formula.of) or "." in (left, right):
        return f"\\left{left} {inner} \\right{right}"
    return f"{left}{' ' if left[-1].isalpha() else ''}{inner}{right}"


def _function(name: str) -> str:
    if name in FUNCTIONS:
        return f"\\{name}"
    return f"\\operatorname{{{name}}}" if name.isascii() and name.isalnum() else _odd(name)


def _argument(call: Call, last: bool) -> str:
    if bare(call, last):
        return f" {_tree(call.of)}"
    return _tree(argument(call))
