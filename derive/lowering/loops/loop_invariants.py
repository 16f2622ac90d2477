"""Loop invariants: expressions in an index as products of indexed symbols and scalars, which precede the loop."""

from __future__ import annotations

from collections.abc import Container, Iterable
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.symbols import I, amplitude, is_indexed, local
from derive.mechanics.terms import Intermediate

if TYPE_CHECKING:
    from derive.mechanics.typed_symbol import Symbol


class LoopInvariants:
    """The scalar factors in the loops of a kernel, each with one name.

    known: the scalars that have a name already; definitions: the intermediates that the kernel can compute, which keep
    their names. The kernel adds to both while it grows.
    """

    def __init__(self, known: Container[sp.Symbol], definitions: Iterable[Intermediate]) -> None:
        self._known = known
        self._definitions = definitions
        self._names: dict[sp.Expr, Symbol] = {}
        self._assigned = 0

    def hoisted(self, expr: sp.Expr) -> sp.Expr:
        """An expression in indices as a sum of products of indexed symbols, with scalar factors that have a name."""
        grouped: dict[sp.Expr, sp.Expr] = {}
        for term in sp.Add.make_args(sp.expand(expr)):
            scalar, indexed = term.as_independent(*(s for s in term.free_symbols if is_indexed(s)), as_Add=False)
            grouped[indexed] = grouped.get(indexed, sp.S.Zero) + scalar
        return sp.Add(*(self._factor(scalar) * indexed for indexed, scalar in grouped.items()))

    def unassigned(self) -> list[tuple[Symbol, sp.Expr]]:
        """The names that were given since the last call, with their values; the caller computes them."""
        result = [(symbol, expr) for expr, symbol in list(self._names.items())[self._assigned :]]
        self._assigned = len(self._names)
        return result

    def _factor(self, expr: sp.Expr) -> sp.Expr:
        """A scalar as it occurs in a loop: a number, a known name, or a new name for it; signs stay outside."""
        if expr.could_extract_minus_sign():
            return -self._factor(-expr)
        if expr.is_Rational or expr in self._known:
            return expr
        if expr not in self._names:
            own = local(f"f{len(self._names) + 1}")
            self._names[expr] = expr if any(d.symbol == expr for d in self._definitions) else own
        return self._names[expr]


def by_vector(term: sp.Expr) -> sp.Expr:
    """alpha_i a + alpha_i b as alpha_i (a + b), so that a loop multiplies once."""
    vectors = [amplitude(I, derivative) for derivative in range(3)]
    grouped: dict[sp.Expr, list[sp.Expr]] = {}
    for part in sp.Add.make_args(sp.expand(term)):
        first = next((v for v in vectors if v in part.free_symbols), sp.S.One)
        grouped.setdefault(first, []).append(part / first)
    return sp.Add(*(sp.Mul(v, sp.Add(*rest), evaluate=False) for v, rest in grouped.items()), evaluate=False)
