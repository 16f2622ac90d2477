"""The sums over the modes that motions define, expanded for each mode, without the entries that vanish."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics import zeros
from derive.mechanics.sums import (
    ALPHA,
    ALPHADDOT,
    ALPHADOT,
    AbsentPart,
    IndexedSum,
    Vectors,
    exchanged,
    expanded_sum,
)
from derive.mechanics.symbols import Family, I
from derive.mechanics.terms import Intermediate, Reason

if TYPE_CHECKING:
    from derive.mechanics.motion.body_motion import Motion


@dataclass(frozen=True)
class ExpandedSums:
    """The expanded sums over the modes by their symbols, and the vanishing parts that they leave out."""

    exprs: Mapping[sp.Symbol, sp.Expr]
    absent: Mapping[sp.Symbol, tuple[AbsentPart, ...]]

    def put_in(self, expr: sp.Expr) -> sp.Expr:
        """Replace the sums in an expression by their expansions; the result is expanded."""
        known = self.exprs.get(expr)
        if known is not None:
            return known
        return sp.expand(expr.xreplace(self.exprs)) if expr.free_symbols & self.exprs.keys() else expr

    def __or__(self, other: ExpandedSums) -> ExpandedSums:
        return ExpandedSums({**self.exprs, **other.exprs}, {**self.absent, **other.absent})


def expanded_sums(motion: Motion, sums: Iterable[IndexedSum], vanishing: Iterable[sp.Basic] = ()) -> ExpandedSums:
    """The sums without a name of their own, expanded for the modes of a motion, without the parts that vanish.

    A sum that refers to an earlier one contains its expansion. One whose parts all vanish keeps them, so that they
    are known where it occurs.
    """
    exprs: dict[sp.Symbol, sp.Expr] = {}
    absent: dict[sp.Symbol, tuple[AbsentPart, ...]] = {}
    earlier: set[tuple[Family, int]] = set()
    known, vectors = {*vanishing}, _vectors(motion)
    for s in sums:
        entries = (*(entry for _, entry in s.sums), *([s.offset] if s.offset else []))
        refers = any((e.identity.family, e.identity.derivative) in earlier for e in entries)
        for i in range(1, len(motion.alpha) + 1) if s.indexed else (0,):
            symbol = exchanged(s.symbol, {I: i})
            expr, gone = expanded_sum(s, i, vectors, known)
            if expr == 0:
                known.add(symbol)
                expr, gone = expanded_sum(s, i, vectors)
            exprs[symbol] = sp.expand(expr.xreplace(exprs)) if refers else expr
            absent[symbol] = tuple(gone)
        earlier.add((s.symbol.identity.family, s.symbol.identity.derivative))
    return ExpandedSums(exprs, absent)


def expanded_moments(
    motion: Motion, reasons: zeros.Reasons | None = None
) -> tuple[tuple[Intermediate, ...], zeros.Reasons]:
    """The named products and moments of a motion for each mode, without their vanishing parts, which have reasons.

    reasons: those of the symbols that vanish; the result contains those of the vanished moments as well. Without
    reasons nothing vanishes.
    """
    known, result, vectors = dict(reasons or {}), list(motion.named), _vectors(motion)
    for s, i in _every(motion.moment_sums, len(motion.alpha)):
        symbol = exchanged(s.symbol, {I: i})
        expr, vanished = expanded_sum(s, i, vectors, known)
        zero = None
        if expr == 0:
            known[symbol] = zeros.behind([entry for entry, _ in vanished], known)
            zero = str(Reason(known[symbol], "it vanishes identically"))
        result.append(Intermediate(symbol, expr, s.section, s.source, s.described(i), zero))
    return tuple(result), known


def _vectors(motion: Motion) -> Vectors:
    """The symbols of the factors of sums, mode by mode."""
    return {ALPHA: motion.alpha, ALPHADOT: motion.alphadot, ALPHADDOT: motion.alphaddot}


def _every(indexed_sums: Iterable[IndexedSum], n: int) -> Iterator[tuple[IndexedSum, int]]:
    """Yield each sum with the number of each mode, moment by moment; with 0 if it is not indexed by a mode."""
    for _, group in groupby(indexed_sums, lambda s: s.section):
        members = tuple(group)
        for i in range(1, n + 1) if members[0].indexed else (0,):
            for s in members:
                yield s, i
