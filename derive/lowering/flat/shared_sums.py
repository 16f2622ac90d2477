"""The sub-sums that the sums of a model share: varying parts, and sums of products of the angular velocity."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from derive.algebra import sp
from derive.mechanics.symbols import Family, identity
from derive.mechanics.terms import Intermediate, ModelConstant


class SharedSums:
    """The equal quantities of a model, the varying parts that several sums share, and the collection of like terms.

    The moments of inertia J_11 = a + b and J_33 = a + b + C3_33 share a + b; the rows of all shapes share
    oo_11 + oo_33 if their terms are S_1_11 oo_11 + S_1_33 oo_33 and these S are equal.
    """

    def __init__(self, definitions: Iterable[Intermediate] = (), constants: Iterable[ModelConstant] = ()) -> None:
        definitions = [d for d in definitions if not d.zero]
        constants = tuple(constants)
        self._constants = frozenset(c.symbol for c in constants)
        self._first: dict[sp.Symbol, sp.Symbol] = {}
        known: dict[sp.Expr, sp.Symbol] = {}
        for c in constants:
            if c.value.is_Rational:
                self._first[c.symbol] = known.setdefault(c.value, c.symbol)
        for d in definitions:
            self._first[d.symbol] = known.setdefault(self._with_first(d.expr), d.symbol)
        self._first = {symbol: first for symbol, first in self._first.items() if symbol != first}
        self._products = frozenset(d.symbol for d in definitions if identity(d.symbol).family is Family.OMEGA_PRODUCT)
        sums = {self._with_first(d.expr) for d in definitions if d.expr.is_Add}
        parts = Counter(self._parts(expr)[0] for expr in sums)
        self._shared = frozenset(part for part, count in parts.items() if count > 1)

    def _with_first(self, expr: sp.Expr) -> sp.Expr:
        """An expression in terms of the first of the quantities that are equal."""
        return expr.xreplace(self._first)

    def divided(self, expr: sp.Expr) -> tuple[sp.Expr, Sequence[sp.Expr]]:
        """The varying part of a sum and its constant terms; the whole sum and no terms if no other sum has that part.

        Both are in terms of the first of the quantities that are equal.
        """
        expr = self._with_first(expr)
        varying, constant = self._parts(expr)
        return (varying, constant) if varying in self._shared else (expr, ())

    def _parts(self, expr: sp.Expr) -> tuple[sp.Expr, Sequence[sp.Expr]]:
        constant = [term for term in expr.args if term.free_symbols <= self._constants]
        if not constant or not expr.is_Add:  # equal quantities make a product of a sum
            return expr, ()
        return sp.Add(*(term for term in expr.args if term not in constant)), sorted(constant, key=sp.default_sort_key)

    def collected(self, expr: sp.Expr) -> list[sp.Expr]:
        """The terms of a sum, with S oo_11 + S oo_33 as S (oo_11 + oo_33)."""
        if not self._products & expr.free_symbols:
            return list(expr.args)
        groups: dict[sp.Expr, list[sp.Expr]] = {}
        result: list[sp.Expr] = []
        for term in expr.args:
            product = next(
                (s for s in sorted(self._products & term.free_symbols, key=str) if term.as_powers_dict().get(s) == 1),
                None,
            )
            if product is None or (term / product).is_Number:
                result.append(term)
                continue
            rest = term / product
            sign = -1 if rest.could_extract_minus_sign() else 1
            groups.setdefault(sign * rest, []).append(sign * product)
        for rest, products in groups.items():
            minus = all(product.could_extract_minus_sign() for product in products)
            result.append(-rest * sp.Add(*(-p for p in products)) if minus else rest * sp.Add(*products))
        return result

    def doubled_product(self, factors: Iterable[sp.Expr]) -> sp.Expr | None:
        """The product of the angular velocity among the factors of a term that vary, with whose double rows share."""
        varying = [factor for factor in factors if factor not in self._constants]
        products = [factor for factor in varying if factor in self._products]
        return products[0] if len(varying) > len(products) == 1 else None
