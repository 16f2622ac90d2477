"""States of a scene along its motion: simulated, and with undeformed bodies."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import constraint_matrix, max_norm
from derive.simulation.constraints.projection import UNAVOIDABLE
from derive.simulation.initial.closest_consistent_state import closest_consistent_state
from derive.simulation.initial.initial_guess import initial_guess
from derive.simulation.integration.adaptive import adaptive
from derive.simulation.integration.integrator import Settings
from derive.simulation.observables.motion import si_value
from derive.simulation.scene_start import state_of
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

State = tuple[float, Vector, Vector]
"""t (s), q (nq,) and v (nv,)."""

ITERATIONS, CONSISTENT = 20, 1e-12
"""The limit of Newton steps, and the |g| (m, rad) at which they end."""


def period(scene: AnyScene) -> tuple[float, str]:
    """The time (s) that a study covers, and its description: a revolution of a drive, or the duration of the scene."""
    kinds: Any = SPATIAL_JOINTS if isinstance(scene, SpatialScene) else JOINTS
    rotating = {j.name for j in scene.joints if (driven := kinds[j.kind].driven) and driven.unit == "rad"}
    for drive in scene.drives:
        speed = drive.constant_speed
        if speed is not None and drive.joint in rotating and si_value(speed):
            return 2 * math.pi / abs(si_value(speed)), f"one revolution of {drive.name}"
    assert scene.simulation is not None
    return scene.simulation.duration, f"{scene.simulation.duration:g} s"


def start_state(scene: AnyScene, native: NativeScene, k: Vector) -> State:
    """The consistent state at t = 0. Raises SimulationError."""
    state = state_of(scene, native, k)
    return 0.0, state.q, state.v


def simulated_states(scene: Scene, native: NativeScene, k: Vector, count: int) -> list[State]:
    """`count` states of the motion, equally spaced over a period. Raises SimulationError."""
    _, q, v = start_state(scene, native, k)
    assert scene.simulation is not None
    times = np.linspace(0.0, period(scene)[0], count)
    settings = Settings(scene.simulation.tolerance)
    solution = adaptive(native).integrate(k, q, v, times, settings)
    return [(float(t), solution.q[i], solution.v[i]) for i, t in enumerate(times)]


def undeformed_states(scene: Scene, native: NativeScene, k: Vector, states: list[State]) -> list[State]:
    """The consistent states without deformation closest to the given ones. Raises SimulationError."""
    rigid = initial_guess(scene, native)[2]
    return [_rigid(native, k, t, np.where(rigid, q, 0.0), np.where(rigid, v, 0.0), rigid) for t, q, v in states]


def _rigid(native: NativeScene, k: Vector, t: float, q: Vector, v: Vector, rigid: NDArray[np.bool_]) -> State:
    """The consistent state by Newton's method in rigid-body coordinates, else by `closest_consistent_state`.

    The guesses are close to consistent states, and Newton's method is fast enough for hundreds of them.
    """
    consistent = q.copy()
    for _ in range(ITERATIONS):
        g = native.constraints(t, consistent, k)
        G = constraint_matrix(native, t, consistent, k)[:, rigid]
        if max_norm(g) < max(CONSISTENT, UNAVOIDABLE * max_norm(q)):
            rates = native.constraint_rates(t, consistent, v, k)
            v[rigid] -= np.linalg.lstsq(G, rates, rcond=None)[0]
            return t, consistent, v
        consistent[rigid] -= np.linalg.lstsq(G, g, rcond=None)[0]
    state = closest_consistent_state(native, k, q, v, rigid, t)
    return t, state.q, state.v
