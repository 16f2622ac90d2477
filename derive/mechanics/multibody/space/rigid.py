"""The rigid body of a mechanism in space, with its origin in its centre of mass or in a marker."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.multibody.bodies.body_type import BodyType, Component, Constant, CrossSection
from derive.mechanics.multibody.bodies.rigid import BODY_FRAME
from derive.spec.model.quantity import Quantity
from derive.spec.model.spatial_bodies import FrameMarker, SpatialRigidBody

if TYPE_CHECKING:
    from derive.mechanics.terms import ModelConstant

NO_INERTIA: tuple[Quantity, ...] = (Fraction(0),) * 6
TENSOR = ((0, 3, 4), (3, 1, 5), (4, 5, 2))
"""The number of each entry of a tensor of inertia among [Jxx, Jyy, Jzz, Jxy, Jxz, Jyz]."""
ENTRIES = ("Jxx", "Jyy", "Jzz", "Jxy", "Jxz", "Jyz")


class SpatialRigid(BodyType[SpatialRigidBody]):
    """The type of a rigid body in space, of which a joint may eliminate coordinates."""

    doc = "rigid body"

    def components(self, body: SpatialRigidBody, gravity: tuple[ModelConstant, ...]) -> tuple[Component, ...]:
        """The body with its origin O in its centre of mass."""
        return (_component(body, None, gravity),)

    def about(self, body: SpatialRigidBody, marker: str, gravity: tuple[ModelConstant, ...]) -> Component | None:
        """The body with its origin O in a marker, unless the specification wants all its coordinates."""
        return None if body.keep_coordinates else _component(body, marker, gravity)

    def missing(self, body: SpatialRigidBody) -> tuple[str, ...]:
        """The mass and inertia if they are not given; a body whose motion is prescribed does not need them."""
        return tuple(key for key in ("mass", "inertia") if getattr(body, key) is None)

    def constants(self, body: SpatialRigidBody) -> Iterator[Constant]:
        """The mass, inertia, centre of mass and marker coordinates."""
        yield Constant(body.mass, f"mass of {body.name}", positive=True)
        for number, (entry, value) in enumerate(zip(ENTRIES, body.inertia or (), strict=False)):
            yield Constant(value, f"{entry} of {body.name} about its centre of mass", positive=number < 3)
        for axis, x in enumerate(body.centre, 1):
            yield Constant(x, f"centre of mass of {body.name} along its e{axis}")
        yield from frame_constants(body.name, body.markers)


def frame_constants(body: str, markers: Sequence[FrameMarker]) -> Iterator[Constant]:
    """The coordinates of the markers of a body or of the ground."""
    for m in markers:
        for axis, x in enumerate(m.position, 1):
            yield Constant(x, f"marker {m.name} of {body} along its e{axis}")


def column(position: Sequence[Quantity]) -> sp.Matrix:
    """A position as a column of exact values."""
    return sp.Matrix([quantity.value(x, positive=False) for x in position])


def _component(body: SpatialRigidBody, about: str | None, gravity: tuple[ModelConstant, ...]) -> Component:
    from derive.mechanics.bodies.spatial_rigid import spatial_rigid_body, spatial_rigid_point
    from derive.mechanics.motion.rotations import matrix_of

    centre = column(body.centre)
    positions = {m.name: column(m.position) for m in body.markers}
    origin = positions[about] if about else centre
    sections = {
        m.name: CrossSection(spatial_rigid_point(m.name, positions[m.name] - origin), axes=matrix_of(m.rotation))
        for m in body.markers
    }
    sections[BODY_FRAME] = CrossSection(spatial_rigid_point(BODY_FRAME, -origin))
    mass = sp.S.Zero if body.mass is None else quantity.value(body.mass)
    entries = [quantity.value(x, positive=number < 3) for number, x in enumerate(body.inertia or NO_INERTIA)]
    inertia = sp.Matrix(3, 3, lambda i, j: entries[TENSOR[i][j]])
    of = spatial_rigid_body(body.name, mass, inertia, centre - origin, gravity)
    return Component(body.name, body.name, of, sections, tuple(positions), body.name)
