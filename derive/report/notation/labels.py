"""Rows of the equations of motion, by the coordinates that they are of: as formulas, and in plain letters."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from derive.mechanics.equations import Equations
from derive.mechanics.symbols import Family, Identity, identity
from derive.report.document.formula import Formula, FormulaRow, OperatorToken
from derive.report.notation.families import written
from derive.report.notation.glyphs import letter
from derive.report.notation.typeset_names import index_text

if TYPE_CHECKING:
    pass

SUBSCRIPT = str.maketrans("0123456789i", "₀₁₂₃₄₅₆₇₈₉ᵢ")

SHAPE = "alpha_i"
"""The name of the row of a generic shape."""


def row_identities(equations: Equations) -> dict[str, Identity]:
    """The coordinates or virtual rotations that the rows are of, by the names of the rows."""
    return {row.name: _varied(identity(row.v)) for row in equations.rows}


def _varied(velocity: Identity) -> Identity:
    """The quantity whose variation belongs to a velocity: its coordinate or, if it is angular, the virtual rotation."""
    if velocity.family is Family.ANGULAR_VELOCITY:
        return replace(velocity, family=Family.VIRTUAL_ROTATION)
    return replace(velocity, derivative=0)


def label(known: Identity) -> str:
    """A coordinate in plain letters, behind its body if it has one: rod 1 α₁."""
    own = _letters(known)
    return f"{_body(known)} {own}" if known.owner else own


def delta(known: Identity) -> str:
    """A virtual displacement in plain letters: rod 1 δα₁."""
    own = f"δ{_letters(known)}"
    return f"{_body(known)} {own}" if known.owner else own


def variation(known: Identity) -> Formula:
    """A virtual displacement as a formula."""
    return FormulaRow((OperatorToken("δ"), written(known.symbol).formula))


def _letters(known: Identity) -> str:
    indices = "".join((*map(index_text, known.shapes), *map(str, known.components)))
    return letter(known.family.stem) + indices.translate(SUBSCRIPT)


def _body(known: Identity) -> str:
    return known.owner.replace("_", " ")
