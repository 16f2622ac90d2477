"""Sums over the assumed modes, with generic indices i and j that run from 1 to the number of modes.

Three classes describe a sum at three stages. An `IndexedSum` is a definition of the derivation (appendix of the paper)
in which nothing vanishes yet. For a given body it becomes a `TableSum`, the product of a table with a vector of mode
amplitudes, or a `ModeSum`, a scalar that is summed over all modes, or it vanishes. Loops compute the last two;
`expanded_sum` expands the first for each mode. `C5_i_j_11` is an entry of a table; so is `c7_i_j_1`, which is odd in i
and j.
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, TypeAlias

from derive.algebra import sp
from derive.mechanics.symbols import Family, I, Index, J, ShapeIndex, amplitude, identity, is_indexed
from derive.roles import Source

if TYPE_CHECKING:
    from derive.mechanics.typed_symbol import Symbol

PARITY = {
    Family.C5: 1,
    Family.C7: -1,
    Family.C8: 1,
    Family.C9: 1,
    Family.C10: 1,
    Family.POINT_SECOND: 1,
    Family.STIFFNESS: 1,
    Family.DAMPING: 1,
    Family.ROTARY: 1,
}
"""The sign by which an entry changes when i and j are exchanged; only the entries with i <= j have names."""

ALPHA, ALPHADOT, ALPHADDOT = (amplitude(J, derivative) for derivative in range(3))
"""The factors of sums: amplitudes, their velocities and accelerations."""

HALF_ALPHA = ALPHA / 2
"""The factor of what is quadratic in the amplitudes."""

IJ, JI = (I, J), (J, I)
"""The indices of an entry of a table."""

Vectors: TypeAlias = "Mapping[Symbol, Sequence[Symbol]]"
"""The symbols of each factor of a sum, mode by mode."""


AbsentPart: TypeAlias = "tuple[Symbol, sp.Expr]"
"""A part of a sum that vanishes: the entry that is zero, and its factor."""


@dataclass(frozen=True)
class IndexedSum:
    """The definition symbol = offset + sum over j of factor_j entry_j, for a generic mode j.

    `sums` are the pairs (factor, entry); the factors are ALPHA, ALPHADOT and ALPHADDOT, or a number times one of them.
    `offset` is None where there is no constant part. `doc` is a format string, in which `{i}` is the mode; it describes
    the whole quantity, of which the symbol may be a component.
    """

    symbol: Symbol
    offset: Symbol | None
    sums: tuple[tuple[sp.Expr, Symbol], ...]
    doc: str
    source: Source = Source.APPENDIX

    @property
    def section(self) -> str:
        """The name of the moment without its indices, which names a section of the generated code."""
        return identity(self.symbol).section

    def described(self, i: ShapeIndex) -> str:
        """The description of the symbol for mode i."""
        return component_doc(self.doc.format(i=i), self.symbol)

    @property
    def indexed(self) -> bool:
        """Whether the symbol has the generic index i, so that the sum exists once for each mode."""
        return is_indexed(self.symbol)


def component_doc(doc: str, symbol: Symbol) -> str:
    """The description of a component of a vector, from that of the vector."""
    components = symbol.identity.components
    return f"{doc} . e{components[0]}" if len(components) == 1 else doc


def exchanged(symbol: sp.Basic, indices: Mapping[Index, ShapeIndex]) -> Symbol:
    """Return the same sum for other modes: `indices` maps generic indices to their replacements."""
    known = identity(symbol)
    return known.of_shapes(tuple([indices.get(s, s) if isinstance(s, Index) else s for s in known.shapes])).symbol


def swapped(entry: sp.Basic) -> Symbol:
    """Return the entry of a table with i and j exchanged."""
    return exchanged(entry, {I: J, J: I})


def canonical(entry: sp.Basic) -> Symbol:
    """Return the entry of a table with its indices in the order i, j."""
    known = identity(entry)
    return known.symbol if known.shapes == (I, J) else swapped(entry)


def of_index(expr: sp.Expr, i: ShapeIndex, index: Index = I) -> sp.Expr:
    """Return an expression in a generic index with the index replaced by a mode."""
    generic = {s: exchanged(s, {index: i}) for s in expr.free_symbols if is_indexed(s)}
    return expr.xreplace(generic)


def signed_entry(symbol: Symbol, i: int = 0, j: int = 0) -> tuple[int, Symbol]:
    """Return a generic symbol at the modes i and j, with its sign, which is 0 for i = j in an odd table."""
    generic, sign = symbol.identity.shapes, 1
    shapes: tuple[ShapeIndex, ...]
    if generic in (IJ, JI):
        shapes = (i, j) if i < j else (j, i)
        if i == j:
            sign = max(0, PARITY[symbol.identity.family])
        elif (i > j) is (generic == IJ):
            sign = PARITY[symbol.identity.family]
    else:
        shapes = tuple([i if s is I else j if s is J else s for s in generic])
    entries = _known_entries(symbol)
    entry = entries.get(shapes)
    if entry is None:
        entry = entries[shapes] = symbol.identity.of_shapes(shapes).symbol
    return sign, entry


@cache
def _known_entries(symbol: Symbol) -> dict[tuple[ShapeIndex, ...], Symbol]:
    """A cache of the symbols that a generic symbol stands for: a lookup is faster than the construction of a symbol.

    An entry of a table is the same with its indices exchanged.
    """
    return _known_entries(swapped(symbol)) if symbol.identity.shapes == JI else {}


def expanded_sum(
    indexed_sum: IndexedSum, i: int, vectors: Vectors, vanishing: Container[sp.Basic] = ()
) -> tuple[sp.Expr, list[AbsentPart]]:
    """Return the sum for mode i as an explicit sum without vanishing entries, and the parts left out.

    vectors: the symbols of each factor. vanishing: the symbols that are zero.
    """
    parts, gone = list[sp.Expr](), list[AbsentPart]()
    if indexed_sum.offset:
        _, symbol = signed_entry(indexed_sum.offset, i)
        if symbol in vanishing:
            gone.append((symbol, sp.S.One))
        else:
            parts.append(symbol)
    for factor, entry in indexed_sum.sums:
        number, vector = factor.as_coeff_Mul()
        for j, a in enumerate(vectors[vector], 1):
            sign, symbol = signed_entry(entry, i, j)
            if symbol in vanishing:
                gone.append((symbol, a))
            elif sign:
                parts.append(_product(sign * number, a, symbol))
    return sp.Add(*parts), gone


def _product(number: sp.Rational, a: sp.Symbol, entry: Symbol) -> sp.Expr:
    """The product of a number, an amplitude a (or its rate) and an entry.

    The factors get the order of SymPy, which is most of its work in a product of any expressions.
    """
    if number.is_zero or a == entry:
        return number * a * entry
    factors = (a, entry) if a.compare(entry) < 0 else (entry, a)
    return sp.Mul._from_args(factors if number is sp.S.One else (number, *factors), True)


@dataclass(frozen=True)
class TableSum:
    """The product of a table with a vector: symbol_i = offset_i + sum over j of factor_j table_i_j, for each mode i.

    `sums` are the pairs (factor, table entry).
    """

    symbol: Symbol
    offset: sp.Expr
    sums: tuple[tuple[sp.Expr, Symbol], ...]
    doc: str
    source: Source = Source.APPENDIX


@dataclass(frozen=True)
class ModeSum:
    """A scalar sum over the modes: symbol = offset + sum over i of term, an expression in the generic index i."""

    symbol: Symbol
    offset: sp.Expr
    term: sp.Expr
    doc: str
    source: Source = Source.APPENDIX
