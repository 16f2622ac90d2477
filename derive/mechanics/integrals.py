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
    """d1, D2, d3, J and their sums with the rates of alpha, from r = X + sum alpha_j Phi_j; zeros still inside."""
    shapes = range(1, len(alpha) + 1)
    found: list[Definition] = []

    def define(name: str, expr: sp.Expr, doc: str) -> None:
        section = name.split("_", maxsplit=1)[0]
        found.append(Definition(sp.Symbol(name), expr, section, APPENDIX, doc))

    for k in (1, 2):
        define(f"d1_{k}", sp.Symbol(f"c1_{k}") + _sum(alpha, _c2(k, shapes)), f"int rho r . e{k}")
        define(f"d1dot_{k}", _sum(rates, _c2(k, shapes)), f"int rho rdot . e{k}")
    for i in shapes:
        define(f"D2_{i}", sp.Symbol(f"C4_{i}") + _sum(alpha, _c8(i, shapes)), f"int rho r . Phi_{i}")
    for i in shapes:  # r x Phi_i = X x Phi_i + sum alpha_j Phi_j x Phi_i
        define(f"d3_{i}", sp.Symbol(f"c6_{i}") - _sum(alpha, _c7(i, shapes)), f"int rho r x Phi_{i}")
    d2, d3 = ([sp.Symbol(f"{name}_{i}") for i in shapes] for name in ("D2", "d3"))
    c4 = [sp.Symbol(f"C4_{i}") for i in shapes]
    define("J", sp.Symbol("C3") + _sum(alpha, c4) + _sum(alpha, d2), "int rho r . r")
    define("D2dot", _sum(rates, d2), "int rho r . rdot")
    define("d3dot", _sum(rates, d3), "int rho r x rdot")
    return tuple(found)


def sums(rates: tuple[sp.Symbol, ...], accelerations: tuple[sp.Symbol, ...]) -> dict[sp.Symbol, sp.Expr]:
    """What (15) needs besides: the sums over the shapes that stand in one row only, or hold accelerations."""
    shapes = range(1, len(rates) + 1)
    found = {f"d1ddot_{k}": _sum(accelerations, _c2(k, shapes)) for k in (1, 2)}
    found["d3ddot"] = _sum(accelerations, [sp.Symbol(f"d3_{i}") for i in shapes])
    found |= {f"c8ddot_{i}": _sum(accelerations, _c8(i, shapes)) for i in shapes}
    found |= {f"c7dot_{i}": _sum(rates, _c7(i, shapes)) for i in shapes}
    found["c8dotdot"] = sp.expand(_sum(rates, [_sum(rates, _c8(i, shapes)) for i in shapes]))
    return {sp.Symbol(name): expr for name, expr in found.items()}


def of_index(expr: sp.Expr, i: int) -> sp.Expr:
    """An expression for the generic index i, for one shape."""

    def named(symbol: sp.Symbol) -> sp.Symbol:
        return sp.Symbol("_".join(str(i) if part == "i" else part for part in symbol.name.split("_")))

    return expr.xreplace({s: named(s) for s in expr.free_symbols})


def _sum(factors: tuple[sp.Symbol, ...], moments: list[sp.Expr]) -> sp.Expr:
    return sum((factor * moment for factor, moment in zip(factors, moments, strict=True)), sp.S.Zero)


def _c2(k: int, shapes: range) -> list[sp.Expr]:
    return [sp.Symbol(f"c2_{j}_{k}") for j in shapes]


def _c8(i: int, shapes: range) -> list[sp.Expr]:
    return [sp.Symbol("c8_{}_{}".format(*sorted((i, j)))) for j in shapes]


def _c7(i: int, shapes: range) -> list[sp.Expr]:
    return [_odd("c7", i, j) for j in shapes]


def _odd(name: str, i: int, j: int) -> sp.Expr:
    """The entry of an odd table, of which only i < j is named."""
    if i == j:
        return sp.S.Zero
    return sp.Symbol(f"{name}_{i}_{j}") if i < j else -sp.Symbol(f"{name}_{j}_{i}")
