"""The names that formulas are made of: what a symbol is written with, and where it stands in a product."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from itertools import takewhile

from derive.mechanics.symbols import Family, Identity, Index, ShapeIndex
from derive.report.document.formula import Formula, Name


class Rank(IntEnum):
    """The order of the factors in a product."""

    CONSTANT = 0
    MOMENT = 1
    AMPLITUDE = 2
    VELOCITY = 3
    ACCELERATION = 4
    ROTATION = 5
    SINE = 6


@dataclass(frozen=True)
class TypesetSymbol:
    """A symbol in formulas: its rank in products, and how it is written."""

    rank: Rank
    formula: Formula


MOTION = (Rank.AMPLITUDE, Rank.VELOCITY, Rank.ACCELERATION)
"""Ranks of coordinates by their time derivatives."""

TENSORS = {Family.C3, Family.C4, Family.C5, Family.C8, Family.D2, Family.S, Family.INERTIA}
TENSORS |= {Family.STIFFNESS, Family.DAMPING, Family.ROTARY}
"""Families whose whole tables are tensors or matrices; those of the others are vectors or columns."""


def chosen(text: str) -> Name:
    """A name that the user of a specification chose: its letters, then digits and what follows them as an index.

    `EI` stays as it is, `l1` is l with the index 1, `m_rod` is m with the index rod. This is typography alone: no fact
    about a quantity is taken from such a name.
    """
    letters = "".join(takewhile(lambda c: c.isascii() and c.isalpha(), text))
    if not letters:
        return Name(text, style="word")
    rest = text[len(letters) :]
    digits = "".join(takewhile(str.isdigit, rest))
    words = rest[len(digits) :].removeprefix("_").replace("_", " ").strip()
    below = ",".join(part for part in (digits, words) if part)
    return Name(letters, below=(below,) if below else ())


def whole(family: Family) -> Name:
    """A whole integral or moment, without the indices of shapes and components: the vector c2, the tensor C4."""
    letter, number = stem(family)
    return Name(letter, below=(number,) if number else (), style="tensor" if family in TENSORS else "vector")


def indexed(family: Family, *shapes: ShapeIndex) -> Name:
    """A whole integral or moment of some shapes, without the indices of its components: c2 i."""
    letter, number = stem(family)
    below = " ".join(part for part in (number, *map(index_text, shapes)) if part)
    return Name(letter, below=(below,) if below else (), style="tensor" if family in TENSORS else "vector")


def index_text(shape: ShapeIndex) -> str:
    """A shape index as text: 1, 2, ... or i, j."""
    return shape.value if isinstance(shape, Index) else str(shape)


def column(dots: int = 0, transposed: bool = False) -> Name:
    """The column of the amplitudes, or of their derivatives."""
    return Name("alpha", dots=dots, above=("T",) if transposed else (), style="vector")


def stem(family: Family) -> tuple[str, str]:
    """The letter and the number of an integral or a moment."""
    return family.stem[:1], family.stem[1:]


def subscript(number: str, known: Identity) -> tuple[str, ...]:
    """The number of the integral, the shapes and the components, separated by commas."""
    shapes = [index_text(s) for s in known.shapes]
    close = " " if known.indexed else ""
    beside = close.join(shapes) if all(len(s) == 1 for s in shapes) else ",".join(shapes)
    text = ",".join(part for part in (number, beside, component_digits(known)) if part)
    return (text,) if text else ()


def component_digits(known: Identity) -> str:
    """The components as digits."""
    return "".join(map(str, known.components))
