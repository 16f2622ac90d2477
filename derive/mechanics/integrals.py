"""Shape integrals c1..c8 of a planar body, and the sums d1, D2, d3, J made of them: the appendix.

Since r = X + sum alpha_i Phi_i, every moment of r is a sum of moments of X, Phi_1, ..., Phi_N: the shape integrals.
A body supplies those as `FieldIntegrals`; the composition is the same for all bodies.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import sympy as sp

from derive.mechanics.series import ALPHA, ALPHADDOT, ALPHADOT, Series
from derive.mechanics.symbols import Family, I, J, Symbol, quantity
from derive.mechanics.terms import Coefficient

APPENDIX = "appendix"


@dataclass(frozen=True)
class Value:
    """The value of an integral; `zero` is the reason when it vanishes by structure."""

    expr: sp.Expr
    zero: str | None = None


class FieldIntegrals(Protocol):
    """Moments of the reference position X (index 0) and the shapes Phi_i (index i) of a planar body."""

    def first(self, i: int, component: int) -> Value:
        """int rho Phi_i . e_component, in kg m for X and kg for a shape; components are 1, 2."""

    def trace(self, i: int, j: int) -> Value:
        """int rho Phi_i . Phi_j."""

    def axial(self, i: int, j: int) -> Value:
        """int rho (Phi_i x Phi_j) . e3."""


def coefficients(of: FieldIntegrals, n: int) -> tuple[Coefficient, ...]:
    """c1, c2, C3, C4, c6, c7 and c8 (C5 is c8 in the plane) of a body with n shapes, zeros with their reasons."""
    found: list[Coefficient] = []

    def integral(symbol: Symbol, value: Value, doc: str, unit: str) -> None:
        found.append(Coefficient(symbol, value.expr, APPENDIX, doc, unit, value.zero))

    shapes = range(1, n + 1)
    for k in (1, 2):
        integral(quantity(Family.C1, k), of.first(0, k), f"int rho X . e{k}", "kg m")
    for i in shapes:
        for k in (1, 2):
            integral(quantity(Family.C2, k, shapes=(i,)), of.first(i, k), f"int rho Phi_{i} . e{k}", "kg")
    integral(quantity(Family.C3), of.trace(0, 0), "int rho X . X", "kg m^2")
    for i in shapes:
        integral(quantity(Family.C4, shapes=(i,)), of.trace(0, i), f"int rho X . Phi_{i}", "kg m")
    for i in shapes:
        integral(quantity(Family.C6, shapes=(i,)), of.axial(0, i), f"int rho X x Phi_{i}", "kg m")
    for i in shapes:
        for j in range(i + 1, n + 1):
            integral(quantity(Family.C7, shapes=(i, j)), of.axial(i, j), f"int rho Phi_{i} x Phi_{j}", "kg")
    for i in shapes:
        for j in range(i, n + 1):
            integral(quantity(Family.C8, shapes=(i, j)), of.trace(i, j), f"int rho Phi_{i} . Phi_{j}", "kg")
    return tuple(found)


def planar_series() -> tuple[Series, ...]:
    """d1, D2, d3, J and their sums with the velocities of alpha, from r = X + sum alpha_j Phi_j."""
    c4_j, c6_i = quantity(Family.C4, shapes=(J,)), quantity(Family.C6, shapes=(I,))
    c8_ij, c7_ji = quantity(Family.C8, shapes=(I, J)), quantity(Family.C7, shapes=(J, I))
    d2_j, d3_j = (quantity(family, shapes=(J,)) for family in (Family.D2, Family.D3))
    found: list[Series] = []
    for k in (1, 2):
        c2_j = quantity(Family.C2, k, shapes=(J,))
        d1, d1dot = (quantity(Family.D1, k, derivative=d) for d in (0, 1))
        found.append(Series(d1, quantity(Family.C1, k), ((ALPHA, c2_j),), "int rho r"))
        found.append(Series(d1dot, None, ((ALPHADOT, c2_j),), "int rho rdot"))
    d2, d3 = (quantity(family, shapes=(I,)) for family in (Family.D2, Family.D3))
    found.append(Series(d2, quantity(Family.C4, shapes=(I,)), ((ALPHA, c8_ij),), "int rho r . Phi_{i}"))
    found.append(Series(d3, c6_i, ((ALPHA, c7_ji),), "int rho r x Phi_{i}"))  # r x Phi_i = X x Phi_i + ...
    inertia = ((ALPHA, c4_j), (ALPHA, d2_j))
    found.append(Series(quantity(Family.INERTIA), quantity(Family.C3), inertia, "int rho r . r"))
    found.append(Series(quantity(Family.D2, derivative=1), None, ((ALPHADOT, d2_j),), "int rho r . rdot"))
    found.append(Series(quantity(Family.D3, derivative=1), None, ((ALPHADOT, d3_j),), "int rho r x rdot"))
    return tuple(found)


def planar_sums() -> tuple[Series, ...]:
    """What (15) needs besides: the sums over the shapes that stand in one row alone, or hold accelerations."""
    c8_ij, c7_ij = (quantity(family, shapes=(I, J)) for family in (Family.C8, Family.C7))
    d3_j = quantity(Family.D3, shapes=(J,))
    c8dot_i, c8ddot_i = (quantity(Family.C8_SUM, derivative=d, shapes=(I,)) for d in (1, 2))
    c8dot_j = quantity(Family.C8_SUM, derivative=1, shapes=(J,))
    c7dot_i = quantity(Family.C7_SUM, derivative=1, shapes=(I,))
    d1ddot = (
        Series(quantity(Family.D1, k, derivative=2), None, ((ALPHADDOT, c2_j),), "int rho rddot")
        for k in (1, 2)
        for c2_j in [quantity(Family.C2, k, shapes=(J,))]
    )
    return (
        *d1ddot,
        Series(quantity(Family.D3, derivative=2), None, ((ALPHADDOT, d3_j),), "int rho r x rddot"),
        Series(c8ddot_i, None, ((ALPHADDOT, c8_ij),), "int rho Phi_{i} . rddot"),
        Series(c7dot_i, None, ((ALPHADOT, c7_ij),), "int rho Phi_{i} x rdot"),
        Series(c8dot_i, None, ((ALPHADOT, c8_ij),), "int rho Phi_{i} . rdot"),
        Series(quantity(Family.RATE_PRODUCT), None, ((ALPHADOT, c8dot_j),), "int rho rdot . rdot"),
    )
