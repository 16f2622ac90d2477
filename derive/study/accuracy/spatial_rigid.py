"""A flexible body in space as a rigid body: its mass, its centre of mass, its inertia, its markers and where it starts.

Loads on nodes act on the rigid motion as they stand: a body that has such is one of finite elements without modes.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction

import numpy as np

from derive.reduction.body import reduce
from derive.simulation.observables.motion import si_value
from derive.simulation.space.marker_frames import modal_frames_of
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.quantity import Quantity
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody, FrameMarker, SpatialRigidBody


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
    """A beam as a slender rigid body."""
    mass, length, about_axis = (_value(x) for x in (body.mass, body.length, body.rotary_inertia))
    across = mass * length**2 / 12
    centre = (Fraction(0), *(_value(x) for x in body.centre))
    none = Fraction(0)
    markers = tuple(FrameMarker(m.name, (m.at * length / 2, none, none), m.rotation) for m in body.markers)
    inertia = (about_axis, across, across, none, none, none)
    return SpatialRigidBody(body.name, mass, inertia, _triple(centre), markers, body.start)


def _value(quantity: Quantity) -> Fraction:
    return Fraction(str(si_value(quantity)))


def _exact(values: Iterable[float]) -> tuple[Fraction, ...]:
    """Numbers in double precision as the decimals that they are printed as."""
    return tuple(Fraction(repr(float(x))) for x in values)


def _triple(values: tuple[Fraction, ...]) -> tuple[Fraction, Fraction, Fraction]:
    x, y, z = values
    return x, y, z
