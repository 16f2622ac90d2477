"""Sums over the shapes for a generic index: what loops are made of, and what is written out for each shape.

The generic indices i and j run over the shapes. `C5_i_j_11` is an entry of a table, and so is `c7_i_j_1`, which is odd
in i and j.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import sympy as sp

from derive.mechanics.symbols import Family, I, Index, J, ShapeIndex, Symbol, amplitude, identity

PARITY = {Family.C5: 1, Family.C7: -1, Family.C8: 1, Family.STIFFNESS: 1, Family.DAMPING: 1}
"""What an exchange of i and j does to a table; its entries have names for i <= j alone."""

ALPHA, ALPHADOT, ALPHADDOT = (amplitude(J, derivative) for derivative in range(3))
"""The factors of sums: amplitudes, their velocities and accelerations."""

Vectors = Mapping[Symbol, Sequence[Symbol]]
"""The factors of sums, written out for each shape."""


@dataclass(frozen=True)
class IndexedSum:
    """symbol = offset + sum over j of factor_j entry_j; the factors are those above.

    `doc` is a format string, in which `{i}` is the shape; it describes the whole quantity, of which the symbol may be
    a component.
    """

    symbol: Symbol
    offset: Symbol | None
    sums: tuple[tuple[Symbol, Symbol], ...]
    doc: str

    @property
    def section(self) -> str:
        """The moment without its indices."""
        return self.symbol.identity.section

    def described(self, i: ShapeIndex) -> str:
        """What the symbol is for a shape."""
        return component_doc(self.doc.format(i=i.value if isinstance(i, Index) else i), self.symbol)

    @property
    def indexed(self) -> bool:
        """Whether there is one for each shape i."""
        return self.symbol.identity.indexed


def component_doc(doc: str, symbol: Symbol) -> str:
    """The description of a component of a vector, from that of the vector."""
    components = symbol.identity.components
    return f"{doc} . e{components[0]}" if len(components) == 1 else doc


def exchanged(symbol: sp.Basic, indices: Mapping[Index, ShapeIndex]) -> Symbol:
    """The same quantity for other shapes; what is not in `indices` stays."""
    known = identity(symbol)
    shapes = tuple(indices.get(s, s) if isinstance(s, Index) else s for s in known.shapes)
    return Symbol(replace(known, shapes=shapes))


def swapped(entry: sp.Basic) -> Symbol:
    """A table's entry with i and j exchanged."""
    return exchanged(entry, {I: J, J: I})


def canonical(entry: sp.Basic) -> Symbol:
    """A table's entry with its indices in the order i, j."""
    known = identity(entry)
    return Symbol(known) if known.shapes == (I, J) else swapped(entry)


def of_index(expr: sp.Expr, i: ShapeIndex) -> sp.Expr:
    """An expression of the generic index i, for another shape."""
    generic = {s: exchanged(s, {I: i}) for s in expr.free_symbols if isinstance(s, Symbol) and s.identity.indexed}
    return expr.xreplace(generic)


def at(symbol: sp.Basic, i: int, j: int = 0) -> sp.Expr:
    """A generic symbol for the shapes i and j; of a table that is odd, with its sign."""
    known = identity(symbol)
    if set(known.shapes) != {I, J}:
        return exchanged(symbol, {I: i, J: j})
    parity = PARITY[known.family]
    first, second = (i, j) if known.shapes == (I, J) else (j, i)
    if first == second and parity < 0:
        return sp.S.Zero
    sign = parity if first > second else 1
    return sign * Symbol(replace(known, shapes=tuple(sorted((i, j)))))


def expanded_sum(indexed_sum: IndexedSum, i: int, vectors: Vectors) -> sp.Expr:
    """The sum for shape i, entry by entry."""
    total = at(indexed_sum.offset, i) if indexed_sum.offset else sp.S.Zero
    for factor, entry in indexed_sum.sums:
        total += sp.Add(*(a * at(entry, i, j) for j, a in enumerate(vectors[factor], 1)))
    return total


@dataclass(frozen=True)
class TableSum:
    """symbol_i = offset + sum over j of factor_j table_i_j; `sums` are pairs (factor, table entry)."""

    symbol: Symbol
    offset: sp.Expr
    sums: tuple[tuple[Symbol, Symbol], ...]
    doc: str


@dataclass(frozen=True)
class ModeSum:
    """symbol = offset + sum over i of term, which is an expression of index i."""

    symbol: Symbol
    offset: sp.Expr
    term: sp.Expr
    doc: str
