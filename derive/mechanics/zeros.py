"""Structural zeros: expressions without their vanishing parts, and the reason of each zero."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from operator import attrgetter
from typing import Any, TypeAlias

from derive.algebra import sp
from derive.mechanics.terms import Intermediate, ModelConstant, Reason, Term, Vanished

Reasons: TypeAlias = "dict[sp.Symbol, tuple[tuple[sp.Symbol, str], ...]]"
"""The integrals behind each vanishing symbol, as pairs (integral, reason)."""


def reasons_of(coefficients: tuple[ModelConstant, ...]) -> Reasons:
    """The coefficients that vanish, each with its reason."""
    return {c.symbol: ((c.symbol, c.zero),) for c in coefficients if c.zero}


def drop(expr: sp.Expr, reasons: Reasons) -> sp.Expr:
    """An expression without its vanishing parts."""
    return expr.xreplace(_Zeros(reasons))


class _Zeros(Mapping[Any, Any]):
    """A mapping from each vanishing symbol to zero: a dict would have to be built again for each expression."""

    def __init__(self, reasons: Reasons) -> None:
        self._reasons = reasons

    def __len__(self) -> int:
        return len(self._reasons)

    def __iter__(self) -> Iterator[sp.Basic]:
        return iter(self._reasons)

    def __contains__(self, symbol: object) -> bool:
        return symbol in self._reasons

    def __getitem__(self, symbol: sp.Basic) -> sp.Expr:
        if symbol in self._reasons:
            return sp.S.Zero
        raise KeyError(symbol)


def why(expr: sp.Expr, reasons: Reasons) -> Reason:
    """The reason why an expression vanishes: the integrals that are zero in it; empty if there are none."""
    return Reason(behind(expr.free_symbols, reasons))


def behind(symbols: Iterable[sp.Basic], reasons: Reasons) -> tuple[tuple[sp.Symbol, str], ...]:
    """The integrals behind vanishing symbols, each with its reason, in order."""
    pairs = {pair[0]: pair for symbol in symbols for pair in reasons.get(symbol, ())}
    return tuple([pairs[symbol] for symbol in sorted(pairs, key=attrgetter("identity.order"))])


def drop_definitions(
    definitions: tuple[Intermediate, ...], reasons: Reasons
) -> tuple[tuple[Intermediate, ...], Reasons]:
    """Definitions without their vanishing parts, and the reasons with those of the vanished definitions added."""
    known, kept = dict(reasons), []
    for definition in definitions:
        expr = drop(definition.expr, known)
        zero = None
        if expr == 0:
            known[definition.symbol] = behind(definition.expr.free_symbols, known)
            zero = str(Reason(known[definition.symbol], "it vanishes identically"))
        kept.append(replace(definition, expr=expr, zero=zero))
    return tuple(kept), known


def drop_terms(terms: tuple[Term, ...], reasons: Reasons) -> tuple[tuple[Term, ...], tuple[Vanished, ...]]:
    """The terms that stay, without their vanishing parts, and those that vanish, with reasons."""
    stay, gone = [], []
    for term in terms:
        expr = drop(term.expr, reasons)
        if expr != 0:
            stay.append(replace(term, expr=expr))
        else:
            gone.append(Vanished(term, why(term.expr, reasons)))
    return tuple(stay), tuple(gone)
