"""The coordinates from which the assembly of a scene begins: each body as its own initial values describe it."""

from __future__ import annotations

import math

import numpy as np

from derive.mechanics.multibody.bodies.beam import piece_name
from derive.mechanics.symbols import Family, Identity, amplitude_of
from derive.roles import Role
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import Mask, coordinates_with
from derive.simulation.initial.targets import piece_deflections
from derive.simulation.observables.beams import half_length
from derive.simulation.observables.motion import si_value
from derive.spec.model.planar_bodies import BeamBody, CustomBody, RigidBody
from derive.spec.model.scene import Scene
from derive.spec.model.simulation import InitialValues


def initial_guess(scene: Scene, native: NativeScene, k: Vector | None = None) -> tuple[Vector, Vector, Mask]:
    """The guesses of q (nq,) and v (nv,), and the mask (nq,) of the coordinates of rigid-body motion.

    Each body moves as a rigid one, unless it has an initial deflection, and all pieces of a beam as parts of it. Values
    that are not given are zero. Of a body whose coordinates a joint eliminates, the guess concerns those that remain.

    k: the constants (nk,) of `native.setup`, those of the default parameters if None.
    """
    values: dict[str, float] = {}
    rates: dict[str, float] = {}
    for body in scene.bodies:
        if isinstance(body, BeamBody):
            _guess_beam(values, rates, body)
        else:
            centre = tuple(si_value(x) for x in body.centre) if isinstance(body, RigidBody) else (0.0, 0.0)
            _guess_frame(values, rates, body.name, body.start, centre)
            _guess_displacement(values, rates, body, native, k)
    q = np.array([values.get(name, 0.0) for name in native.coordinates])
    v = np.array([rates.get(name, 0.0) for name in native.coordinates])
    return q, v, ~coordinates_with(native, Role.AMPLITUDE)


def _guess_beam(values: dict[str, float], rates: dict[str, float], beam: BeamBody) -> None:
    """The frames of the pieces of a beam along its straight axis, displaced as its deflection requires; amplitudes."""
    half = half_length(beam)
    bent, bending = (piece_deflections(beam, curve) for curve in (beam.start.deflection, beam.start.deflection_rate))
    for k, (part, rate) in enumerate(zip(bent, bending, strict=True)):
        name, along = piece_name(beam, k), (2 * k + 1 - beam.pieces) * half
        _guess_frame(values, rates, name, beam.start, (along, float(part.offset)))
        angle = _name(name, Family.ANGLE)
        values[angle] += float(part.slope) / half
        rates[angle] += float(rate.slope) / half
        for i, (value, value_rate) in enumerate(zip(part.amplitudes, rate.amplitudes, strict=True), 1):
            coordinate = amplitude_of(name, i).shown
            values[coordinate], rates[coordinate] = float(value), float(value_rate)


def _guess_frame(
    values: dict[str, float], rates: dict[str, float], name: str, start: InitialValues, origin: tuple[float, ...]
) -> None:
    """Set c1, c2, phi and their rates of a body frame whose origin lies at the point `origin` (2,), m, of the body."""
    (x, y), angle = start.position or (0.0, 0.0), start.angle or 0.0
    (vx, vy), spin = start.velocity or (0.0, 0.0), start.spin or 0.0
    cos, sin = math.cos(angle), math.sin(angle)
    arm = (cos * origin[0] - sin * origin[1], sin * origin[0] + cos * origin[1])
    c1, c2, phi = (_name(name, *c) for c in ((Family.TRANSLATION, 1), (Family.TRANSLATION, 2), (Family.ANGLE,)))
    values |= {c1: x + arm[0], c2: y + arm[1], phi: angle}
    rates |= {c1: vx - spin * arm[1], c2: vy + spin * arm[0], phi: spin}


def _guess_displacement(
    values: dict[str, float],
    rates: dict[str, float],
    body: RigidBody | CustomBody,
    native: NativeScene,
    constants: Vector | None,
) -> None:
    """The displacement along a guide, of a body that has no other coordinate: from where it is at 0, along its axis."""
    name = _name(body.name, Family.GUIDE)
    if name not in native.coordinates:
        return
    q, index = np.zeros(native.nq), native.bodies.index(body.name)
    k = native.setup() if constants is None else constants
    origin = native.poses(0.0, q, k)[index, :2]
    q[native.coordinates.index(name)] = 1.0
    axis = native.poses(0.0, q, k)[index, :2] - origin
    values[name] = float(axis @ (np.array(body.start.position or (0.0, 0.0)) - origin))
    rates[name] = float(axis @ np.array(body.start.velocity or (0.0, 0.0)))


def _name(body: str, family: Family, *components: int) -> str:
    """The name of a coordinate of a body."""
    return Identity(family, components=components, owner=body).shown
