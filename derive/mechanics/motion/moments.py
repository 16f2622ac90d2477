"""d'Alembert's virtual work of the inertia, (10)-(15), through the moments of the fields.

The product of two fields, integrated over the mass, is a sum of first and second moments of r, rdot, rddot and Phi_i.
In the plane a second moment int rho f g^T has four entries: its trace (f . g), its axial part (f x g), and two more.
The equations of motion do not change when the body frame is rotated, so the last two cancel; `total` checks it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Protocol

from derive.algebra import sp
from derive.mechanics.motion.kinematics import HERE, ONE, PHI, RDDOT, RDOT, Field, R
from derive.mechanics.motion.products import inner, product
from derive.mechanics.symbols import Family, I, ShapeIndex, local, quantity

if TYPE_CHECKING:
    from derive.mechanics.typed_symbol import Symbol


@cache
def unknown_parts() -> tuple[Symbol, Symbol, Symbol]:
    """The parts of a second moment that have no name, and must cancel."""
    return local("stretch"), local("shear"), local("nameless")


Moment = tuple[Family, int, tuple[ShapeIndex, ...]]
"""The identity of a moment: its family, its time derivative and its shapes."""

FIRST: dict[str, Moment] = {
    R: (Family.D1, 0, ()),
    RDOT: (Family.D1, 1, ()),
    RDDOT: (Family.D1, 2, ()),
    PHI: (Family.C2, 0, (I,)),
}
"""The first moments int rho f of the appendix: d1 and its rates, c2_i."""

FIRST_OF_SECOND_ORDER: dict[str, Moment] = {**FIRST, PHI: (Family.D4, 0, (I,))}
"""The first moments where r is quadratic in the amplitudes, so that dr/dalpha_i depends on them: d4_i."""

TRACE_OF_SUMS: dict[tuple[str, str], Moment] = {
    (PHI, RDDOT): (Family.C8_SUM, 2, (I,)),
    (RDOT, RDOT): (Family.RATE_PRODUCT, 0, ()),
}
"""The moments int rho f . g that are the sums of c8_ij with accelerations and with rates."""

TRACE: dict[tuple[str, str], Moment] = {
    (R, R): (Family.INERTIA, 0, ()),
    (R, RDOT): (Family.D2, 1, ()),
    (R, PHI): (Family.D2, 0, (I,)),
    **TRACE_OF_SUMS,
}
"""The moments int rho f . g in the plane: also J, D2_i, and its sum with rates."""

AXIAL: dict[tuple[str, str], Moment] = {
    (R, RDOT): (Family.D3, 1, ()),
    (R, RDDOT): (Family.D3, 2, ()),
    (R, PHI): (Family.D3, 0, (I,)),
    (PHI, RDOT): (Family.C7_SUM, 1, (I,)),
}
"""The moments int rho f x g, odd in f and g: d3_i, its sums with rates and accelerations, sum of c7_ij with rates."""


def moment(name: Moment, *components: int) -> Symbol:
    """The symbol of a moment, or of a component of it."""
    family, derivative, shapes = name
    return quantity(family, *components, derivative=derivative, shapes=shapes)


class Moments(Protocol):
    """The moments of the fields of a body: symbols of the appendix, in the body frame; `rotation` is Q.

    `unknown` are the entries of second moments that no equation of motion may keep.
    """

    @property
    def mass(self) -> sp.Symbol:
        """The mass int rho."""

    @property
    def rotation(self) -> sp.Matrix:
        """The rotation tensor Q."""

    @property
    def unknown(self) -> frozenset[sp.Symbol]:
        """The symbols that must cancel in the equations of motion."""

    def first(self, field: str) -> sp.Matrix:
        """The first moment int rho f."""

    def second(self, f: str, g: str) -> sp.Matrix:
        """The second moment int rho f g^T."""


@dataclass(frozen=True)
class PlanarMoments:
    """The moments of the fields of a planar body: symbols of the appendix, in the body frame; `rotation` is Q.

    `names` are those of the first moments.
    """

    mass: sp.Symbol
    rotation: sp.Matrix
    names: Mapping[str, Moment] = field(default_factory=lambda: FIRST)
    unknown: frozenset[sp.Symbol] = field(default_factory=lambda: frozenset(unknown_parts()))

    def first(self, field: str) -> sp.Matrix:
        """The first moment int rho f."""
        return sp.Matrix([moment(self.names[field], k) for k in (1, 2)])

    def second(self, f: str, g: str) -> sp.Matrix:
        """The second moment int rho f g^T: trace, axial part, and two entries that no equation of motion may keep."""
        if transposed(f, g, {**TRACE, **AXIAL}):
            return self.second(g, f).T
        stretch, shear, nameless = unknown_parts()
        trace = moment(TRACE[f, g]) if (f, g) in TRACE else nameless
        axial = sp.S.Zero if f == g else moment(AXIAL[f, g]) if (f, g) in AXIAL else nameless
        return sp.Matrix([[trace + stretch, axial + shear], [shear - axial, trace - stretch]]) / 2


def transposed(f: str, g: str, names: Mapping[tuple[str, str], object]) -> bool:
    """Whether a second moment has a name only with f and g exchanged. Raises ArithmeticError when it has none."""
    if (f, g) not in names and (g, f) not in names:
        raise ArithmeticError(f"the moment of {f} and {g} has no name in the appendix")
    return (f, g) not in names


def total(a: Field, b: Field, moments: Moments) -> sp.Expr:
    """The integral int rho a . b over the body."""
    pairs = (_pair(f, ta, g, tb, moments) for f, ta in a.items() for g, tb in b.items())
    return sum(map(sp.expand, pairs), sp.S.Zero)


def _pair(f: str, a: sp.Matrix, g: str, b: sp.Matrix, moments: Moments) -> sp.Expr:
    if f == ONE and g == ONE:
        return moments.mass * inner(a, b)
    if f == ONE:
        return inner(product(moments.rotation, b, moments.first(g)), a)
    if g == ONE:
        return inner(product(moments.rotation, a, moments.first(f)), b)
    if f == HERE:
        return inner(product(b, moments.first(g)), a)
    result = sp.expand(sum(product(a.T, b).multiply_elementwise(moments.second(f, g)), sp.S.Zero))
    if result.free_symbols & moments.unknown:
        raise ArithmeticError(f"the virtual work of {f} on {g} depends on the choice of the body frame")
    return result
