"""The conversion of SymPy expressions of the derivation to CasADi expressions.

The constants of CasADi are doubles, so that exact numbers would be rounded. Therefore every number that is not an
integer becomes a CasADi symbol; `Symbols.leaves` maps these symbols to the leaves of the kernel.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import reduce
from operator import mul

import casadi as ca
import sympy as sp

from derive.ir.expressions import Leaf, Number


class Symbols:
    """The CasADi values of SymPy symbols, and the kernel leaves of CasADi symbols.

    early, late: the symbols that come first and last in products, so that products share sub-expressions: velocities,
    whose products occur in many terms, are early; the rotation, in which the rows of a vector differ, is late.
    """

    def __init__(self, early: frozenset[sp.Symbol], late: frozenset[sp.Symbol]) -> None:
        self.early, self.late = early, late
        self.values: dict[sp.Symbol, ca.SX] = {}
        self.inputs: list[ca.SX] = []
        self.leaves: list[Leaf] = []
        self._numbers: dict[Fraction, ca.SX] = {}
        self._converted: dict[sp.Expr, ca.SX] = {}

    def input(self, symbol: sp.Symbol, leaf: Leaf) -> None:
        """Declare a symbol whose value is a leaf: an element of an argument, a coefficient, or a number."""
        self.values[symbol] = self._leaf(leaf)

    def define(self, symbol: sp.Symbol, expr: sp.Expr) -> ca.SX:
        """Define the value of a symbol by an expression, and return it."""
        self.values[symbol] = self(expr)
        return self.values[symbol]

    def values_of(self, symbols: Iterable[sp.Symbol]) -> list[ca.SX]:
        """The values of several symbols."""
        return [self.values[symbol] for symbol in symbols]

    def number(self, value: Fraction) -> ca.SX:
        """The CasADi value of an exact number."""
        if value.denominator == 1 and abs(value.numerator) < 2**53:
            return ca.SX(int(value))
        return self._exact(value)

    def _exact(self, value: Fraction) -> ca.SX:
        """A symbol for a number, because CasADi rounds constants, for example in the derivative of x / 10."""
        if value not in self._numbers:
            self._numbers[value] = self._leaf(Number(value))
        return self._numbers[value]

    def _leaf(self, leaf: Leaf) -> ca.SX:
        """A new CasADi symbol for a leaf."""
        symbol = ca.SX.sym(f"in{len(self.leaves)}")
        self.inputs.append(symbol)
        self.leaves.append(leaf)
        return symbol

    def __call__(self, expr: sp.Expr) -> ca.SX:
        """The CasADi value of an expression of +, *, integer powers, square roots, sin and cos. Raises TypeError."""
        if expr not in self._converted:
            self._converted[expr] = self._convert(sp.sympify(expr))
        return self._converted[expr]

    def _convert(self, expr: sp.Expr) -> ca.SX:
        if expr.is_Symbol:
            return self.values[expr]
        if expr.is_Rational:
            return self.number(Fraction(int(expr.p), int(expr.q)))
        if expr.is_Add:
            return self._sum(expr)
        if expr.is_Mul or expr.is_Pow:
            return self._product(expr)
        if isinstance(expr, sp.sin | sp.cos):
            return (ca.sin if isinstance(expr, sp.sin) else ca.cos)(self(expr.args[0]))
        raise TypeError(f"no lowering for {expr.func.__name__}: {expr}")

    def _sum(self, expr: sp.Expr) -> ca.SX:
        """A sum in a fixed order, collected by the factors in `late`, with a positive term first if there is one."""
        terms = [_signed(term) for term in self._collected(expr)]
        terms.sort(key=lambda signed: (signed[0] < 0, sp.default_sort_key(signed[1])))
        total = self(terms[0][1] if terms[0][0] > 0 else -terms[0][1])
        for sign, term in terms[1:]:
            total = total + self(term) if sign > 0 else total - self(term)
        return total

    def _collected(self, expr: sp.Expr) -> list[sp.Expr]:
        """The terms of a sum, with a cos + b cos as (a + b) cos, so that the rows of a rotated vector share a + b."""
        remaining = list(expr.args)
        collected = []
        for symbol in sorted(self.late & expr.free_symbols, key=sp.default_sort_key):
            group = [t for t in remaining if t.as_powers_dict().get(symbol) == 1]
            if len(group) > 1:
                remaining = [t for t in remaining if t not in group]
                collected.append(sp.Mul(symbol, sp.Add(*(t / symbol for t in group))))
        return remaining + collected

    def _product(self, expr: sp.Expr) -> ca.SX:
        """A product: early factors, one division, the number, then the other factors, so that terms share prefixes."""
        weight, rest = expr.as_coeff_Mul()
        magnitude = abs(Fraction(int(weight.p), int(weight.q)))
        first: list[ca.SX] = []
        last: list[ca.SX] = []
        below: list[ca.SX] = []
        for base, exponent in sorted((f.as_base_exp() for f in sp.Mul.make_args(rest)), key=self._order):
            if not (2 * exponent).is_Integer:
                raise TypeError(f"no lowering for the power {base}**{exponent}")
            above = first if base in self.early else last
            value = self(base) if exponent.is_Integer else ca.sqrt(self(base))
            (above if exponent > 0 else below).extend(
                [value] * abs(int(exponent if exponent.is_Integer else 2 * exponent))
            )
        if magnitude.numerator == 1 and (first or last) and not _is_dyadic(magnitude):
            below.append(self._exact(1 / magnitude))  # m/7 is rounded once, m*(1/7) twice
        elif magnitude != 1 or not (first or last):
            last.insert(0, self.number(magnitude))
        if not first:
            first, last = last, []
        result = reduce(mul, first) / reduce(mul, below) if below else reduce(mul, first)
        result = reduce(mul, last, result)
        return -result if weight < 0 else result

    def _order(self, factor: tuple[sp.Expr, sp.Expr]) -> tuple[int, tuple[object, ...]]:
        """The sort key of a factor (base, exponent): early factors, others, late factors."""
        base, _ = factor
        rank = 0 if base in self.early else 2 if base in self.late else 1
        return rank, sp.default_sort_key(base)


def _signed(term: sp.Expr) -> tuple[int, sp.Expr]:
    """The sign of a term, and the term without it."""
    return (-1, -term) if term.could_extract_minus_sign() else (1, term)


def _is_dyadic(value: Fraction) -> bool:
    return value.denominator & (value.denominator - 1) == 0
