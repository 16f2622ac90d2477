"""Random trees of rigid bodies in space as tables, and states of scenes in relative and absolute coordinates."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import derive
from derive.runtime.interpreted_scene import InterpretedScene
from derive.simulation.configurations import normalised
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.spatial_scene import SpatialScene
from some_functions import only

Table = dict[str, Any]
Array = NDArray[np.float64]
KINDS = ("revolute", "prismatic", "cylindrical", "universal", "spherical", "fixed", "screw", "planar")


def random_tree(seed: int, kinds: tuple[str, ...] = KINDS, free: bool = False) -> Table:
    """A tree of a body for each of `kinds`, each behind a joint of that kind to an earlier body; `free`: to no ground.

    Half of the joints have the body behind them as their first one.
    """
    rng = np.random.default_rng(seed)
    bodies: Table = {}
    joints: Table = {}
    names = ["body0"] if free else ["ground"]
    ground = {"o": _marker(rng)}
    if free:
        bodies["body0"] = _body(rng)
    for number, kind in enumerate(kinds, 1):
        name, parent = f"body{number}", names[rng.integers(len(names))]
        bodies[name] = _body(rng)
        if parent == "ground":
            before = "ground.o"
        else:
            bodies[parent]["markers"][f"to{number}"] = _marker(rng)
            before = f"{parent}.to{number}"
        turned = kind != "planar" and rng.integers(2)
        ends = [f"{name}.o", before] if turned else [before, f"{name}.o"]
        joints[f"joint{number}"] = {"kind": kind, "between": ends, **({"pitch": 0.2} if kind == "screw" else {})}
        names.append(name)
    at = f"body{len(kinds)}.o"
    return {
        "name": "tree",
        "scene": {"gravity": [0.5, 0, -9.81]},
        "ground": {"markers": ground},
        "bodies": bodies,
        "joints": joints,
        "forces": {"push": {"at": at, "force": [1, -2, 3]}},
        "torques": {"turn": {"on": at, "torque": [0.1, 0.2, -0.3], "frame": "body"}},
        "springs": {"rope": {"kind": "linear", "between": ["ground.o", at], "stiffness": 30, "damping": 2}},
        "outputs": {
            "a": {"kind": "acceleration", "marker": at},
            "energy": {"kind": "energy"},
            "power": {"kind": "power"},
            **{f"r{n}": {"kind": "reaction", "joint": name} for n, name in enumerate(joints)},
        },
    }


def _body(rng: np.random.Generator) -> Table:
    moments = rng.uniform(0.5, 1, 3)
    return {
        "mass": float(rng.uniform(0.5, 2)),
        "inertia": [*moments.tolist(), *rng.uniform(-0.1, 0.1, 3).tolist()],
        "centre": rng.uniform(-0.3, 0.3, 3).tolist(),
        "markers": {"o": _marker(rng)},
    }


def _marker(rng: np.random.Generator) -> Table:
    return {"at": rng.uniform(-0.5, 0.5, 3).tolist(), "rotation": _unit(rng)}


def _unit(rng: np.random.Generator) -> list[float]:
    e = rng.normal(size=4)
    return [float(x) for x in e / np.linalg.norm(e)]


@dataclass(frozen=True)
class State:
    """A state of a scene: the poses of its bodies (bodies, 12), its outputs, and its numbers of rows."""

    poses: Array
    outputs: Array
    velocities: int
    multipliers: int


@dataclass(frozen=True, eq=False)
class Lowered:
    """A scene that the interpreter evaluates."""

    scene: SpatialScene
    native: InterpretedScene
    k: Array

    def state(self, q: Array, v: Array) -> State:
        """The state with these coordinates and velocities."""
        native = self.native
        vdot, lam = native.solve(0.0, q, v, self.k)
        outputs = native.evaluate_outputs(0.0, q, v, vdot, lam, self.k)
        return State(native.poses(0.0, q, self.k), outputs, native.nv, native.nlambda)


def lowered(scene: SpatialScene) -> Lowered:
    """A scene as straight-line code for the interpreter."""
    with only("solve", "outputs", "poses"):
        equations = derive.derive(replace(scene, lowering="flat")).expanded()
        model = derive.lower(replace(equations, markers=()), explicit=True)
    native = InterpretedScene(model)
    return Lowered(scene, native, native.setup())


def both(tables: Table, seed: int, drive: tuple[str, float, float] | None = None) -> tuple[State, State]:
    """A random state of a tree in relative coordinates, and the same one with all coordinates of all bodies.

    drive: a coordinate that a drive prescribes, with its value and its rate at t = 0.
    """
    scene = derive.spatial_scene(tables)
    relative = lowered(replace(scene, coordinates="relative"))
    kept = tuple(replace(body, keep_coordinates=True) for body in scene.bodies)
    absolute = lowered(replace(scene, coordinates="absolute", bodies=kept))
    rng = np.random.default_rng(seed)
    q = normalised(relative.native, rng.normal(size=relative.native.nq))
    v = rng.normal(size=relative.native.nv)
    if drive is not None:
        number = relative.native.coordinates.index(drive[0])
        q[number], v[number] = drive[1:]
    poses = SpatialPoses(relative.native, relative.k, 0.0, q, 1.0)
    q_all, v_all = [], []
    for body in scene.bodies:
        Q, twist = poses.rotation(body.name), poses.twist(body.name)[0] @ v
        lever = Q @ np.array([float(x) for x in body.centre])
        e = Rotation.from_matrix(Q).as_quat()
        q_all.append(np.concatenate([poses.position(body.name) + lever, e[3:], e[:3]]))
        v_all.append(np.concatenate([twist[:3] + np.cross(Q @ twist[3:], lever), twist[3:]]))
    return relative.state(q, v), absolute.state(np.concatenate(q_all), np.concatenate(v_all))
