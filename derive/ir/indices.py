"""Indices of array elements: an offset, and strides times the variables of loops.

Matrices are packed in blocks of four rows, and a matrix given by its entries for i <= j is read row by row; their
indices need the number of a block, the row in it, and the number of pairs below a variable.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import assert_never

LANES = 4
"""Lanes of a sum and rows of a block: vector units process as many at once, so that no compiler need reorder a sum."""
LANE = "l"
"""The variable of loops over lanes."""


class Of(Enum):
    """The quantity of a variable that a stride multiplies."""

    VALUE = "value"
    BLOCK = "block"
    """The quotient by the number of lanes."""
    LANE = "lane"
    """The remainder of that division."""
    CEILING = "ceiling"
    """The quotient by the number of lanes, rounded up."""
    PAIRS = "pairs"
    """The number of pairs of different numbers below it, j (j - 1) / 2."""

    def at(self, value: int) -> int:
        """The quantity for a value of the variable."""
        match self:
            case Of.VALUE:
                return value
            case Of.BLOCK:
                return value // LANES
            case Of.LANE:
                return value % LANES
            case Of.CEILING:
                return -(-value // LANES)
            case Of.PAIRS:
                return value * (value - 1) // 2
            case _:
                assert_never(self)


@dataclass(frozen=True)
class IndexTerm:
    """A stride times a quantity of a variable."""

    stride: int
    variable: str
    of: Of = Of.VALUE


@dataclass(frozen=True)
class ElementIndex:
    """The offset plus the terms."""

    offset: int = 0
    terms: tuple[IndexTerm, ...] = ()

    def at(self, values: Mapping[str, int]) -> int:
        """The number for values of the variables."""
        return self.offset + sum(term.stride * term.of.at(values[term.variable]) for term in self.terms)

    def stride(self, variable: str) -> int:
        """The distance of the elements of successive values of a variable."""
        return sum(term.stride for term in self.terms if term.variable == variable)

    def has(self, *variables: str) -> bool:
        """Whether the index depends on one of the variables."""
        return any(term.variable in variables for term in self.terms)

    def plus(self, offset: int) -> ElementIndex:
        """The index, moved by an offset."""
        return ElementIndex(self.offset + offset, self.terms)

    def scaled(self, factor: int, offset: int = 0) -> ElementIndex:
        """factor * index + offset."""
        terms = tuple(replace(term, stride=factor * term.stride) for term in self.terms)
        return ElementIndex(factor * self.offset + offset, terms)

    def with_value(self, variable: str, value: int) -> ElementIndex:
        """The index for one value of a variable."""
        offset = sum(term.stride * term.of.at(value) for term in self.terms if term.variable == variable)
        return ElementIndex(self.offset + offset, tuple(term for term in self.terms if term.variable != variable))

    def split(self, variable: str, lane: str) -> ElementIndex:
        """The index with a variable replaced by variable + lane, where the variable is a multiple of four."""
        terms: list[IndexTerm] = []
        for term in self.terms:
            if term.variable != variable:
                terms.append(term)
                continue
            match term.of:
                case Of.VALUE:
                    terms += [term, IndexTerm(term.stride, lane)]
                case Of.BLOCK:
                    assert term.stride % LANES == 0, "a block has four rows, each of which has as many elements"
                    terms.append(IndexTerm(term.stride // LANES, variable))
                case Of.LANE:
                    terms.append(IndexTerm(term.stride, lane))
                case Of.PAIRS | Of.CEILING:
                    raise AssertionError("pairs and tiles are not counted in lanes")
                case _:
                    assert_never(term.of)
        return ElementIndex(self.offset, tuple(terms))


def constant(value: int) -> ElementIndex:
    """An index without variables."""
    return ElementIndex(value)


def variable(name: str, stride: int = 1, offset: int = 0) -> ElementIndex:
    """stride * variable + offset."""
    return ElementIndex(offset, (IndexTerm(stride, name),))


def triangle(n: int, parity: int, low: str, high: str) -> ElementIndex:
    """The index of the pair low <= high in an upper triangle by rows; an odd matrix (parity -1) has no diagonal."""
    row = n - 1 if parity > 0 else n - 2
    terms = IndexTerm(row, low), IndexTerm(-1, low, Of.PAIRS), IndexTerm(1, high)
    return ElementIndex(0 if parity > 0 else -1, terms)


def padded(count: int) -> int:
    """The next multiple of four."""
    return -(-count // LANES) * LANES
