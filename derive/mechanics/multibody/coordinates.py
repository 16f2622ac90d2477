"""Minimal coordinates: the coordinates of a free body as functions of the coordinates it has in a mechanism.

A joint to the ground, or to a body with a prescribed motion, eliminates coordinates of a rigid body. A flexible body
keeps all of its coordinates, because the joint constrains a point of it, whose position depends on all of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.symbols import Family, owned, quantity
from derive.mechanics.terms import Coordinate, EquationOfMotion, Intermediate

if TYPE_CHECKING:
    from derive.mechanics.motion.body_motion import Motion
    from derive.mechanics.multibody.point_motion import Derivatives, PointMotion
    from derive.mechanics.multibody.space.tree.carried_motion import CarriedMotion
    from derive.mechanics.typed_symbol import Symbol


@dataclass(frozen=True)
class CoordinateMap:
    """The coordinates of a body in a mechanism, and those of the free body as functions of them.

    coordinates, rows: the coordinates and the equations of motion of the body in the mechanism. values: each
    coordinate, velocity and acceleration of the free body as an expression of them. weights: for each of `rows`, the
    factors of the equations of the free body, by name, whose sum it is. definitions: the quantities of a prescribed
    motion. reason: why coordinates are eliminated. attitude: in space the rotation tensor of a body without quaternion,
    which `definitions` define. carried: the motion of a body in a tree of joints in space, by which rows of the bodies
    before it move it as well.
    """

    coordinates: tuple[Coordinate, ...]
    rows: tuple[EquationOfMotion, ...]
    values: Mapping[sp.Basic, sp.Basic]
    weights: tuple[Mapping[str, sp.Expr], ...]
    definitions: tuple[Intermediate, ...] = ()
    reason: str = ""
    attitude: sp.ImmutableMatrix | None = None
    carried: CarriedMotion | None = None

    @property
    def is_carried(self) -> bool:
        """Whether the body is in a tree of joints in space."""
        return self.carried is not None


def free_coordinates(name: str, motion: Motion) -> CoordinateMap:
    """The map of a body that keeps all coordinates; their names get that of the body as a prefix."""
    coordinates, rows = [], []
    values: dict[sp.Basic, sp.Basic] = {}
    for coordinate, row in zip(motion.coordinates, motion.rows, strict=True):
        new, new_row = new_coordinate(owned(coordinate.q, name), f"{name}: {coordinate.doc}", coordinate.unit)
        coordinates.append(new)
        rows.append(new_row)
        values |= {coordinate.q: new.q, row.v: new_row.v, row.a: new_row.a}
    return CoordinateMap(tuple(coordinates), tuple(rows), values, tuple({row.name: sp.S.One} for row in motion.rows))


def prescribed_motion(name: str, motion: Motion, at: PointMotion, rotation: Derivatives, reason: str) -> CoordinateMap:
    """The map of a body without coordinates.

    Its origin O follows a point `at` whose motion is prescribed; `rotation` is the rotation angle (rad) and its two
    derivatives as functions of t.
    """
    values, definitions = _origin(name, motion, at)
    for symbol, value in zip(_symbols(motion, 2), rotation, strict=True):
        new, own = _named(name, symbol, value, f"prescribed rotation of {name}")
        values[symbol] = new
        definitions += own
    return CoordinateMap((), (), values, (), tuple(definitions), reason)


def rotation_only(name: str, motion: Motion, at: PointMotion, reason: str) -> CoordinateMap:
    """The map of a body whose only coordinate is its rotation; O follows a point `at` whose motion is prescribed."""
    values, definitions = _origin(name, motion, at)
    coordinate, row = new_coordinate(owned(quantity(Family.ANGLE), name), f"rotation of {name}", "rad")
    values |= dict(zip(_symbols(motion, 2), (coordinate.q, row.v, row.a), strict=True))
    weights = {motion.rows[2].name: sp.S.One}
    return CoordinateMap((coordinate,), (row,), values, (weights,), tuple(definitions), reason)


def displacement_only(
    name: str, motion: Motion, at: PointMotion, axis: sp.Matrix, rotation: sp.Expr, reason: str
) -> CoordinateMap:
    """The map of a body whose only coordinate is the displacement s of O along a guide that is fixed to the ground.

    at: the point of the guide at s = 0. axis (2, 1): its direction. rotation: the constant rotation of the body (rad).
    """
    coordinate, row = new_coordinate(
        owned(quantity(Family.GUIDE), name), f"displacement of {name} along its guide", "m"
    )
    values: dict[sp.Basic, sp.Basic] = {}
    for k in range(2):
        q, v, a = _symbols(motion, k)
        values |= {q: at.position[k] + axis[k] * coordinate.q, v: axis[k] * row.v, a: axis[k] * row.a}
    values |= dict(zip(_symbols(motion, 2), (rotation, sp.S.Zero, sp.S.Zero), strict=True))
    weights = {motion.rows[k].name: axis[k] for k in range(2) if axis[k]}
    return CoordinateMap((coordinate,), (row,), values, (weights,), (), reason)


def new_coordinate(q: Symbol, doc: str, unit: str) -> tuple[Coordinate, EquationOfMotion]:
    """A coordinate, and the equation of motion of its virtual displacement."""
    name = q.name
    v, a = (replace(q.identity, derivative=d).symbol for d in (1, 2))
    force_unit = "N m" if unit == "rad" else "N"
    return Coordinate(q, doc, unit), EquationOfMotion(name, v, a, f"time derivative of {name}", f"{unit}/s", force_unit)


def _symbols(motion: Motion, k: int) -> tuple[sp.Symbol, sp.Symbol, sp.Symbol]:
    """Coordinate k of the free body, its velocity and its acceleration."""
    return motion.coordinates[k].q, motion.rows[k].v, motion.rows[k].a


def _origin(name: str, motion: Motion, at: PointMotion) -> tuple[dict[sp.Basic, sp.Basic], list[Intermediate]]:
    """The values of c and its derivatives for an origin O that follows a point, with the definitions for them."""
    values: dict[sp.Basic, sp.Basic] = {}
    definitions: list[Intermediate] = []
    for k in range(2):
        point = (at.position[k], at.velocity[k], at.acceleration[k])
        for symbol, value in zip(_symbols(motion, k), point, strict=True):
            new, own = _named(name, symbol, value, f"prescribed motion of the origin of {name}")
            values[symbol] = new
            definitions += own
    return values, definitions


def _named(name: str, symbol: sp.Symbol, value: sp.Expr, doc: str) -> tuple[sp.Expr, list[Intermediate]]:
    """Return a number or a symbol as it is, and for another value a new symbol with its definition."""
    if value.is_Rational or value.is_Symbol:
        return value, []
    new = owned(symbol, name)
    return new, [Intermediate(new, value, name, "(1)", doc)]
