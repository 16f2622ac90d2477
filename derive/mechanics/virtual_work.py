"""d'Alembert's virtual work of the inertia, (10)-(15), through the moments of the fields.

The product of two fields, integrated over the mass, is a sum of the first and second moments of r, rdot and Phi_i.
In the plane a second moment int rho f g^T has four entries: its trace (f . g), its axial part (f x g), and two
more. The equations of motion do not change when the body base is turned, so the last two cancel; `product` checks it.
"""

from __future__ import annotations

import sympy as sp

from derive.mechanics.kinematics import ONE, RDOT, Field, R, phi


class Moments:
    """Symbols for the moments of the fields of a planar body: the quantities of the appendix, in the body base."""

    def __init__(self, mass: sp.Symbol, shape_rates: tuple[sp.Symbol, ...]) -> None:
        self.mass = mass
        self.shape_rates = shape_rates

    def first(self, field: str) -> sp.Matrix:
        """int rho f: d1 for r, its rate for rdot, c2_i for Phi_i."""
        name = {R: "d1", RDOT: "d1dot"}.get(field) or f"c2_{_index(field)}"
        return sp.Matrix(sp.symbols(f"{name}_1 {name}_2"))

    def trace(self, f: str, g: str) -> sp.Expr:
        """int rho f . g: J for (r, r), D2_i for (r, Phi_i), their sum with rates for (r, rdot), c8_ij for shapes."""
        if (f, g) == (R, R):
            return sp.Symbol("J")
        if {f, g} == {R, RDOT}:
            return sp.Symbol("D2dot")
        if R in (f, g):
            return sp.Symbol(f"D2_{_index(g if f == R else f)}")
        return sp.Symbol("c8_{}_{}".format(*sorted((_index(f), _index(g)))))

    def axial(self, f: str, g: str) -> sp.Expr:
        """int rho f x g (the component along e3): d3_i for (r, Phi_i), c7_ij for the shapes; odd in f, g."""
        if f == g:
            return sp.S.Zero
        if g == R or (f != R and _index(f) > _index(g)):
            return -self.axial(g, f)
        if f == R:
            return sp.Symbol("d3dot" if g == RDOT else f"d3_{_index(g)}")
        return sp.Symbol(f"c7_{_index(f)}_{_index(g)}")

    def second(self, f: str, g: str) -> sp.Matrix:
        """int rho f g^T: the trace, the axial part and two entries more that no equation of motion may keep."""
        trace, axial = self.trace(f, g), self.axial(f, g)
        return sp.Matrix([[trace + STRETCH, axial + SHEAR], [SHEAR - axial, trace - STRETCH]]) / 2


STRETCH, SHEAR = sp.symbols("stretch shear")


def _index(field: str) -> int:
    return int(field.split("_")[1])


def virtual_work(a: Field, b: Field, moments: Moments) -> dict[str, sp.Expr]:
    """int rho a . b over the body, as one expression for each field of a."""
    return {f: sp.expand(sum(_pair(f, ta, g, tb, moments) for g, tb in b.items())) for f, ta in a.items()}


def total(a: Field, b: Field, moments: Moments) -> sp.Expr:
    """int rho a . b over the body, as one expression."""
    return sum(virtual_work(a, b, moments).values(), sp.S.Zero)


def _pair(f: str, a: sp.Matrix, g: str, b: sp.Matrix, moments: Moments) -> sp.Expr:
    if f == RDOT and g not in (ONE, R):  # rdot = sum alphadot_i Phi_i, (14)
        return sum((_pair(phi(i), a * r, g, b, moments) for i, r in enumerate(moments.shape_rates, 1)), sp.S.Zero)
    if g == RDOT and f not in (ONE, R):
        return _pair(g, b, f, a, moments)
    if f == ONE and g == ONE:
        return moments.mass * a.dot(b)
    if f == ONE:
        return (b * moments.first(g)).dot(a)
    if g == ONE:
        return (a * moments.first(f)).dot(b)
    result = sp.expand(sum((a.T * b).multiply_elementwise(moments.second(f, g)), sp.S.Zero))
    if result.has(STRETCH) or result.has(SHEAR):
        raise ArithmeticError(f"the virtual work of {f} on {g} depends on the choice of the body base")
    return result
