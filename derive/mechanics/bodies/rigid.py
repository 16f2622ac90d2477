"""The rigid body in the plane: no shapes, and the moments of X about the origin of its frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.bodies.planar_integrals import Value, coefficients
from derive.mechanics.body import Body, planar_body
from derive.mechanics.motion.material_points import MaterialPoint
from derive.mechanics.symbols import Family, Identity
from derive.mechanics.terms import ModelConstant
from derive.mechanics.zero_reasons import AT_CENTRE

if TYPE_CHECKING:
    pass


@dataclass(frozen=True)
class RigidIntegrals:
    """Moments of X of a rigid body whose centre of mass lies at `centre`; see FieldIntegrals."""

    mass: sp.Expr
    inertia: sp.Expr
    centre: sp.Matrix

    def first(self, i: int, component: int) -> Value:
        """The first moment int rho X . e_component."""
        value = sp.expand(self.mass * self.centre[component - 1])
        return Value(value, None if value else AT_CENTRE)

    def trace(self, i: int, j: int) -> Value:
        """The moment int rho X . X: the moment of inertia about O, by the parallel axis theorem."""
        return Value(sp.expand(self.inertia + self.mass * self.centre.dot(self.centre)))

    def axial(self, i: int, j: int) -> Value:
        """Raise IndexError, since a rigid body has no shapes."""
        raise IndexError("a rigid body has no shapes")


def rigid_body(
    name: str,
    mass: sp.Expr,
    inertia: sp.Expr,
    centre: sp.Matrix,
    points: tuple[MaterialPoint, ...],
    gravity: tuple[ModelConstant, ...],
) -> Body:
    """A rigid body; `inertia` is about the centre of mass, `centre` and points count from O."""
    constants = coefficients(RigidIntegrals(mass, inertia, centre), 0)
    return planar_body(name, "rigid body in the plane", "", 0, mass, constants, points, (), gravity)


def rigid_point(name: str, position: sp.Matrix) -> MaterialPoint:
    """A point of a rigid body at `position` from O."""
    symbols = [Identity(Family.POINT_POSITION, components=(k,), point=name).symbol for k in (1, 2)]
    result = tuple(
        ModelConstant(s, sp.expand(x), "(24)", f"X . e{k} of {name}", "m", None if x else "the choice of the origin")
        for k, (s, x) in enumerate(zip(symbols, position, strict=True), 1)
    )
    return MaterialPoint(name, f"point {name}", sp.ImmutableMatrix(symbols), (), result)
