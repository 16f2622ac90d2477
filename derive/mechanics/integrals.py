"""Shape integrals c1..c8 of the appendix, and d1, D2, d3, J made of them.

Since r = X + sum alpha_i Phi_i, every moment of r is a sum of moments of X, Phi_1, ..., Phi_N: the shape integrals.
A body supplies those as `FieldIntegrals`; the composition is the same for all bodies.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import sympy as sp

from derive.mechanics.equations import Coefficient, Definition

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

    def integral(name: str, value: Value, doc: str, unit: str) -> None:
        found.append(Coefficient(sp.Symbol(name), value.expr, APPENDIX, doc, unit, value.zero))

    shapes = range(1, n + 1)
    for k in (1, 2):
        integral(f"c1_{k}", of.first(0, k), f"int rho X . e{k}", "kg m")
    for i in shapes:
        for k in (1, 2):
            integral(f"c2_{i}_{k}", of.first(i, k), f"int rho Phi_{i} . e{k}", "kg")
    integral("C3", of.trace(0, 0), "int rho X . X", "kg m^2")
    for i in shapes:
        integral(f"C4_{i}", of.trace(0, i), f"int rho X . Phi_{i}", "kg m")
    for i in shapes:
        integral(f"c6_{i}", of.axial(0, i), f"int rho X x Phi_{i}", "kg m")
    for i in shapes:
        for j in range(i + 1, n + 1):
            integral(f"c7_{i}_{j}", of.axial(i, j), f"int rho Phi_{i} x Phi_{j}", "kg")
    for i in shapes:
        for j in range(i, n + 1):
            integral(f"c8_{i}_{j}", of.trace(i, j), f"int rho Phi_{i} . Phi_{j}", "kg")
    return tuple(found)


def definitions(alpha: tuple[sp.Symbol, ...], rates: tuple[sp.Symbol, ...]) -> tuple[Definition, ...]:
    """d1, D2, d3, J and their sums with the rates of alpha, from r = X + sum alpha_i Phi_i; zeros still inside."""
    n = len(alpha)
    shapes = range(1, n + 1)

    def deformed(undeformed: sp.Expr, moments: list[sp.Expr]) -> sp.Expr:
        return undeformed + sum((a * moment for a, moment in zip(alpha, moments, strict=True)), sp.S.Zero)

    def with_rates(moments: list[sp.Expr]) -> sp.Expr:
        return sum((rate * moment for rate, moment in zip(rates, moments, strict=True)), sp.S.Zero)

    def symbols(*names: str) -> list[sp.Symbol]:
        return [sp.Symbol(name) for name in names]

    found: list[Definition] = []
    for k in (1, 2):
        c2 = symbols(*(f"c2_{i}_{k}" for i in shapes))
        expr = deformed(sp.Symbol(f"c1_{k}"), c2)
        found.append(Definition(sp.Symbol(f"d1_{k}"), expr, "d1", APPENDIX, f"int rho r . e{k}"))
        expr = with_rates(c2)
        found.append(Definition(sp.Symbol(f"d1dot_{k}"), expr, "d1dot", APPENDIX, f"int rho rdot . e{k}"))
    for i in shapes:
        c8 = symbols(*("c8_{}_{}".format(*sorted((i, j))) for j in shapes))
        expr = deformed(sp.Symbol(f"C4_{i}"), c8)
        found.append(Definition(sp.Symbol(f"D2_{i}"), expr, "D2", APPENDIX, f"int rho r . Phi_{i}"))
    for i in shapes:  # r x Phi_i = X x Phi_i + sum alpha_j Phi_j x Phi_i, and c7 is odd in its indices
        c7 = [_odd("c7", j, i) for j in shapes]
        expr = deformed(sp.Symbol(f"c6_{i}"), c7)
        found.append(Definition(sp.Symbol(f"d3_{i}"), expr, "d3", APPENDIX, f"int rho r x Phi_{i}"))
    d2 = symbols(*(f"D2_{i}" for i in shapes))
    d3 = symbols(*(f"d3_{i}" for i in shapes))
    inertia = deformed(deformed(sp.Symbol("C3"), symbols(*(f"C4_{i}" for i in shapes))), d2)
    found.append(Definition(sp.Symbol("J"), inertia, "J", APPENDIX, "int rho r . r"))
    found.append(Definition(sp.Symbol("D2dot"), with_rates(d2), "D2dot", APPENDIX, "int rho r . rdot"))
    found.append(Definition(sp.Symbol("d3dot"), with_rates(d3), "d3dot", APPENDIX, "int rho r x rdot"))
    return tuple(found)


def _odd(name: str, i: int, j: int) -> sp.Expr:
    """The entry of an odd table, of which only i < j is named."""
    if i == j:
        return sp.S.Zero
    return sp.Symbol(f"{name}_{i}_{j}") if i < j else -sp.Symbol(f"{name}_{j}_{i}")
