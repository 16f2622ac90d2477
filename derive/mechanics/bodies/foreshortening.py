"""The displacement of a beam along its axis at second order: a beam that bends and does not stretch gets shorter.

An inextensible axis has du/dx = -1/2 (dv/dx)^2 to second order, so that u = 1/2 sum alpha_i alpha_j Psi_ij with

    Psi_ij = psi_ij(xi) e1,   psi_ij = -(2/l) int phi_i' phi_j' dxi,

primes by xi. The free constant is fixed by the condition of the frame on the displacement along e1: its mean vanishes
(17), or it vanishes at the point of the frame (16); at the ends of a chord it is opposite, so that c, the centre of the
undeformed beam, is the middle of the chord. Beyond the paper, which stops at first order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement

import sympy as sp

from derive.mechanics.bodies.beam_integrals import ORTHOGONAL, PARITY, is_odd
from derive.mechanics.bodies.planar_integrals import Value
from derive.mechanics.bodies.reference_conditions import integral, xi
from derive.mechanics.motion.full_second_order import field_weight
from derive.mechanics.symbols import Family, Identity, Symbol
from derive.mechanics.terms import ModelConstant
from derive.roles import Source
from derive.spec.model.body import Frame

PARALLEL_TO_AXIS = "geometry (X and the Psi_ij are along e1)"
SHORTENING = "geometry (the beam shortens along e1)"
CONDITION_17 = "condition (17) at second order (no mean displacement)"
NO_SHORTENING = "these shapes (no displacement along e1 there)"
NO_PART = "these shapes (the shortening has no such part)"


@dataclass(frozen=True)
class Foreshortening:
    """The psi_ij of a beam with these shapes (polynomials in xi), each 2/length times `of(i, j)`."""

    shapes: tuple[sp.Poly, ...]
    frame: Frame
    mass: sp.Expr
    length: sp.Expr

    @property
    def factor(self) -> sp.Expr:
        """2/length, in 1/m."""
        return 2 / self.length

    def of(self, i: int, j: int) -> sp.Poly:
        """psi_ij length/2 of the shapes i and j, from 1: a polynomial in xi."""
        primitive = -(self.shapes[i - 1].diff(xi) * self.shapes[j - 1].diff(xi)).integrate()
        return primitive - sp.Poly(_condition(primitive, self.frame), xi, domain="QQ")

    def first(self, i: int, j: int, component: int) -> Value:
        """int rho Psi_ij . e_component."""
        if component == 2:
            return Value(sp.S.Zero, SHORTENING)
        return self._value(self.of(i, j), self.factor, CONDITION_17 if self.frame.kind == "mean" else None)

    def trace(self, i: int, j: int) -> sp.Expr:
        """int rho X . Psi_ij."""
        return self._value(self.of(i, j) * sp.Poly(xi, xi, domain="QQ"), sp.S.One).expr

    def axial(self, i: int, j: int) -> Value:
        """int rho X x Psi_ij."""
        return Value(sp.S.Zero, PARALLEL_TO_AXIS)

    @property
    def fields(self) -> tuple[sp.Poly, ...]:
        """The fields theta_p that all psi_ij are combinations of: Legendre polynomials, which are orthogonal."""
        highest = max(2 * shape.degree() - 1 for shape in self.shapes)
        legendre = (sp.Poly(sp.legendre(p, xi), xi, domain="QQ") for p in range(highest + 1))
        every = [self.of(i, j) for i, j in pairs(len(self.shapes))]
        return tuple(theta for theta in legendre if any(integral(psi * theta) for psi in every))

    def _value(self, integrand: sp.Poly, factor: sp.Expr, reason: str | None = None) -> Value:
        value = integral(integrand)
        if value:
            return Value(self.mass * factor * value / 2)
        return Value(sp.S.Zero, reason or (PARITY if is_odd(integrand) else ORTHOGONAL))


def _condition(primitive: sp.Poly, frame: Frame) -> sp.Rational:
    """The constant of psi_ij that the frame takes away."""
    match frame.kind:
        case "mean":
            return integral(primitive) / 2
        case "point" | "tangent":
            return primitive.eval(sp.Rational(frame.at or 0))
        case "chord":
            return (primitive.eval(-1) + primitive.eval(1)) / 2
        case "given":
            return primitive.eval(0)


def pairs(n: int) -> Iterator[tuple[int, int]]:
    """The pairs i <= j of shapes."""
    return combinations_with_replacement(range(1, n + 1), 2)


def field_weights(of: Foreshortening, fields: Sequence[sp.Poly]) -> tuple[ModelConstant, ...]:
    """z_pij of Psi_ij = sum z_pij theta_p, for orthogonal fields theta_p."""
    result = []
    for p, theta in enumerate(fields, 1):
        square = integral(theta * theta)
        for i, j in pairs(len(of.shapes)):
            value = integral(of.of(i, j) * theta) / square
            doc, zero = f"part of theta_{p} in Psi_{i}{j}", None if value else NO_PART
            symbol = field_weight(p, i, j)
            result.append(ModelConstant(symbol, of.factor * value, Source.SECOND_ORDER, doc, "1/m", zero))
    return tuple(result)


def point_shortening(of: Foreshortening, point: str, value: Callable[[sp.Poly], sp.Expr]) -> tuple[ModelConstant, ...]:
    """psi_ij at a point, i <= j, in 1/m; `value` is what the point sees of a polynomial in xi."""
    result = []
    for i, j in pairs(len(of.shapes)):
        symbol = Symbol(Identity(Family.POINT_SECOND, (i, j), (1,), point=point))
        psi = value(of.of(i, j))
        doc = f"psi_{i}{j} at marker {point}"
        result.append(
            ModelConstant(symbol, of.factor * psi, Source.SECOND_ORDER, doc, "1/m", None if psi else NO_SHORTENING)
        )
    return tuple(result)


def second_order_vectors(constants: tuple[ModelConstant, ...], n: int) -> tuple[tuple[sp.ImmutableMatrix, ...], ...]:
    """The Psi_ij at a point for n shapes, as a square of vectors; empty at first order."""
    if not constants:
        return ()
    by_shapes = {c.symbol.identity.shapes: c.symbol for c in constants}
    shapes = range(1, n + 1)
    return tuple(tuple(sp.ImmutableMatrix([by_shapes[min(i, j), max(i, j)], 0]) for j in shapes) for i in shapes)
