"""The displacement of a beam along its axis at second order: a beam that bends and does not stretch gets shorter.

An inextensible axis has du/dx = -1/2 (dv/dx)^2 to second order, so that u = 1/2 sum alpha_i alpha_j Psi_ij with

    Psi_ij = psi_ij(xi) e1,   psi_ij = -(2/l) int phi_i' phi_j' dxi,

primes by xi. The free constant is fixed by the condition of the frame on the displacement along e1, see
`displacement_fields`. Displacements along the axis shorten nothing. Beyond the paper, which stops at first order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING

from derive.algebra import fraction, sp
from derive.mechanics.bodies.beam_functions import XI, BeamFunction, Real, polynomial, rational
from derive.mechanics.bodies.beam_integrals import ORTHOGONAL, PARITY, BeamField
from derive.mechanics.bodies.displacement_fields import shortening
from derive.mechanics.bodies.planar_integrals import Value
from derive.mechanics.motion.full_second_order import field_weight
from derive.mechanics.symbols import Family, Identity
from derive.mechanics.terms import ModelConstant
from derive.mechanics.zero_reasons import SECOND_17
from derive.roles import Source
from derive.spec.model.beam_parts import Frame

if TYPE_CHECKING:
    pass

PARALLEL_TO_AXIS = "geometry (X and the Psi_ij are along e1)"
SHORTENING = "geometry (the beam shortens along e1)"
STRETCHING = "geometry (displacements along the axis do not shorten the beam)"
NO_SHORTENING = "these shapes (no displacement along e1 there)"
NO_PART = "these shapes (the shortening has no such part)"


@dataclass(frozen=True)
class Foreshortening:
    """The psi_ij of a beam with these displacement fields, each 2/length times `of(i, j)`."""

    fields: tuple[BeamField, ...]
    frame: Frame
    mass: sp.Expr
    length: sp.Expr

    @property
    def factor(self) -> sp.Expr:
        """The factor 2/length, in 1/m."""
        return 2 / self.length

    def of(self, i: int, j: int) -> BeamFunction:
        """The function psi_ij length/2 of the fields i and j, from 1."""
        return shortening(self.fields[i - 1], self.fields[j - 1], self.frame)

    def first(self, i: int, j: int, component: int) -> Value:
        """The first moment int rho Psi_ij . e_component."""
        if component == 2:
            return Value(sp.S.Zero, SHORTENING)
        if self.stretches(i, j):
            return Value(sp.S.Zero, STRETCHING)
        return self._value(self.of(i, j), self.factor, SECOND_17 if self.frame.kind == "mean" else None)

    def trace(self, i: int, j: int) -> sp.Expr:
        """The moment int rho X . Psi_ij."""
        return self._value(self.of(i, j) * XI, sp.S.One).expr

    def axial(self, i: int, j: int) -> Value:
        """The moment int rho X x Psi_ij."""
        return Value(sp.S.Zero, PARALLEL_TO_AXIS)

    def stretches(self, i: int, j: int) -> bool:
        """Whether one of two fields is along the axis."""
        return 1 in (self.fields[i - 1].axis, self.fields[j - 1].axis)

    @cached_property
    def combinations(self) -> tuple[Combination, ...]:
        """The fields theta_p of which all psi_ij are combinations, and the weights."""
        return combinations_of({(i, j): self.of(i, j) for i, j in pairs(len(self.fields))})

    def _value(self, integrand: BeamFunction, factor: sp.Expr, reason: str | None = None) -> Value:
        value = integrand.integral()
        if value:
            return Value(self.mass * factor * rational(value) / 2)
        return Value(sp.S.Zero, reason or (PARITY if integrand.is_odd else ORTHOGONAL))


@dataclass(frozen=True)
class Combination:
    """A field theta_p, and its weights in the functions psi_ij length/2, by i <= j; missing weights vanish."""

    field: BeamFunction
    weights: Mapping[tuple[int, int], Real]


def combinations_of(every: Mapping[tuple[int, int], BeamFunction]) -> tuple[Combination, ...]:
    """The fields theta_p of which all psi_ij length/2 are combinations, and the weights.

    For polynomials these are Legendre polynomials, which are orthogonal; for others the functions themselves.
    """
    if not all(psi.is_exact for psi in every.values()):
        return tuple(Combination(psi, {key: Fraction(1)}) for key, psi in every.items() if not psi.is_zero)
    highest = max((len(psi.coefficients) for psi in every.values()), default=0)
    result = []
    for theta in map(_legendre, range(highest)):
        square = (theta * theta).integral()
        parts = {key: (psi * theta).integral() / square for key, psi in every.items()}
        if any(parts.values()):
            result.append(Combination(theta, parts))
    return tuple(result)


def _legendre(degree: int) -> BeamFunction:
    coefficients = reversed(sp.legendre_poly(degree, polys=True).all_coeffs())
    return polynomial(fraction(c) for c in coefficients)


def pairs(n: int) -> Iterator[tuple[int, int]]:
    """The pairs i <= j of shapes."""
    return combinations_with_replacement(range(1, n + 1), 2)


def field_weights(of: Foreshortening) -> tuple[ModelConstant, ...]:
    """The weights z_pij of Psi_ij = sum z_pij theta_p."""
    result = []
    for p, combination in enumerate(of.combinations, 1):
        for i, j in pairs(len(of.fields)):
            value = rational(combination.weights.get((i, j), Fraction(0)))
            doc = f"part of theta_{p} in Psi_{i}{j}"
            zero = None if value else STRETCHING if of.stretches(i, j) else NO_PART
            symbol = field_weight(p, i, j)
            result.append(ModelConstant(symbol, of.factor * value, Source.SECOND_ORDER, doc, "1/m", zero))
    return tuple(result)


def point_shortening(
    of: Foreshortening, point: str, value: Callable[[BeamFunction], sp.Rational]
) -> tuple[ModelConstant, ...]:
    """The value of psi_ij at a point, i <= j, in 1/m; `value` evaluates a function of xi at the point."""
    result = []
    for i, j in pairs(len(of.fields)):
        symbol = Identity(Family.POINT_SECOND, (i, j), (1,), point=point).symbol
        psi = value(of.of(i, j))
        doc = f"psi_{i}{j} at marker {point}"
        zero = None if psi else STRETCHING if of.stretches(i, j) else NO_SHORTENING
        result.append(ModelConstant(symbol, of.factor * psi, Source.SECOND_ORDER, doc, "1/m", zero))
    return tuple(result)


def second_order_vectors(constants: tuple[ModelConstant, ...], n: int) -> tuple[tuple[sp.ImmutableMatrix, ...], ...]:
    """The Psi_ij at a point for n shapes, as a square of vectors; empty at first order."""
    if not constants:
        return ()
    by_shapes = {c.symbol.identity.shapes: c.symbol for c in constants}
    shapes = range(1, n + 1)
    return tuple(tuple(sp.ImmutableMatrix([by_shapes[min(i, j), max(i, j)], 0]) for j in shapes) for i in shapes)
