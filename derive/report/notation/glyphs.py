"""Letters of formulas: Greek names, styled letters of Unicode, numbers and indices taken apart."""

from __future__ import annotations

import re
import unicodedata
from functools import cache

_SMALL = """alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho sigma tau upsilon
phi chi psi omega"""

GREEK = {
    name: unicodedata.lookup(f"GREEK {case} LETTER {name.upper().replace('LAMBDA', 'LAMDA')}")
    for small in _SMALL.split()
    for case, name in (("SMALL", small), ("CAPITAL", small.capitalize()))
}
"""Greek letters by their names: `phi` and `Phi`."""

NAMES = {letter: name for name, letter in GREEK.items()}
"""The names of Greek letters."""

_TOKEN = re.compile(r"[0-9]+(?:\.[0-9]+)?|[A-Za-z]+|[^\s0-9A-Za-z]")


def minus(text: str) -> str:
    """Text with minus signs for its hyphens."""
    return text.replace("-", "\u2212")


def letter(text: str) -> str:
    """The letter of a Greek name, and any other text as it is."""
    return GREEK.get(text, text)


def is_letter(text: str) -> bool:
    """Whether a name is one letter, Greek ones by their name too."""
    return len(letter(text)) == 1


@cache
def styled(text: str, style: str) -> str:
    """Text in mathematical letters, such as `BOLD ITALIC`; what Unicode lacks stays as it is."""
    return "".join(_styled(c, style) for c in text)


def _styled(c: str, style: str) -> str:
    if style == "ITALIC" and c == "h":
        return "\u210e"
    case = {"Lu": "CAPITAL ", "Ll": "SMALL ", "Nd": "DIGIT "}.get(unicodedata.category(c), "")
    style = style.removesuffix(" ITALIC") if case == "DIGIT " else style
    name = unicodedata.name(c, "").removeprefix("LATIN ").removeprefix("GREEK ")
    plain = name.removeprefix(case).removeprefix("LETTER ")
    try:
        return unicodedata.lookup(f"MATHEMATICAL {style} {case}{plain}") if case else c
    except KeyError:
        return c


def number(text: str) -> tuple[str, str]:
    """A number without its exponent, and the exponent or nothing: `1.5e-05` is 1.5 and -5."""
    result = re.fullmatch(r"([-+]?[0-9]*\.?[0-9]+)[eE]([-+]?)0*([0-9]+)", text)
    return (result[1], result[2].replace("+", "") + result[3]) if result else (text, "")


def index(indices: tuple[str, ...]) -> list[str]:
    """The words of indices; single letters are set side by side, others are separated by commas."""
    close = all(is_letter(item) or set(item) <= set("'*\u2032") for item in indices)
    words: list[str] = []
    for k, item in enumerate(indices):
        words += [","] if k and not close else []
        words += _TOKEN.findall(item)
    return words
