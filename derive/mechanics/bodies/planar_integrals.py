"""Shape integrals c1..c8 of a planar body, and the sums d1, D2, d3, J made of them: the appendix.

Since r = X + sum alpha_i Phi_i, every moment of r is a sum of moments of X, Phi_1, ..., Phi_N: the shape integrals.
A body supplies those as `FieldIntegrals`; the composition is the same for all bodies.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from derive.algebra import sp
from derive.mechanics.symbols import Family, pair, quantity
from derive.mechanics.terms import ModelConstant
from derive.roles import Source

if TYPE_CHECKING:
    from derive.mechanics.typed_symbol import Symbol

VANISHING_SUM = "these shapes (the two parts cancel exactly)"


@dataclass(frozen=True)
class Value:
    """The value of an integral; `zero` is the reason when it vanishes by structure."""

    expr: sp.Expr
    zero: str | None = None


class FieldIntegrals(Protocol):
    """Moments of the reference position X (index 0) and the shapes Phi_i (index i) of a planar body."""

    def first(self, i: int, component: int) -> Value:
        """The first moment int rho Phi_i . e_component, in kg m for X and kg for a shape; components are 1, 2."""

    def trace(self, i: int, j: int) -> Value:
        """The moment int rho Phi_i . Phi_j."""

    def axial(self, i: int, j: int) -> Value:
        """The moment int rho (Phi_i x Phi_j) . e3."""


class SecondOrderIntegrals(Protocol):
    """Moments of the fields Psi_ij of a planar body, by the numbers of two shapes."""

    def first(self, i: int, j: int, component: int) -> Value:
        """The first moment int rho Psi_ij . e_component, in kg/m."""

    def trace(self, i: int, j: int) -> sp.Expr:
        """The moment int rho X . Psi_ij, in kg."""

    def axial(self, i: int, j: int) -> Value:
        """The moment int rho (X x Psi_ij) . e3, in kg."""


def second_order_coefficients(
    of: SecondOrderIntegrals, first_order: tuple[ModelConstant, ...], n: int
) -> tuple[ModelConstant, ...]:
    """The integrals c9, c10 and C5 of a body with n shapes, the moments of Psi_ij to second order; beyond the paper.

    C5_ij, the factor of alpha_i alpha_j in J, is c8_ij at first order; here the Psi_ij contribute to it.
    """
    c8 = {c.symbol: c for c in first_order if c.symbol.identity.family is Family.C8}
    pairs = [(i, j) for i in range(1, n + 1) for j in range(i, n + 1)]
    result: list[ModelConstant] = []

    def integral(symbol: Symbol, value: Value, doc: str, unit: str) -> None:
        result.append(ModelConstant(symbol, value.expr, Source.SECOND_ORDER, doc, unit, value.zero))

    for i, j in pairs:
        for k in (1, 2):
            integral(pair(Family.C9, i, j, k), of.first(i, j, k), f"int rho Psi_{i}{j} . e{k}", "kg/m")
    for i, j in pairs:
        of_shapes = c8[pair(Family.C8, i, j)]
        total = sp.expand(of_shapes.value + of.trace(i, j))
        zero = None if total != 0 else of_shapes.zero or VANISHING_SUM
        doc = f"int rho (Phi_{i} . Phi_{j} + X . Psi_{i}{j})"
        integral(pair(Family.C5, i, j), Value(total, zero), doc, "kg")
    for i, j in pairs:
        integral(pair(Family.C10, i, j), of.axial(i, j), f"int rho X x Psi_{i}{j}", "kg")
    return tuple(result)


def coefficients(of: FieldIntegrals, n: int) -> tuple[ModelConstant, ...]:
    """The integrals c1, c2, C3, C4, c6, c7, c8 (in the plane C5 is c8) of a body with n shapes, zeros with reasons."""
    result: list[ModelConstant] = []

    def integral(symbol: Symbol, value: Value, doc: str, unit: str) -> None:
        result.append(ModelConstant(symbol, value.expr, Source.APPENDIX, doc, unit, value.zero))

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
    return tuple(result)
