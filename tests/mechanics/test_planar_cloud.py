"""Any body in the plane: a cloud of point masses whose shapes move it along both axes, about no special point.

The beam makes many shape integrals vanish (c1, C4, c7); here none does.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import sympy as sp

from derive.mechanics.bodies.planar_integrals import Value, coefficients
from derive.mechanics.body import planar_body
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import derive_body
from derive.mechanics.symbols import Family, pair
from derive.mechanics.terms import ModelConstant
from paper import brute_force
from plain_symbols import plain

MASSES = (sp.Integer(2), sp.Rational(1, 3), sp.Integer(1))
PLACES = ((1, 2), (-1, sp.Rational(1, 2)), (3, -1))
SHAPES = (((1, 0), (2, -1), (0, 3)), ((sp.Rational(1, 2), 1), (-1, 1), (1, 1)))
"""Displacements of the three points in each of two shapes."""
STIFFNESS = {(1, 1): 5, (1, 2): -2, (2, 2): 7}


@dataclass(frozen=True)
class CloudIntegrals:
    """Sums over the points; index 0 is the position, see FieldIntegrals."""

    def first(self, i: int, component: int) -> Value:
        return Value(sum(m * p[component - 1] for m, p in zip(MASSES, _field(i), strict=True)))

    def trace(self, i: int, j: int) -> Value:
        triples = zip(MASSES, _field(i), _field(j), strict=True)
        return Value(sum(m * (a[0] * b[0] + a[1] * b[1]) for m, a, b in triples))

    def axial(self, i: int, j: int) -> Value:
        triples = zip(MASSES, _field(i), _field(j), strict=True)
        return Value(sum(m * (a[0] * b[1] - a[1] * b[0]) for m, a, b in triples))


def _field(i: int) -> tuple[tuple[sp.Expr, sp.Expr], ...]:
    return SHAPES[i - 1] if i else PLACES


@cache
def cloud() -> Equations:
    stiffness = tuple(
        ModelConstant(pair(Family.STIFFNESS, i, j), sp.Integer(k), "", "", "") for (i, j), k in STIFFNESS.items()
    )
    constants = (*coefficients(CloudIntegrals(), 2), *stiffness)
    return derive_body(planar_body("cloud", "", "", 2, sum(MASSES), constants)).expanded()


def positions() -> list[sp.Matrix]:
    """x of each point, from (1) written out."""
    angle, alpha = sp.Symbol("phi"), sp.symbols("alpha1 alpha2")
    turn = sp.Matrix([[sp.cos(angle), -sp.sin(angle)], [sp.sin(angle), sp.cos(angle)]])
    moved = (
        sp.Matrix(place)
        + sum((a * sp.Matrix(shape[k]) for a, shape in zip(alpha, SHAPES, strict=True)), sp.zeros(2, 1))
        for k, place in enumerate(PLACES)
    )
    return [sp.Matrix(sp.symbols("c1 c2")) + turn * r for r in moved]


def rate(expr: sp.Expr) -> sp.Expr:
    return brute_force.time_derivative(expr, 2)


def test_rows_are_the_virtual_work_of_the_points() -> None:
    alpha = sp.symbols("alpha1 alpha2")
    energy = sum(
        (sp.Rational(1, 2) if i == j else 1) * k * alpha[i - 1] * alpha[j - 1] for (i, j), k in STIFFNESS.items()
    )
    for coordinate in cloud().coordinates:
        q = plain(coordinate.q)
        expected = sp.diff(energy, q)
        for m, x in zip(MASSES, positions(), strict=True):
            expected += m * x.applyfunc(lambda e: rate(rate(e))).dot(x.diff(q))
        assert brute_force.expanded(plain(cloud().row(str(q))) - expected) == 0, q


def test_energy_and_momentum_are_those_of_the_points() -> None:
    kinetic, linear, angular = sp.S.Zero, sp.zeros(2, 1), sp.S.Zero
    for m, x in zip(MASSES, positions(), strict=True):
        xdot = x.applyfunc(rate)
        kinetic += m * xdot.dot(xdot) / 2
        linear += m * xdot
        angular += m * (x[0] * xdot[1] - x[1] * xdot[0])
    eq = cloud()
    assert brute_force.expanded(plain(eq.substituted(eq.kinetic_energy)) - kinetic) == 0
    assert brute_force.expanded(plain(eq.substituted(eq.angular_momentum[0])) - angular) == 0
    for found, expected in zip(eq.linear_momentum, linear, strict=True):
        assert brute_force.expanded(plain(eq.substituted(found)) - expected) == 0


def test_nothing_vanishes_but_what_must() -> None:
    """Only the coupling of the translations, and omega x (J omega), are zero in the plane."""
    assert [(i, j) for i, j, _ in cloud().mass_zeros] == [(1, 0)]
    assert [(v.term.row, v.term.name) for v in cloud().vanished] == [("phi", "centrifugal")]
