"""The initial state that a specification guesses, in the coordinates that the scene has."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from derive.mechanics.multibody.components import piece_name
from derive.runtime.native import NativeScene, Vector
from derive.simulation.observables.observables import number
from derive.spec.model.scene import BeamBody, InitialGuess, RigidBody, Scene


def guess(scene: Scene, native: NativeScene) -> tuple[Vector, Vector, NDArray[np.bool_]]:
    """q and v (nq,), and which coordinates are no deformation (nq,).

    A body moves as a rigid one, and all pieces of a rod as parts of it; of a body that a joint holds, what it keeps.
    """
    values: dict[str, float] = {}
    rates: dict[str, float] = {}
    for body in scene.bodies:
        if isinstance(body, BeamBody):
            for k in range(body.pieces):
                _free(values, rates, piece_name(body, k), body.start, _ahead(body, k))
        else:
            centre = tuple(number(x) for x in body.centre)
            _free(values, rates, body.name, body.start, centre)
            _guided(values, rates, body, native)
    q = np.array([values.get(name, 0.0) for name in native.coordinates])
    v = np.array([rates.get(name, 0.0) for name in native.coordinates])
    rigid = np.array([name.rsplit("_", 1)[-1] in ("c1", "c2", "phi", "s") for name in native.coordinates])
    return q, v, rigid


def _free(
    values: dict[str, float], rates: dict[str, float], name: str, start: InitialGuess, at: tuple[float, ...]
) -> None:
    """c1, c2, phi of the point `at` of a body, which is where its coordinates have their origin."""
    cos, sin = math.cos(start.angle), math.sin(start.angle)
    arm = (cos * at[0] - sin * at[1], sin * at[0] + cos * at[1])
    values |= {
        f"{name}_c1": start.position[0] + arm[0],
        f"{name}_c2": start.position[1] + arm[1],
        f"{name}_phi": start.angle,
    }
    rates |= {
        f"{name}_c1": start.velocity[0] - start.spin * arm[1],
        f"{name}_c2": start.velocity[1] + start.spin * arm[0],
        f"{name}_phi": start.spin,
    }


def _guided(values: dict[str, float], rates: dict[str, float], body: RigidBody, native: NativeScene) -> None:
    """The displacement along a guide, from where the body is without it and the way that it goes."""
    name = f"{body.name}_s"
    if name not in native.coordinates:
        return
    q, k, place = np.zeros(native.nq), native.setup(), native.bodies.index(body.name)
    origin = native.poses(0.0, q, k)[place, :2]
    q[native.coordinates.index(name)] = 1.0
    axis = native.poses(0.0, q, k)[place, :2] - origin
    values[name] = float(axis @ (np.array(body.start.position) - origin))
    rates[name] = float(axis @ np.array(body.start.velocity))


def _ahead(rod: BeamBody, k: int) -> tuple[float, float]:
    """Where the centre of piece k lies along the undeformed rod, from the centre of that."""
    piece = number(rod.beam.length) / rod.pieces
    return (k - (rod.pieces - 1) / 2) * piece, 0.0
