"""States of a scene along its motion: as it is simulated, and undeformed."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from derive.mechanics.multibody.joints.registry import JOINTS
from derive.runtime.native import NativeScene, Vector
from derive.simulation.compiled_scene import constraint_matrix
from derive.simulation.initial.consistent_state import consistent_state
from derive.simulation.initial.initial_state import initial_guess, initial_state
from derive.simulation.integration.scipy_methods import integrate
from derive.simulation.observables.motion import si_value
from derive.spec.model.scene import Scene
from derive.study.matrices import State

ITERATIONS, CLOSED = 20, 1e-12
"""Of Newton's method, and what it leaves of the constraints (m, rad)."""


def period(scene: Scene) -> tuple[float, str]:
    """The time (s) that is looked at, and what it is: a revolution of a drive, or the time of the simulation."""
    rotating = {j.name for j in scene.joints if (driven := JOINTS[j.kind].driven) and driven.unit == "rad"}
    for drive in scene.drives:
        if drive.speed is not None and drive.joint in rotating and si_value(drive.speed):
            return 2 * math.pi / abs(si_value(drive.speed)), f"one revolution of {drive.name}"
    assert scene.simulation is not None
    return scene.simulation.duration, f"{scene.simulation.duration:g} s"


def start(scene: Scene, native: NativeScene, k: Vector) -> State:
    """The consistent_state state at t = 0. Raises InconsistentStart."""
    found = initial_state(scene, native, k)
    return 0.0, found.q, found.v


def simulated(
    scene: Scene, native: NativeScene, k: Vector, count: int, progress: Callable[[float], None] | None = None
) -> list[State]:
    """`count` states, the first and the last a period apart, as the scene moves. Raises SimulationError."""
    _, q, v = start(scene, native, k)
    assert scene.simulation is not None
    times = np.linspace(0.0, period(scene)[0], count)
    found = integrate(native, k, q, v, times, tolerance=scene.simulation.tolerance, progress=progress)
    return [(float(t), found.q[i], found.v[i]) for i, t in enumerate(times)]


def undeformed(scene: Scene, native: NativeScene, k: Vector, moved: list[State]) -> list[State]:
    """The states of rigid bodies next to these, with no deformation. Raises InconsistentStart."""
    rigid = initial_guess(scene, native)[2]
    return [_rigid(native, k, t, np.where(rigid, q, 0.0), np.where(rigid, v, 0.0), rigid) for t, q, v in moved]


def _rigid(native: NativeScene, k: Vector, t: float, q: Vector, v: Vector, rigid: NDArray[np.bool_]) -> State:
    """Newton's method in the coordinates that are no deformation; or `consistent_state` if that fails.

    It is quick, as there are hundreds of states; they are next to states that the constraints allow.
    """
    closed = q.copy()
    for _ in range(ITERATIONS):
        g = native.constraints(t, closed, k)
        G = constraint_matrix(native, t, closed, k)[:, rigid]
        if np.max(np.abs(g), initial=0.0) < CLOSED:
            missing = native.constraint_rates(t, closed, v, k)
            v[rigid] -= np.linalg.lstsq(G, missing, rcond=None)[0]
            return t, closed, v
        closed[rigid] -= np.linalg.lstsq(G, g, rcond=None)[0]
    found = consistent_state(native, k, q, v, rigid, t)
    return t, found.q, found.v
