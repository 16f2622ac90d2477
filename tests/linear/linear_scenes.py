"""Scenes whose modes are known, and their accelerations as functions of independent coordinates."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import derive
from derive.runtime.native_scene import NativeScene
from derive.simulation.linear.linearisation import Linearisation
from derive.spec.model.scene import Scene

GRAVITY = 9.81


def hanging_rod(name: str, pieces: int = 1, shapes: int = 6, **beam) -> Scene:
    """A flexible rod of 1 m that hangs on a hinge, at rest."""
    rod = {
        "ansatz": [f"xi^{i}" for i in range(shapes)],
        "frame": "mean",
        "mass": 0.1,
        "length": 1,
        "bending_stiffness": 0.5,
        "pieces": pieces,
        "markers": {"left": -1, "right": 1},
        "start": {"position": [0, -0.5], "angle": -np.pi / 2},
        **beam,
    }
    return derive.scene(
        name,
        gravity=[0, -GRAVITY],
        ground={"hook": [0, 0]},
        bodies={"rod": rod},
        joints={"hinge": {"kind": "revolute", "between": ["ground.hook", "rod.left"]}},
    )


def pendulums(name: str, count: int, angle: float = -np.pi / 2, inertia: float = 1e-12, **changes) -> Scene:
    """Masses of 1 kg, each with its inertia, on massless bars of 0.5 m that form a chain, with all coordinates."""
    direction = np.array([np.cos(angle), np.sin(angle)])
    bodies = {
        f"bar{i}": {
            "mass": 1,
            "inertia": inertia,
            "centre": [0.5, 0],
            "markers": {"top": [0, 0], "bob": [0.5, 0]},
            "start": {"position": (0.5 * i * direction).tolist(), "angle": angle},
            "keep_coordinates": True,
        }
        for i in range(count)
    }
    ends = ["ground.hook", *(f"bar{i}.bob" for i in range(count - 1))]
    joints = {f"pin{i}": {"kind": "revolute", "between": [end, f"bar{i}.top"]} for i, end in enumerate(ends)}
    return derive.scene(name, gravity=[0, -GRAVITY], ground={"hook": [0, 0]}, bodies=bodies, joints=joints, **changes)


Function = Callable[[np.ndarray], np.ndarray]


def chart(native: NativeScene, k: np.ndarray, linear: Linearisation) -> tuple[Function, np.ndarray]:
    """The function of [x; u] that returns zddot and the outputs of a scene, and its argument in the linearised state.

    Newton steps give the dependent coordinates.
    """
    n, names, t = linear.count, list(native.coordinates), linear.t
    free = [names.index(name) for name in linear.states[:n]]
    others = [i for i in range(native.nq) if i not in free]
    inputs = len(native.inputs)

    def values(arguments: np.ndarray) -> np.ndarray:
        x, u = arguments[: 2 * n], arguments[2 * n :]
        constants = native.with_inputs(k, u) if inputs else k
        q, v = linear.q.copy(), np.zeros(native.nv)
        q[free], v[free] = np.split(x, 2)

        def dependent() -> np.ndarray:
            return native.constraint_pattern.dense(native.constraint_jacobian(t, q, constants))[:, others]

        for _ in range(6):
            q[others] -= np.linalg.solve(dependent(), native.constraints(t, q, constants))
        v[others] = np.linalg.solve(dependent(), -native.constraint_rates(t, q, v, constants))
        vdot, lam = native.solve(t, q, v, constants)
        return np.concatenate([vdot[free], native.evaluate_outputs(t, q, v, vdot, lam, constants)])

    u = np.asarray(k)[len(k) - inputs :]
    return values, np.concatenate([linear.q[free], linear.v[free], u])


def derivative(function: Callable[[np.ndarray], np.ndarray], x: np.ndarray, step: float = 1e-4) -> np.ndarray:
    """Central differences of fourth order."""
    columns = []
    for unit in step * np.eye(len(x)):
        near, far = (function(x + s * unit) - function(x - s * unit) for s in (1, 2))
        columns.append((8 * near - far) / (12 * step))
    return np.array(columns).T
