"""The order of the terms of sums and of the factors of products, so that those of a model share sub-expressions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from derive.algebra import fraction, sp
from derive.lowering.flat.shared_sums import SharedSums


@dataclass(frozen=True)
class OrderedSum:
    """A sum as a part that others share and constant terms behind it, or as terms with their signs.

    varying: the part, or the whole sum if it is none in terms of the first of equal quantities; None if there are
    terms, of which positive ones come first.
    """

    varying: sp.Expr | None
    constant: Sequence[sp.Expr] = ()
    terms: Sequence[tuple[int, sp.Expr]] = ()


class FactorPlace(Enum):
    """The place of a factor in a product: before the division, behind it, or in its divisor."""

    FIRST = 0
    LAST = 1
    BELOW = 2


@dataclass(frozen=True)
class OrderedProduct:
    """A product: its number, and its factors in order, each with its place, whether it is a root, and how often.

    doubled: a factor that is multiplied by a further 2, since other products have twice this factor as well.
    """

    negative: bool
    magnitude: Fraction
    factors: Sequence[tuple[sp.Expr, FactorPlace, bool, int]]
    doubled: sp.Expr | None = None


class TermOrder:
    """The order of terms and factors, which is found once for each expression.

    early, late: the symbols that come first and last in products, so that products share sub-expressions: velocities,
    whose products occur in many terms, are early; the rotation, in which the rows of a vector differ, is late.
    sums: what sums share.
    """

    def __init__(self, early: frozenset[sp.Symbol], late: frozenset[sp.Symbol], sums: SharedSums) -> None:
        self.early, self.late, self.shared = early, late, sums
        self._sums: dict[sp.Expr, OrderedSum] = {}
        self._products: dict[sp.Expr, OrderedProduct] = {}

    def sum(self, expr: sp.Expr) -> OrderedSum:
        """The terms of a sum in a fixed order, with a positive term first if there is one."""
        if expr not in self._sums:
            self._sums[expr] = self._sum(expr)
        return self._sums[expr]

    def product(self, expr: sp.Expr) -> OrderedProduct:
        """The factors of a product, early ones first. Raises TypeError for powers that are not of square roots."""
        if expr not in self._products:
            self._products[expr] = self._product(expr)
        return self._products[expr]

    def _sum(self, expr: sp.Expr) -> OrderedSum:
        varying, constant = self.shared.divided(expr)
        if constant or not varying.is_Add:
            return OrderedSum(varying, constant)
        terms = [_signed(term) for term in self._collected(self.shared.collected(varying))]
        terms.sort(key=lambda signed: (signed[0] < 0, sp.default_sort_key(signed[1])))
        return OrderedSum(None, terms=terms)

    def _collected(self, terms: Sequence[sp.Expr]) -> list[sp.Expr]:
        """The terms of a sum, with a cos + b cos as (a + b) cos, so that the rows of a rotated vector share a + b."""
        collected: list[sp.Expr] = []
        late = self.late & {symbol for term in terms for symbol in term.free_symbols}
        if not late:
            return [*terms]
        remaining = [(term, term.as_powers_dict()) for term in terms]
        for symbol in sorted(late, key=sp.default_sort_key):
            group = [(t, powers) for t, powers in remaining if powers.get(symbol) == 1]
            if len(group) > 1:
                remaining = [(t, powers) for t, powers in remaining if powers.get(symbol) != 1]
                collected.append(sp.Mul(symbol, sp.Add(*(t / symbol for t, _ in group))))
        return [t for t, _ in remaining] + collected

    def _product(self, expr: sp.Expr) -> OrderedProduct:
        weight, rest = expr.as_coeff_Mul()
        factors = []
        for base, exponent in sorted((f.as_base_exp() for f in sp.Mul.make_args(rest)), key=self._order):
            if not (2 * exponent).is_Integer:
                raise TypeError(f"no lowering for the power {base}**{exponent}")
            above = FactorPlace.FIRST if base in self.early else FactorPlace.LAST
            root = not exponent.is_Integer
            count = abs(int(2 * exponent if root else exponent))
            factors.append((base, above if exponent > 0 else FactorPlace.BELOW, root, count))
        magnitude = abs(fraction(weight))
        once = (base for base, _, root, count in factors if count == 1 and not root)
        doubled = self.shared.doubled_product(once) if magnitude == 2 else None
        return OrderedProduct(weight < 0, magnitude if doubled is None else Fraction(1), factors, doubled)

    def _order(self, factor: tuple[sp.Expr, sp.Expr]) -> tuple[int, tuple[object, ...]]:
        """The sort key of a factor (base, exponent): early factors, others, late factors."""
        base, _ = factor
        rank = 0 if base in self.early else 2 if base in self.late else 1
        return rank, sp.default_sort_key(base)


def _signed(term: sp.Expr) -> tuple[int, sp.Expr]:
    """The sign of a term, and the term without it."""
    return (-1, -term) if term.could_extract_minus_sign() else (1, term)
