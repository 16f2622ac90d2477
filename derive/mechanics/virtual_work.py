"""d'Alembert's virtual work of the inertia, (10)-(15), through the moments of the fields.

The product of two fields, integrated over the mass, is a sum of first and second moments of r, rdot, rddot and Phi_i.
In the plane a second moment int rho f g^T has four entries: its trace (f . g), its axial part (f x g), and two more.
The equations of motion do not change when the body base is turned, so the last two cancel; `total` checks it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import sympy as sp

from derive.mechanics.kinematics import HERE, ONE, PHI, RDDOT, RDOT, Field, R

STRETCH, SHEAR, NAMELESS = sp.symbols("stretch shear nameless")

FIRST = {R: "d1", RDOT: "d1dot", RDDOT: "d1ddot", PHI: "c2_i"}
"""int rho f of the appendix: d1 and its rates, c2_i."""

TRACE = {(R, R): "J", (R, RDOT): "D2dot", (R, PHI): "D2_i", (PHI, RDDOT): "c8ddot_i", (RDOT, RDOT): "c8dotdot"}
"""int rho f . g: J, D2_i, its sum with the rates, and the sums of c8_ij with accelerations and with rates."""

AXIAL = {(R, RDOT): "d3dot", (R, RDDOT): "d3ddot", (R, PHI): "d3_i", (PHI, RDOT): "c7dot_i"}
"""int rho f x g, odd in f and g: d3_i, its sums with rates and accelerations, and that of c7_ij with the rates."""


class Moments(Protocol):
    """The moments of the fields of a body: symbols of the appendix, in the body base; `rotation` is Q.

    `unknown` are the entries of second moments that no equation of motion may keep.
    """

    @property
    def mass(self) -> sp.Symbol:
        """int rho."""

    @property
    def rotation(self) -> sp.Matrix:
        """Q."""

    @property
    def unknown(self) -> frozenset[sp.Symbol]:
        """Symbols that must cancel."""

    def first(self, field: str) -> sp.Matrix:
        """int rho f."""

    def second(self, f: str, g: str) -> sp.Matrix:
        """int rho f g^T."""


@dataclass(frozen=True)
class PlanarMoments:
    """The moments of the fields of a planar body: symbols of the appendix, in the body base; `rotation` is Q."""

    mass: sp.Symbol
    rotation: sp.Matrix
    unknown: frozenset[sp.Symbol] = frozenset((STRETCH, SHEAR, NAMELESS))

    def first(self, field: str) -> sp.Matrix:
        """int rho f."""
        return sp.Matrix(sp.symbols(f"{FIRST[field]}_1 {FIRST[field]}_2"))

    def second(self, f: str, g: str) -> sp.Matrix:
        """int rho f g^T: trace, axial part, and two entries that no equation of motion may keep."""
        if transposed(f, g, {**TRACE, **AXIAL}):
            return self.second(g, f).T
        trace = sp.Symbol(TRACE.get((f, g), NAMELESS.name))
        axial = sp.S.Zero if f == g else sp.Symbol(AXIAL.get((f, g), NAMELESS.name))
        return sp.Matrix([[trace + STRETCH, axial + SHEAR], [SHEAR - axial, trace - STRETCH]]) / 2


def transposed(f: str, g: str, names: dict[tuple[str, str], str]) -> bool:
    """Whether a second moment has its names the other way round. Raises ArithmeticError when it has none."""
    if (f, g) not in names and (g, f) not in names:
        raise ArithmeticError(f"the moment of {f} and {g} has no name in the appendix")
    return (f, g) not in names


def total(a: Field, b: Field, moments: Moments) -> sp.Expr:
    """int rho a . b over the body."""
    pairs = (_pair(f, ta, g, tb, moments) for f, ta in a.items() for g, tb in b.items())
    return sum(map(sp.expand, pairs), sp.S.Zero)


def _pair(f: str, a: sp.Matrix, g: str, b: sp.Matrix, moments: Moments) -> sp.Expr:
    if f == ONE and g == ONE:
        return moments.mass * a.dot(b)
    if f == ONE:
        return (moments.rotation * b * moments.first(g)).dot(a)
    if g == ONE:
        return (moments.rotation * a * moments.first(f)).dot(b)
    if f == HERE:
        return (b * moments.first(g)).dot(a)
    result = sp.expand(sum((a.T * b).multiply_elementwise(moments.second(f, g)), sp.S.Zero))
    if result.free_symbols & moments.unknown:
        raise ArithmeticError(f"the virtual work of {f} on {g} depends on the choice of the body base")
    return result
