"""Names of rows in plain letters, for headings, pictures and links: `alpha1` is α₁."""

from __future__ import annotations

import re

from derive.report.document.formula import Formula, Name, Operator, Row
from derive.report.notation.glyphs import letter
from derive.report.notation.names import known

SUBSCRIPT = str.maketrans("0123456789i", "₀₁₂₃₄₅₆₇₈₉ᵢ")
ROW = re.compile(r"(?:(.*)_)?(c|phi|pi|alpha|s)_?([0-9]+|i)?")


def label(row: str) -> str:
    """A row by its letter, behind its body if it has one."""
    found = ROW.fullmatch(row)
    if found is None:
        return row
    body, name, number = found.groups()
    said = letter(name) + (number or "").translate(SUBSCRIPT)
    return f"{body.replace('_', ' ')} {said}" if body else said


def delta(row: str) -> str:
    """The virtual displacement of a row."""
    before, _, own = label(row).rpartition(" ")
    return f"{before} δ{own}".strip()


def variation(row: str) -> Formula:
    """The virtual displacement of a row as a formula."""
    if found := re.fullmatch(r"pi([0-9])", row):
        return Row((Operator("δ"), Name("pi", below=(found[1],))))
    entry = known(row)
    return Row((Operator("δ"), entry.formula if entry else Name(row, style="word")))
