"""The stresses of finite-element bodies in motion: those of their modes times the amplitudes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from derive.mechanics.symbols import amplitude_of
from derive.reduction.body import prepare
from derive.reduction.modal_stresses import modal_stresses
from derive.runtime.native_scene import NativeScene
from derive.simulation.free_body import FreeBody
from derive.simulation.observables.motion import Array
from derive.solids.stresses import von_mises
from derive.spec.model.body import NodalBody
from derive.spec.model.instances import joined
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

CHUNK = 3_000_000
"""Stresses at nodes of which so many are in memory at a time."""


def stress_columns(scene: AnyScene, alone: NodalBody | None = None) -> dict[str, NodalBody]:
    """The bodies whose largest stress a simulation records, by the names of the columns.

    alone: a body in space that is simulated alone, in an empty scene.
    """
    if alone is not None:
        return {"stress": alone} if alone.stress else {}
    bodies = scene.bodies if isinstance(scene, SpatialScene) else ()
    flexible = (body for body in bodies if isinstance(body, FlexibleBody) and body.body.stress)
    return {joined(body.name, "stress"): body.body for body in flexible}


def stress_values(scene: AnyScene, native: NativeScene, q: Array, alone: NodalBody | None = None) -> list[Array]:
    """The largest stress (n,), Pa, of von Mises in each of these bodies at the coordinates q (n, nq)."""
    result = []
    for body in stress_columns(scene, alone).values():
        modes = len(prepare(body).shapes.phi)
        own = FreeBody(modes).amplitudes if alone else amplitude_places(native, body.name, modes)
        result.append(largest_stress(body, q[:, own])[0])
    return result


def amplitude_places(native: NativeScene, name: str, modes: int) -> list[int]:
    """The places of the amplitudes of a body with so many modes among the coordinates of a scene."""
    return [native.coordinates.index(amplitude_of(name, i).shown) for i in range(1, modes + 1)]


def largest_stress(body: NodalBody, amplitudes: Array) -> tuple[Array, NDArray[np.intp]]:
    """The largest stress (n,) of von Mises, Pa, at amplitudes (n, N), and the nodes (n,) that have it."""
    modal = modal_stresses(body)
    nodes = modal.shape[1]
    values, places = np.zeros(len(amplitudes)), np.zeros(len(amplitudes), dtype=np.intp)
    step = max(CHUNK // (6 * nodes), 1)
    for first in range(0, len(amplitudes), step):
        some = slice(first, first + step)
        stresses = von_mises(np.tensordot(amplitudes[some], modal, axes=1))
        places[some] = stresses.argmax(axis=1)
        values[some] = stresses.max(axis=1)
    return values, places
