"""Formulas written in a line, such as `Q . {X + u}`, as trees: those that no symbol of the derivation gives.

Names are single letters, Greek letters by their names or ϕ, and the words below; primes are dots of time, `_1` and
`_{ij}` indices. A superscript of digits is a power, any other stays with its name (`Q^c`). The signs `.`, `><` and `:`
are the products of vectors and tensors; `delta`, `partial` and the d of `dxi` stand before what they act on; `int` and
`sum` may have limits; `1/2` with spaces around it is a fraction, other strokes stay in the line.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Literal

from derive.report.document.formula import (
    Call,
    Equation,
    Fenced,
    Formula,
    FormulaRow,
    Name,
    NumberToken,
    OperatorToken,
    Part,
    Power,
    Quotient,
)
from derive.report.document.page import CodeSpan, Math
from derive.report.notation.glyphs import GREEK
from derive.report.notation.typeset_names import TENSORS, stem

Style = Literal["scalar", "vector", "tensor", "word"]

_TOKEN = re.compile(
    r"(?P<space>\s+)|(?P<half>1/2(?=\s))|(?P<number>\d+)|(?P<letters>[A-Za-z]+|ϕ)|(?P<prime>'+)|(?P<script>[_^])"
    r"|(?P<sign>><|!=|[-+=.:/,|])|(?P<open>[({\[])|(?P<close>[)}\]])"
)
_CLOSING = {"(": ")", "[": "]", "{": "}"}
_SIGNS = {".": "·", "><": "\u00d7", "delta": "δ", "partial": "∂"}
_BIG = {"int": "∫", "sum": "\u2211", "nabla": "∇"}
_WORDS = {"EI", "tr", "det", "rotation", "for", "and", "each"}

VECTORS = {"x", "X", "c", "u", "b", "n", "q", "e", "v", "w", "p", "d", "r"}
VECTORS |= {"omega", "pi", "Phi", "Psi", "alpha", "nabla"}
MATRICES = {"Q", "F", "I", "T", "E"} | {"".join(stem(family)) for family in TENSORS}
"""The letters that are bold: VECTORS are vectors and columns, MATRICES are tensors and matrices."""

BOLD = {"Q", "X", "c", "e", "u", "omega", "pi"}
"""The letters that are bold also in formulas of the beam, whose components are scalars."""


def formula(text: str, scalars: bool = False) -> Formula:
    """A formula of one line; `scalars`: its letters are scalars, as for the beam in components."""
    return _plain(_Reader(text, scalars).parts())


def marked_text(text: str, scalars: bool = False) -> tuple[str | Math | CodeSpan, ...]:
    """Words with formulas between dollar signs and code between backticks."""
    result: list[str | Math | CodeSpan] = []
    for part in filter(None, re.split(r"(\$[^$]*\$|`[^`]*`)", text)):
        match part[0]:
            case "$":
                result.append(Math(formula(part[1:-1], scalars)))
            case "`":
                result.append(CodeSpan(part[1:-1]))
            case _:
                result.append(part)
    return tuple(result)


def equation(text: str, scalars: bool = False, number: str = "") -> Equation:
    """A line `left = right`, or `name: right`, whose right side may break between its summands; with its number."""
    parts = _Reader(text, scalars).parts()
    signs = list(map(text_of, parts))
    at = next((signs.index(sign) for sign in ("=", ":") if sign in signs), None)
    if at is None:
        return Equation(FormulaRow(()), summands(parts), "", number)
    return Equation(_plain(parts[:at]), summands(parts[at + 1 :]), text_of(parts[at]), number)


def text_of(part: Formula) -> str:
    """The sign of an operator; empty for other formulas."""
    return part.text if isinstance(part, OperatorToken) else ""


def _plain(parts: tuple[Formula, ...]) -> Formula:
    return parts[0] if len(parts) == 1 else FormulaRow(parts)


class _Reader:
    """The words of a line, one after the other."""

    def __init__(self, text: str, scalars: bool) -> None:
        self.text = text
        self.scalars = scalars
        self.indexed = ("c",) if scalars else ()
        self.words: list[tuple[str, str]] = []
        self.at = 0
        place = 0
        while place < len(text):
            result = _TOKEN.match(text, place)
            if result is None or result.lastgroup is None:
                raise ValueError(f"{text!r}: what is {text[place:]!r}?")
            if result.lastgroup != "space":
                self.words.append((result.lastgroup, result[0]))
            place = result.end()

    def parts(self, close: str = "") -> tuple[Formula, ...]:
        """The formulas up to a closing bracket, or to the end."""
        result: list[Formula] = []
        while self.at < len(self.words) and self.words[self.at][1] != close:
            result += self._one()
        if close:
            self._take(close)
        return tuple(result)

    def _take(self, wanted: str = "") -> tuple[str, str]:
        if self.at == len(self.words) or (wanted and self.words[self.at][1] != wanted):
            raise ValueError(f"{self.text!r}: {wanted or 'something'} is missing")
        self.at += 1
        return self.words[self.at - 1]

    def _next(self, kind: str) -> bool:
        return self.at < len(self.words) and self.words[self.at][0] == kind

    def _one(self) -> Iterator[Formula]:
        kind, text = self._take()
        if kind == "number":
            yield self._raised(NumberToken(text))
        elif kind == "half":
            yield Quotient(NumberToken("1"), NumberToken("2"))
        elif kind == "sign":
            yield OperatorToken(_SIGNS.get(text, text))
        elif kind == "open":
            yield self._raised(Fenced(_plain(self.parts(_CLOSING[text])), text, _CLOSING[text]))
        elif kind != "letters":
            raise ValueError(f"{self.text!r}: {text} cannot stand there")
        elif text in ("sin", "cos"):
            yield Call(text, next(self._one()))
        elif text in ("delta", "partial"):
            yield self._raised(OperatorToken(_SIGNS[text]))
        else:
            yield from self._letters(text)

    def _letters(self, text: str) -> Iterator[Formula]:
        if text not in GREEK and text not in _BIG and text not in _WORDS and len(text) > 1:
            if not text.startswith("d"):
                raise ValueError(f"{self.text!r}: {text} is no name")
            yield OperatorToken("d")
            text = text[1:]
        dots = len(self._take()[1]) if self._next("prime") else 0
        below: tuple[str, ...] = ()
        above: tuple[str, ...] = ()
        while self._next("script"):
            if self._take()[1] == "_":
                below = (self._script(),)
            elif self._next("number") and text not in _BIG:
                name = Name(_BIG.get(text, text), dots, below, above, self._style(text, below))
                yield Power(name, NumberToken(self._script()))
                return
            else:
                above = (self._script(),)
        yield Name(_BIG.get(text, text), dots, below, above, self._style(text, below))

    def _script(self) -> str:
        """An index: one word, or the content of braces."""
        text = self._take()[1]
        if text != "{":
            return text.replace("'", "\N{PRIME}")
        words = []
        while (text := self._take()[1]) != "}":
            words.append(text)
        return " ".join(words).replace(" ,", ",").replace("- ", "-")

    def _raised(self, base: Formula) -> Formula:
        if not self._next("script") or self.words[self.at][1] != "^":
            return base
        self._take()
        word = self._script()
        return Power(base, NumberToken(word) if word.isdigit() else Name(word, style="word"))

    def _style(self, text: str, below: tuple[str, ...]) -> Style:
        if text in _WORDS or text in ("int", "sum"):
            return "scalar" if text == "EI" else "word"
        if (below and text in ("alpha", "K", *self.indexed)) or (self.scalars and text not in BOLD):
            return "scalar"
        if text in MATRICES or text + "".join(below)[:1] in MATRICES:
            return "tensor"
        return "vector" if text in VECTORS else "scalar"


def summands(parts: Iterable[Formula]) -> tuple[Part, ...]:
    """The summands of a sum, from its formulas and the signs between them."""
    result: list[Part] = []
    sign: Literal["+", "-"] = "+"
    gathered: list[Formula] = []
    for part in parts:
        if text_of(part) not in ("+", "-"):
            gathered.append(part)
            continue
        result += [Part(sign, _plain(tuple(gathered)))] if gathered else []
        sign, gathered = "-" if text_of(part) == "-" else "+", []
    return (*result, Part(sign, _plain(tuple(gathered))))
