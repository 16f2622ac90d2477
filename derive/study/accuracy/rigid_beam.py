"""A beam as a rigid body: its mass, centre and inertia with its attached masses, its loads, and its initial values.

A distributed load does the same work on a rigid body as its resultant at the point that is the mean over the load.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

from derive.errors import Problem, SpecError
from derive.mechanics.bodies.beam_functions import XI
from derive.mechanics.bodies.deflection_projection import projection
from derive.mechanics.multibody.bodies.beam_loads import LoadResultant, load_forces, resultants
from derive.simulation.observables.motion import si_value
from derive.spec.model.forces import Force
from derive.spec.model.instances import identifier
from derive.spec.model.markers import PointMarker
from derive.spec.model.planar_bodies import BeamBody, RigidBody
from derive.spec.model.simulation import InitialValues


def rigid_beam(body: BeamBody) -> RigidBody:
    """The beam as a rigid body with its attached masses, and with markers for `rigid_loads`.

    Raises SpecError where these do not describe the whole beam.
    """
    beam = body.beam
    for load in body.loads:
        if load.time.kind == "input":
            text = f"the factor of the load {load.name} is an input, and no force at a marker is a multiple of one"
            raise SpecError((Problem(f"bodies.{body.name}", f"as a rigid body it cannot have its loads: {text}"),))
    own, length = (Fraction(str(si_value(q))) for q in (beam.mass, beam.length))
    half = length / 2
    points = [(Fraction(0), own, own * length**2 / 12)]
    for part in beam.masses:
        points.append((part.at * half, Fraction(str(si_value(part.mass))), Fraction(str(si_value(part.inertia)))))
    mass = sum((m for _, m, _ in points), Fraction(0))
    centre = sum((m * x for x, m, _ in points), Fraction(0)) / mass
    inertia = sum((j + m * (x - centre) ** 2 for x, m, j in points), Fraction(0))
    markers = tuple(PointMarker(m.name, m.at * half, Fraction(0)) for m in beam.markers)
    markers += tuple(PointMarker(of.point, Fraction(str(of.mean(XI))) * half, Fraction(0)) for of in _whole(body))
    return RigidBody(body.name, mass, inertia, (centre, Fraction(0)), markers, _start(body.start, float(half)))


def rigid_loads(body: BeamBody) -> tuple[Force, ...]:
    """The forces on the rigid body in place of the loads on the beam."""
    forces = load_forces(replace(body, pieces=1), 0, body.name)
    return tuple(replace(force, name=identifier(force.name)) for force in forces)


def _whole(body: BeamBody) -> Iterator[LoadResultant]:
    return resultants(body.loads, 1, 0)


def _start(start: InitialValues, half: float) -> InitialValues:
    """The initial values of the nearest rigid motion, which are a guess if that is another motion.

    half: half the length of the beam, m.
    """
    if not start.deflection and not start.deflection_rate:
        return start
    (offset, slope), (rate, spin) = (_rigid_part(curve) for curve in (start.deflection, start.deflection_rate))
    angle = start.angle or 0.0
    normal = (-math.sin(angle), math.cos(angle))
    return InitialValues(
        None if start.position is None else _moved(start.position, normal, offset),
        None if start.angle is None else start.angle + slope / half,
        None if start.velocity is None else _moved(start.velocity, normal, rate),
        None if start.spin is None else start.spin + spin / half,
        guess=True,
    )


def _rigid_part(curve: tuple[Fraction, ...] | None) -> tuple[float, float]:
    """The mean of a deflection, and its slope by xi."""
    if not curve:
        return 0.0, 0.0
    (part,) = projection(curve, (), 1).parts
    return float(part.offset), float(part.slope)


def _moved(point: tuple[float, float], normal: tuple[float, float], distance: float) -> tuple[float, float]:
    return point[0] + distance * normal[0], point[1] + distance * normal[1]
