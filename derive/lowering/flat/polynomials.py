"""Expressions of the derivation as polynomials in the state, with exact coefficients in terms of the parameters.

Where roots of parameters occur, as in a damping ratio, the roots take the place of the parameters: m = sqrt(m)^2.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

from sympy.polys.polyerrors import CoercionFailed
from sympy.polys.rings import PolyRing

from derive.algebra import sp
from derive.errors import TisserandError
from derive.mechanics.equations import Equations
from derive.mechanics.symbols import Family, identity

Polynomial: TypeAlias = Any
"""A polynomial of SymPy's sparse rings, `PolyElement`, which has no type annotations."""

Coefficient: TypeAlias = Any
"""An element of the field of the coefficients: a rational number, or a rational function of parameters and roots."""


class NotPolynomialError(TisserandError):
    """An expression is no polynomial in the state, or a coefficient no rational function of parameters and roots."""


@dataclass(frozen=True)
class BodyGravity:
    """A component of gravity in the body frame: its symbol, and its value in terms of the rotation."""

    generator: Polynomial
    value: Polynomial


class StatePolynomials:
    """The conversion of expressions of a planar body, in which the definitions are substituted.

    velocities, amplitudes: the generators of the ring besides the rotation: generalised velocities with gravity in the
    body frame, and the amplitudes of the shapes. cosine, sine: of the rotation. ring: the ring of all of them.
    weight: gravity in the body frame, by the index of its component.
    """

    def __init__(self, equations: Equations) -> None:
        """Raises NotPolynomialError if the coefficients are no rational functions of the parameters and their roots."""
        of = {d.symbol: identity(d.symbol) for d in equations.definitions if not d.zero}
        gravity = {
            known.components[0] - 1: symbol for symbol, known in of.items() if known.family is Family.BODY_GRAVITY
        }
        self.velocities = (*(row.v for row in equations.rows), *gravity.values())
        self.amplitudes = tuple(c.q for c in equations.coordinates if identity(c.q).family is Family.AMPLITUDE)
        self.cosine, self.sine = (
            next(symbol for symbol, known in of.items() if known.family is family)
            for family in (Family.COSINE, Family.SINE)
        )
        parameters = [p.symbol for p in equations.parameters]
        self._positive = [p.positive for p in equations.parameters]
        self._roots = _roots([c.value for c in equations.coefficients], parameters)
        domain = sp.QQ.frac_field(*(self._roots.get(p, p) for p in parameters)) if parameters else sp.QQ
        self.ring = PolyRing([*self.velocities, *self.amplitudes, self.cosine, self.sine], domain, sp.lex)
        self._values: dict[sp.Symbol, Polynomial] = dict(zip(self.ring.symbols, self.ring.gens, strict=True))
        self._pending: dict[sp.Symbol, sp.Expr] = {
            d.symbol: d.expr for d in equations.definitions if d.symbol not in self._values
        }
        for c in equations.coefficients:
            try:
                self._values[c.symbol] = self.ring.ground_new(self.coefficient(c.value))
            except (CoercionFailed, ValueError) as error:
                raise NotPolynomialError(str(c.symbol)) from error
        definitions = {d.symbol: d.expr for d in equations.definitions}
        self.weight = {k: BodyGravity(self._values[symbol], self(definitions[symbol])) for k, symbol in gravity.items()}

    def __call__(self, expr: sp.Expr) -> Polynomial:
        """The polynomial of an expression of sums, products and powers. Raises NotPolynomialError."""
        if expr.is_Symbol:
            if expr in self._pending:
                self._values[expr] = self(self._pending.pop(expr))
            if expr not in self._values:
                raise NotPolynomialError(str(expr))
            return self._values[expr]
        if expr.is_Rational:
            return self.ring.ground_new(self.ring.domain.from_sympy(expr))
        if expr.is_Add:
            return sum(map(self, expr.args), start=self.ring.zero)
        if expr.is_Mul:
            product = self.ring.one
            for factor in expr.args:
                product = product * self(factor)
            return product
        if expr.is_Pow and expr.exp.is_Integer and expr.exp > 0:
            return self(expr.base) ** int(expr.exp)
        raise NotPolynomialError(str(expr))

    def coefficient(self, expr: sp.Expr) -> Coefficient:
        """An expression of the parameters in the field of the coefficients. Raises CoercionFailed, ValueError."""
        return self.ring.domain.from_sympy(expr.xreplace({p: root**2 for p, root in self._roots.items()}))

    def expression(self, coefficient: Coefficient) -> sp.Expr:
        """The expression of a coefficient in the parameters."""
        return self.ring.domain.to_sympy(coefficient).xreplace({root: sp.sqrt(p) for p, root in self._roots.items()})

    def reduced(self, polynomial: Polynomial) -> Polynomial:
        """The polynomial with sin^2 = 1 - cos^2, which is unique."""
        cosine, sine = self(self.cosine), self(self.sine)
        return polynomial.rem([sine**2 + cosine**2 - 1])

    def is_positive(self, coefficient: Coefficient) -> bool:
        """Whether a coefficient is positive whatever the values are that setup accepts for the parameters."""
        value = rational(self.ring.domain, coefficient)
        if value is not None:
            return value > 0
        return all(
            factor > 0 and all(positive or not power for positive, power in zip(self._positive, powers, strict=True))
            for part in (coefficient.numer, coefficient.denom)
            for powers, factor in part.terms()
        )

    def degree(self, polynomial: Polynomial) -> int:
        """The degree in the amplitudes."""
        indices = [self.ring.symbols.index(s) for s in self.amplitudes]
        return max((sum(powers[k] for k in indices) for powers in polynomial), default=0)

    def rotates(self, polynomials: Iterable[Polynomial]) -> bool:
        """Whether one of the polynomials depends on the rotation."""
        indices = [self.ring.symbols.index(s) for s in (self.cosine, self.sine)]
        return any(powers[k] for polynomial in polynomials for powers in polynomial for k in indices)


def _roots(values: Iterable[sp.Expr], parameters: Iterable[sp.Symbol]) -> dict[sp.Symbol, sp.Symbol]:
    """The symbols of the square roots of those parameters of which the values have half powers."""
    powers = {power for value in values for power in value.atoms(sp.Pow) if (2 * power.exp).is_Integer}
    rooted = {power.base for power in powers if not power.exp.is_Integer}
    return {p: sp.Symbol(f"sqrt({p.name})", positive=True) for p in parameters if p in rooted and p.is_positive}


def rational(domain: Any, coefficient: Coefficient) -> Fraction | None:
    """The value of a coefficient that does not depend on the parameters, otherwise None."""
    if not domain.is_FractionField:
        return _fraction(coefficient)
    if not (coefficient.numer.is_ground and coefficient.denom.is_ground):
        return None
    return _fraction(coefficient.numer.LC) / _fraction(coefficient.denom.LC)


def _fraction(value: Any) -> Fraction:
    """A rational number of SymPy's domains, whose type depends on what is installed."""
    return Fraction(int(value.numerator), int(value.denominator))
