"""The words of the derivation as text with formulas: what an integral is, and why something vanishes."""

from __future__ import annotations

import re

from derive.report.document.formula import Formula, Fraction, Name, Number, Operator, Power, Row
from derive.report.document.page import Inline, Math, Text
from derive.report.notation.names import known, table

NAME = r"[A-Za-z]+[0-9]*(?:_(?:[0-9]+|[ij]))*"
TOKEN = re.compile(rf"\(d2 phi_([0-9]+)/dx2\)|{NAME}|[0-9]+|[().,=+-]|\S")

RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")

WHOLE = ("c1", "c2", "C3", "C4", "C5", "c6", "c7", "c8", "K", "B")
VECTORS = ("X", "r", "rdot", "rddot", "u", "omega")
ENTRY = re.compile(rf"\b(?:{'|'.join(WHOLE)})(?:_(?:[0-9]+|[ij]))+\b")
FAMILY = re.compile(rf"\b({'|'.join(WHOLE)})\b(?= = 0| is odd)")
RANGE = re.compile(r" \.\. ")
OTHER = re.compile(r"\be[123]\b|\bxi\b|\bm I\b|omega x \(J \. omega\) = 0")


def doc(text: str) -> Text:
    """What an integral is, such as `int rho X . e1, for each i`: words, a formula where there is one, and words."""
    place = text.find("int ")
    if place < 0:
        return reason(text)
    told, comma, rest = text[place:].partition(", ")
    formula = formula_of(told)
    if formula is None:
        return (text,)
    before = text[:place].removesuffix(": ").strip()
    return (*((f"{before} ",) if before else ()), Math(formula), *((comma + rest,) if rest else ()))


def unit(text: str) -> str:
    """A unit with its powers raised, on one line."""
    return re.sub(r"\^([0-9]+)", lambda found: found[1].translate(RAISED), text).replace(" ", "\N{NO-BREAK SPACE}")


def formula_of(text: str) -> Formula | None:
    """A formula of integrals in the words of the derivation; None if there are others in it."""
    found: list[Formula] = []
    for match in TOKEN.finditer(text):
        part = _token(match)
        if part is None:
            return None
        found.append(part)
    if text.startswith("int ") and not text.endswith(" dx"):
        found += [Operator("d"), Name("Omega")]
    return Row(tuple(found))


def _token(match: re.Match[str]) -> Formula | None:
    text = match[0]
    if match[1]:
        above = Row((Power(Operator("d"), Number("2")), Name("ϕ", below=(match[1],))))
        return Fraction(above, Row((Operator("d"), Power(Name("x"), Number("2")))))
    if text == "int":
        return Name("∫")
    if text in "().,=+-" or text == "x":
        return Operator({"x": "\u00d7", ".": "·"}.get(text, text))
    if text.isdigit():
        return Number(text)
    if text in ("rho", "EI", "m"):
        return Name(text)
    if text in VECTORS:
        letters = re.sub("d*dot$", "", text)
        return Name(letters, dots=len(text) - len(letters) - 2 if letters != text else 0, style="vector")
    if text in ("I", "J"):
        return Name(text, style="tensor")
    if text == "dx":
        return Row((Operator("d"), Name("x")))
    if found := re.fullmatch(r"(Phi|e)_?([0-9]+|[ij])", text):
        return Name(found[1], below=(found[2],), style="vector")
    return None


def reason(text: str) -> Text:
    """Why something vanishes, with the integrals in it as formulas."""
    found: list[Inline] = []
    place = 0
    for match in re.finditer("|".join(p.pattern for p in (ENTRY, FAMILY, RANGE, OTHER)), text):
        found += [text[place : match.start()]] if match.start() > place else []
        found.append(_inline(match[0]))
        place = match.end()
    return (*found, text[place:]) if text[place:] else tuple(found)


def _inline(text: str) -> Inline:
    if text == " .. ":
        return " … "
    if text in WHOLE:
        return Math(table(text))
    if text == "xi":
        return Math(Name("xi"))
    if OTHER.fullmatch(text):
        formula = formula_of(text)
        return Math(formula) if formula else text
    entry = known(text)
    return Math(entry.formula) if entry else text
