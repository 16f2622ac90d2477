"""A flexible body in space as a rigid body: its mass, its centre of mass, its inertia, its markers and where it starts.

Distributed loads of a beam become forces and torques at markers. Loads on nodes act on the rigid motion as they stand:
a body that has such is one of finite elements without modes.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from derive.errors import Problem, SpecError
from derive.mechanics.bodies.beam_functions import XI
from derive.mechanics.multibody.bodies.beam_loads import resultants
from derive.mechanics.multibody.space.beam_loads import load_actions
from derive.reduction.body import reduce
from derive.runtime.native_call import Vector
from derive.simulation.configurations import quaternion_of, rotation_matrix
from derive.simulation.observables.motion import si_value
from derive.simulation.space.bent_beams import bent_bodies
from derive.simulation.space.marker_frames import modal_frames_of
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.instances import identifier
from derive.spec.model.quantity import Quantity
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody, FrameMarker, SpatialRigidBody
from derive.spec.model.spatial_forces import SpatialForce, SpatialTorque
from derive.spec.model.spatial_start import NO_ROTATION, OF_BENT_BEAMS, SpatialInitialValues


def rigid_in_space(body: SpatialBeam | FlexibleBody) -> SpatialRigidBody | FlexibleBody:
    """A flexible body that does not deform, with the frame of the undeformed body."""
    if isinstance(body, SpatialBeam):
        return _beam(body)
    without = replace(body.body, component_modes=None, interface=(), interface_markers=())
    own = replace(without, modes=0, order=DisplacementOrder.FIRST_ORDER)
    if body.loads:
        return replace(body, body=own)
    data = reduce(own)
    centre = data.c1 / data.mass
    about_centre = data.C3 - data.mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    inertia = [about_centre[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    points = {name: _exact(frame.point.position) for name, frame in modal_frames_of(body).items()}
    markers = tuple(FrameMarker(m.name, _triple(points[m.name]), m.rotation) for m in body.markers)
    mass = Fraction(repr(float(data.mass)))
    return SpatialRigidBody(body.name, mass, _exact(inertia), _triple(_exact(centre)), markers, body.start)


def _beam(body: SpatialBeam) -> SpatialRigidBody:
    """A beam as a slender rigid body with its attached masses, and with markers for `rigid_actions`.

    Raises SpecError where these do not describe the whole beam.
    """
    for load in body.loads:
        if load.time.kind == "input":
            text = f"the factor of the load {load.name} is an input, and no force at a marker is a multiple of one"
            raise SpecError((Problem(f"bodies.{body.name}", f"as a rigid body it cannot have its loads: {text}"),))
    mass, length, about_axis, *beside = map(_value, (body.mass, body.length, body.rotary_inertia, *body.centre))
    half, across, none = length / 2, mass * length**2 / 12, Fraction(0)
    own: tuple[Fraction, ...] = (about_axis, across, across, none, none, none)
    parts = [(mass, np.array([none, *beside]), own)]
    for part in body.masses:
        place = np.array([part.at * half, none, none]) + [_value(x) for x in part.centre]
        parts.append((_value(part.mass), place, tuple(map(_value, part.inertia or (none,) * 6))))
    total = sum((m for m, _, _ in parts), none)
    centre = sum((m * x for m, x, _ in parts), np.array([none] * 3)) / total
    inertia = np.array([none] * 6)
    for m, x, own in parts:
        a, b, c = x - centre
        inertia = inertia + own + m * np.array([b * b + c * c, a * a + c * c, a * a + b * b, -a * b, -a * c, -b * c])
    markers = tuple(FrameMarker(m.name, (m.at * half, none, none), m.rotation) for m in body.markers)
    markers += tuple(FrameMarker(name, (at * half, none, none)) for name, at in _places(body).items())
    return SpatialRigidBody(body.name, total, tuple(inertia), _triple(tuple(centre)), markers, _start(body))


def _start(body: SpatialBeam) -> SpatialInitialValues:
    """The initial values of the nearest rigid motion, which are a guess if that is another motion."""
    start = body.start
    if all(getattr(start, name) is None for name in OF_BENT_BEAMS):
        return start
    (bent,) = bent_bodies(replace(body, pieces=1), rigid=True)
    quaternion = np.array(start.rotation or NO_ROTATION)
    position, velocity, spin = (
        np.array(of or (0.0, 0.0, 0.0)) for of in (start.position, start.velocity, start.angular_velocity)
    )
    straight = position, rotation_matrix(quaternion / np.linalg.norm(quaternion))
    position, axes = bent.body_frame(straight)
    velocity, spin = bent.frame_twist(straight[1], velocity, spin)
    return SpatialInitialValues(
        position=None if start.position is None else _floats(position),
        rotation=None if start.rotation is None else _floats(quaternion_of(axes)),
        velocity=None if start.velocity is None else _floats(velocity),
        angular_velocity=None if start.angular_velocity is None else _floats(spin),
        guess=True,
    )


def _floats(vector: Vector) -> Any:
    return tuple(map(float, vector))


def rigid_actions(body: SpatialBeam) -> tuple[SpatialForce | SpatialTorque, ...]:
    """The forces and torques on the rigid body in place of the loads on a beam."""
    return tuple(replace(action, name=identifier(action.name)) for action in load_actions(replace(body, pieces=1)))


def _places(body: SpatialBeam) -> dict[str, Fraction]:
    """The places xi at which `rigid_actions` act by the names of their markers; torques act anywhere."""
    means = {r.point: Fraction(str(r.mean(XI))) for r in resultants(body.loads, 1, 0)}
    return {at.marker: means.get(at.marker, Fraction(0)) for action in rigid_actions(body) for at in action.markers}


def _value(quantity: Quantity) -> Fraction:
    return Fraction(str(si_value(quantity)))


def _exact(values: Iterable[float]) -> tuple[Fraction, ...]:
    """Numbers in double precision as the decimals that they are printed as."""
    return tuple(Fraction(repr(float(x))) for x in values)


def _triple(values: Sequence[Fraction]) -> tuple[Fraction, Fraction, Fraction]:
    x, y, z = values
    return x, y, z
