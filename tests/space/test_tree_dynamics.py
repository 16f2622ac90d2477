"""Recursions along trees of rigid bodies, beside M and h of their equations and beside absolute coordinates."""

from __future__ import annotations

import cmath
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from decimal_vectors import Array
from random_trees import random_tree

import derive
from derive.ir.analysis import operations
from derive.ir.interpreter import interpret
from derive.ir.model import Model
from derive.spec.model.spatial_bodies import SpatialRigidBody
from derive.spec.model.spatial_scene import SpatialScene

LIMIT = 1e-11
STEP = 1e-30
COMPLEX = {"sin": cmath.sin, "cos": cmath.cos}


def called(model: Model, name: str, **given: Any) -> dict[str, Array]:
    """The results of a kernel."""
    k = interpret(model.kernel("setup"), {"p": list(model.defaults)})["k"]
    arguments = {"t": 0.0, "u": [], "k": k, "lam": [], **given}
    functions = COMPLEX if np.iscomplexobj(given["q"]) else None
    found = interpret(model.kernel(name), arguments, check=False, functions=functions)
    return {key: np.array(values) for key, values in found.items()}


def state(model: Model, seed: int) -> tuple[Array, Array]:
    """Random q and v, with unit quaternions."""
    rng = np.random.default_rng(seed)
    names = [name for c in model.coordinates for name in c.elements]
    q = rng.uniform(-1.2, 1.2, len(names))
    for i in (i for i, name in enumerate(names) if name.endswith("e0")):
        q[i : i + 4] /= np.linalg.norm(q[i : i + 4])
    return q, rng.uniform(-2, 2, sum(v.size for v in model.velocities))


def differences(found: Mapping[str, Array], expected: Mapping[str, Array]) -> list[float]:
    """The differences of results, relative to the largest of the numbers of each."""
    return [float(abs(found[key] - x).max(initial=0) / abs(x).max(initial=1)) for key, x in expected.items()]


@pytest.mark.parametrize(("seed", "bodies", "loops"), [(0, 4, False), (3, 5, False), (4, 5, True)])
def test_recursions_solve_the_equations_of_trees(seed: int, bodies: int, loops: bool) -> None:
    """h by Newton and Euler and accelerations by articulated bodies are those of M and h, for no more operations."""
    equations = derive.derive(random_tree(seed, bodies, loops=loops)).expanded()
    models = [derive.lower(of, explicit=True) for of in (equations, replace(equations, trees=()))]
    q, v = state(models[0], seed)
    for name in ("force", "mass_force", "solve"):
        by_recursion, by_terms = (called(model, name, q=q, v=v) for model in models)
        assert max(differences(by_recursion, by_terms)) < LIMIT, name
        counts = [sum(map(operations, model.kernel(name).statements)) for model in models]
        assert counts[0] <= counts[1] or name == "mass_force"


def centres(scene: SpatialScene) -> dict[str, Array]:
    """The centres of mass from the origins of poses of a random tree: those of the bodies that hang on a joint."""
    hung = {end.body for joint in scene.joints for end in (joint.first, joint.second) if end.marker == "own"}
    bodies = (body for body in scene.bodies if isinstance(body, SpatialRigidBody))
    return {body.name: np.array([float(x) for x in body.centre]) * (body.name in hung) for body in bodies}  # type: ignore[arg-type]


def absolute_state(
    model: Model, q: Array, v: Array, absolute: Model, centre: Mapping[str, Array]
) -> tuple[Array, Array]:
    """The state in absolute coordinates, which have the centre of mass as the origin: the rates are those of poses."""
    names = [name for c in model.coordinates for name in c.elements]
    rates = [name for c in model.velocities for name in c.elements]
    known = dict(zip(names, q, strict=True)) | dict(zip(rates, v, strict=True))
    moving = q + 1j * STEP * called(model, "rates", q=q, v=v)["qdot"]
    for body, pose in zip(model.bodies, called(model, "poses", q=moving)["pose"].reshape(-1, 12), strict=True):
        Q = pose[3:].reshape(3, 3)
        x = pose[:3] + Q @ centre[body]
        spin = Q.real.T @ Q.imag / STEP
        values = [*x.real, *x.imag / STEP, *quaternion(Q.real), spin[2, 1], spin[0, 2], spin[1, 0]]
        axes, ends = (1, 2, 3), [f"c{k}" for k in (1, 2, 3)]
        keys = [*ends, *(f"{end}dot" for end in ends), "e0", *(f"e{k}" for k in axes), *(f"omega{k}" for k in axes)]
        known = {f"{body}_{key}": value for key, value in zip(keys, values, strict=True)} | known
    return tuple(  # type: ignore[return-value]
        np.array([known[name] for c in of for name in c.elements]) for of in (absolute.coordinates, absolute.velocities)
    )


def quaternion(Q: Array) -> Sequence[float]:
    """A quaternion of a rotation matrix: the eigenvector of 4 q q^T - 1."""
    a = np.array([Q[2, 1] - Q[1, 2], Q[0, 2] - Q[2, 0], Q[1, 0] - Q[0, 1]])
    below = Q + Q.T - np.trace(Q) * np.eye(3)
    return np.linalg.eigh(np.block([[np.array([[np.trace(Q)]]), a[None]], [a[:, None], below]]))[1][:, -1].tolist()


@pytest.mark.parametrize(("seed", "free"), [(2, True), (7, False)])
def test_trees_move_as_in_absolute_coordinates(seed: int, free: bool) -> None:
    """Accelerations of markers, energies and momenta are those of bodies with seven coordinates each."""
    scenes = [random_tree(seed, free=free, coordinates=of) for of in ("relative", "absolute")]
    relative, absolute = (derive.lower(derive.derive(scene), explicit=True) for scene in scenes)
    assert len(relative.multipliers) == 0 < len(absolute.multipliers)
    q, v = state(relative, seed)
    found = []
    in_absolute = absolute_state(relative, q, v, absolute, centres(scenes[0]))
    for model, (own_q, own_v) in ((relative, (q, v)), (absolute, in_absolute)):
        solved = called(model, "solve", q=own_q, v=own_v)
        further = called(model, "energy", q=own_q, v=own_v) | called(model, "momentum", q=own_q, v=own_v)
        found.append(called(model, "outputs", q=own_q, v=own_v, **solved) | further)
    assert max(differences(*found)) < LIMIT
