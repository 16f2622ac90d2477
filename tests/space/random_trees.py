"""Random trees of rigid bodies in space: all joints that give coordinates, branches, a root that is fixed or free."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.toml.read import parse

JOINTS: Mapping[str, Mapping[str, Any]] = {
    "revolute": {},
    "universal": {},
    "spherical": {},
    "cylindrical": {},
    "prismatic": {},
    "screw": {"pitch": 0.2},
    "planar": {},
    "fixed": {},
}
"""The kinds of joints of trees, with what else their tables have."""
RIGHT = {"axis": [1, 0, 0], "angle": np.pi / 2}


def random_tree(
    seed: int, bodies: int = 4, free: bool | None = None, loops: bool = False, coordinates: str = "relative"
) -> SpatialScene:
    """A tree: each joint of another kind, in turn; free: whether its first body hangs on nothing, by lot if None.

    loops: whether its last bodies close loops, by constraints of one and of three multipliers.
    """
    rng = np.random.default_rng(seed)
    free = bool(rng.integers(2)) if free is None else free
    kinds = [list(JOINTS)[k] for k in rng.permutation(len(JOINTS))]
    names = [f"b{n}" for n in range(bodies)]
    scene: dict[str, Any] = {
        "name": "tree",
        "scene": {"gravity": [0.3, 0, -9.81], "coordinates": coordinates},
        "ground": {"markers": {"m": _marker(rng)}},
        "bodies": {name: _body(rng, n) for n, name in enumerate(names)},
        "joints": {},
        "outputs": {f"a{n}": {"kind": "acceleration", "marker": f"{name}.m"} for n, name in enumerate(names)},
    }
    scene["outputs"] |= {"e": {"kind": "energy"}}
    for n, name in enumerate(names):
        if n == 0 and free:
            scene["bodies"][name]["start"] = {"angular_velocity": rng.uniform(-1, 1, 3).tolist()}
            continue
        before = f"{names[rng.integers(max(0, n - 2), n)]}.m" if n else "ground.m"
        ends = [before, f"{name}.own"] if rng.integers(2) else [f"{name}.own", before]
        kind = kinds[n % len(kinds)]
        scene["joints"][f"j{n}"] = {"kind": kind, "between": ends, **JOINTS[kind]}
    if loops:
        rod, ball = ["ground.m", f"{names[-1]}.m"], [f"{names[0]}.m", f"{names[-2]}.own"]
        scene["joints"]["rod"] = {"kind": "distance", "between": rod, "distance": 1}
        scene["joints"]["ball"] = {"kind": "spherical", "between": ball, "closes_loop": True}
    scene["springs"] = {
        "s": {
            "kind": "linear",
            "between": ["ground.m", f"{names[-1]}.m"],
            "stiffness": 20.0,
            "damping": 0.5,
            "rest": 0.1,
        }
    }
    spec = parse("\n".join(f"{key} = {_text(value)}" for key, value in scene.items()))
    assert isinstance(spec, SpatialScene)
    return spec


def _text(value: Any) -> str:
    """A value as in a TOML file, tables in one line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_text(of)}" for key, of in value.items()) + " }"
    return json.dumps(value)


def _marker(rng: np.random.Generator) -> dict[str, Any]:
    turns: list[Any] = [None, RIGHT, {"axis": rng.uniform(-1, 1, 3).tolist(), "angle": float(rng.uniform(0, 3))}]
    turn = turns[rng.integers(3)]
    place = (rng.uniform(-1, 1, 3) * rng.integers(0, 2, 3)).tolist()
    return {"at": place} if turn is None else {"at": place, "rotation": turn}


def _body(rng: np.random.Generator, number: int) -> dict[str, Any]:
    slender = number % 2
    products = [0, 0, 0] if slender else rng.uniform(-0.02, 0.02, 3).tolist()
    return {
        "mass": float(rng.uniform(0.5, 2)),
        "inertia": [*rng.uniform(0.1, 0.15, 3).tolist(), *products],
        "centre": [0, 0, 0.2] if slender else rng.uniform(-0.3, 0.3, 3).tolist(),
        "markers": {"own": _marker(rng), "m": _marker(rng)},
    }
