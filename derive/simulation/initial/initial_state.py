"""The initial state of a scene: the guess of its specification in the coordinates of the scene, made consistent."""

from __future__ import annotations

import math

import numpy as np

from derive.mechanics.multibody.bodies.beam import piece_name
from derive.mechanics.symbols import Family, owned, quantity
from derive.roles import Role
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import Mask, coordinates_with
from derive.simulation.errors import ExcessiveDeformation
from derive.simulation.initial.consistent_state import InitialState, consistent_state
from derive.simulation.observables.beams import beam_bodies, relative_deflection
from derive.simulation.observables.motion import SceneMotion, si_value
from derive.spec.model.scene import BeamBody, CustomBody, InitialGuess, RigidBody, Scene

MAX_DEFLECTION = 0.3
"""Of the length of a beam: an initial state with a larger deflection is not one of this mechanism."""


def initial_state(scene: Scene, native: NativeScene, k: Vector | None = None) -> InitialState:
    """The consistent state at t = 0 closest to the initial guess of a scene.

    native: the compiled scene. k: the constants (nk,) of `native.setup`, those of the default parameters if None.

    Raises SimulationError with the constraints that cannot be met, and ExcessiveDeformation where they can be met only
    by beams that bend beyond what linear displacements describe.
    """
    constants = native.setup() if k is None else k
    state = consistent_state(native, constants, *initial_guess(scene, native))
    if state.deformed:
        motion = SceneMotion(scene, native, constants, np.array([state.t]), state.q[None], state.v[None])
        deflections = {b.name: relative_deflection(motion, b) for b in beam_bodies(scene)}
        if excessive := {name: value for name, value in deflections.items() if value > MAX_DEFLECTION}:
            raise ExcessiveDeformation(excessive)
    return state


def initial_guess(scene: Scene, native: NativeScene) -> tuple[Vector, Vector, Mask]:
    """The guesses of q (nq,) and v (nv,), and the mask (nq,) of the coordinates of rigid-body motion.

    Each body moves as a rigid one, and all pieces of a beam as parts of it. Of a body whose coordinates a joint
    eliminates, the guess concerns those that remain.
    """
    values: dict[str, float] = {}
    rates: dict[str, float] = {}
    for body in scene.bodies:
        if isinstance(body, BeamBody):
            for k in range(body.pieces):
                _guess_frame(values, rates, piece_name(body, k), body.start, _piece_centre(body, k))
        else:
            centre = tuple(si_value(x) for x in body.centre) if isinstance(body, RigidBody) else (0.0, 0.0)
            _guess_frame(values, rates, body.name, body.start, centre)
            _guess_displacement(values, rates, body, native)
    q = np.array([values.get(name, 0.0) for name in native.coordinates])
    v = np.array([rates.get(name, 0.0) for name in native.coordinates])
    return q, v, ~coordinates_with(native, Role.AMPLITUDE)


def _guess_frame(
    values: dict[str, float], rates: dict[str, float], name: str, start: InitialGuess, origin: tuple[float, ...]
) -> None:
    """c1, c2, phi and their rates of a body frame whose origin lies at the point `origin` (2,), m, of the body."""
    cos, sin = math.cos(start.angle), math.sin(start.angle)
    arm = (cos * origin[0] - sin * origin[1], sin * origin[0] + cos * origin[1])
    c1, c2, phi = (_name(name, *c) for c in ((Family.TRANSLATION, 1), (Family.TRANSLATION, 2), (Family.ANGLE,)))
    values |= {c1: start.position[0] + arm[0], c2: start.position[1] + arm[1], phi: start.angle}
    rates |= {
        c1: start.velocity[0] - start.spin * arm[1],
        c2: start.velocity[1] + start.spin * arm[0],
        phi: start.spin,
    }


def _guess_displacement(
    values: dict[str, float], rates: dict[str, float], body: RigidBody | CustomBody, native: NativeScene
) -> None:
    """The displacement along a guide, of a body that has no other coordinate: from where it is at 0, along its axis."""
    name = _name(body.name, Family.GUIDE)
    if name not in native.coordinates:
        return
    q, k, index = np.zeros(native.nq), native.setup(), native.bodies.index(body.name)
    origin = native.poses(0.0, q, k)[index, :2]
    q[native.coordinates.index(name)] = 1.0
    axis = native.poses(0.0, q, k)[index, :2] - origin
    values[name] = float(axis @ (np.array(body.start.position) - origin))
    rates[name] = float(axis @ np.array(body.start.velocity))


def _name(body: str, family: Family, *components: int) -> str:
    """The name of a coordinate of a body."""
    name: str = owned(quantity(family, *components), body).name
    return name


def _piece_centre(beam: BeamBody, k: int) -> tuple[float, float]:
    """The centre (m) of piece k along the undeformed beam, from the centre of the beam."""
    length = si_value(beam.beam.length) / beam.pieces
    return (k - (beam.pieces - 1) / 2) * length, 0.0
