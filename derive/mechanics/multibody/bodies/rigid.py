"""The rigid body in a mechanism, with its origin in its centre of mass or in a marker."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.multibody.bodies.body_type import BodyType, Component, Constant, CrossSection
from derive.spec.model.markers import PointMarker
from derive.spec.model.planar_bodies import RigidBody

if TYPE_CHECKING:
    from derive.mechanics.terms import ModelConstant

BODY_FRAME = "base"
"""The name of the origin of the body frame, from which marker coordinates count, as a point of the body."""


class Rigid(BodyType[RigidBody]):
    """The type of a rigid body, of which a joint may eliminate coordinates."""

    doc = "rigid body"

    def components(self, body: RigidBody, gravity: tuple[ModelConstant, ...]) -> tuple[Component, ...]:
        """The body with its origin O in its centre of mass."""
        return (_component(body, None, gravity),)

    def about(self, body: RigidBody, marker: str, gravity: tuple[ModelConstant, ...]) -> Component | None:
        """The body with its origin O in a marker, unless the specification wants all its coordinates."""
        return None if body.keep_coordinates else _component(body, marker, gravity)

    def missing(self, body: RigidBody) -> tuple[str, ...]:
        """The mass and inertia if they are not given; a body whose motion is prescribed does not need them."""
        return tuple(key for key in ("mass", "inertia") if getattr(body, key) is None)

    def constants(self, body: RigidBody) -> Iterator[Constant]:
        """The mass, inertia, centre of mass and marker coordinates."""
        yield Constant(body.mass, f"mass of {body.name}", positive=True)
        yield Constant(body.inertia, f"moment of inertia of {body.name} about its centre of mass", positive=True)
        for axis, x in enumerate(body.centre, 1):
            yield Constant(x, f"centre of mass of {body.name} along its e{axis}")
        yield from marker_constants(body.name, body.markers)


def marker_constants(body: str, markers: tuple[PointMarker, ...]) -> Iterator[Constant]:
    """The coordinates of the markers of a body."""
    for m in markers:
        yield Constant(m.x, f"marker {m.name} of {body} along its e1")
        yield Constant(m.y, f"marker {m.name} of {body} along its e2")


def rigid_component(
    name: str,
    mass: sp.Expr,
    inertia: sp.Expr,
    centre: sp.Matrix,
    markers: tuple[PointMarker, ...],
    about: str | None,
    gravity: tuple[ModelConstant, ...],
) -> Component:
    """A rigid component with its origin O in the marker `about`, or in its centre of mass.

    `inertia` is about the centre of mass; `centre` and the markers count from the origin of the body frame.
    """
    from derive.mechanics.bodies.rigid import rigid_body, rigid_point

    positions = {m.name: sp.Matrix([quantity.value(x, positive=False) for x in (m.x, m.y)]) for m in markers}
    origin = positions[about] if about else centre
    sections = {marker: CrossSection(rigid_point(marker, position - origin)) for marker, position in positions.items()}
    sections[BODY_FRAME] = CrossSection(rigid_point(BODY_FRAME, -origin))
    body = rigid_body(name, mass, inertia, centre - origin, (), gravity)
    return Component(name, name, body, sections, tuple(positions), name)


def _component(body: RigidBody, about: str | None, gravity: tuple[ModelConstant, ...]) -> Component:
    centre = sp.Matrix([quantity.value(x, positive=False) for x in body.centre])
    mass, inertia = (sp.S.Zero if x is None else quantity.value(x) for x in (body.mass, body.inertia))
    return rigid_component(body.name, mass, inertia, centre, body.markers, about, gravity)
