"""Random graphs of bodies from a seed: chains, trees, stars, rings and grids of beams and rigid bodies, in any order.

Bodies are vertices and joints are edges; the ground is a further vertex. Markers, kinds, numbers, the order of the
joints and that of the bodies of each are drawn, and the masses of a scene differ by up to 1e6.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from graph_scenes import SHAPES, in_pieces, scene_tables, with_ports
from varying_joints import more_joints, with_varying_joints

import derive
from derive.ir.interpreter import RequirementError, interpret
from derive.ir.model import Model
from derive.lowering.flat.kkt_matrix import DependentConstraints
from derive.lowering.flat.lower import lower as lower_flat
from derive.lowering.instances.lower import lower_instances
from derive.roles import Role
from some_functions import only

TWIN = "twin_of_"
"""The first part of the name of a joint that is there twice."""
WELL_POSED = 1e-9
"""The least eigenvalue of G M^-1 G^T, scaled to ones on the diagonal, for which constraints count as independent."""


@dataclass(frozen=True)
class Graph:
    """A scene of random bodies lowered both ways, and a state in which its constraints are independent."""

    scene: derive.Scene
    shape: str
    flat: Model
    instances: Model
    state: dict[str, Any]

    def arguments(self, kernel: str, model: Model | None = None) -> dict[str, Any]:
        """The arguments of a function of one of the models, that with straight-line code unless it is given."""
        size = max((a.size for a in self.flat.kernel(kernel).arguments if a.name == "y"), default=0)
        given = self.state | {name: self.state[name][:size] for name in ("y", "ydot")}
        given["k"] = constants(model or self.flat)
        return {a.name: given[a.name] for a in self.flat.kernel(kernel).arguments}


def constants(model: Model) -> list[float]:
    """The constants of a model, with the defaults of its parameters."""
    return interpret(model.kernel("setup"), {"p": list(model.defaults)})["k"]


def graph(
    seed: int, most: int = 6, ports: bool = False, varying: bool = False, twins: int = 0, pieces: bool = False
) -> Graph:
    """The graph of a seed, with so many bodies at most; joints that close loops are left out if some are redundant.

    ports: with parameters, an input, springs and outputs, and with the derivatives with respect to these; varying: with
    joints whose axes move or that remove functions of several relative motions; twins: the number of joints of which
    there is another one, so that reactions are those of least norm; pieces: with beams in pieces.
    """
    for kept in (1.0, 0.5, 0.25, 0.0):
        shape = SHAPES[seed % len(SHAPES)]
        tables = scene_tables(shape, random.Random(seed), most, kept)
        if pieces:
            tables |= {"bodies": in_pieces(tables["bodies"], random.Random(f"pieces {seed}"))}
        twin = [*tables["joints"]][:twins]
        if varying:
            tables = with_varying_joints(tables, random.Random(f"varying {seed}"), carried=kept > 0)
        joints = tables["joints"]
        tables |= {"joints": joints | {f"{TWIN}{name}": joints[name] for name in twin}}
        with more_joints():
            scene = derive.scene(f"graph_{seed}", **(with_ports(tables, seed % 2 == 1) if ports else tables))
            redundant = sum(len(derive.JOINTS[joints[name]["kind"]].removes) for name in twin)
            if made := lowered(scene, shape.__name__.strip("_"), seed, ports, redundant):
                return made
    raise AssertionError(f"seed {seed}: the constraints of a tree depend on each other")


def ring_of_rods(count: int, order: Sequence[int]) -> Graph:
    """A ring of pinned rods that differ in their numbers alone; order: that of the joints.

    Joint k is between the rods k and k + 1, so that some rods meet their joints in one order, and others in the other.
    """
    joints = {f"joint_{k}": [f"rod_{k}.right", f"rod_{(k + 1) % count}.left"] for k in order}
    scene = derive.scene(
        f"rods_{count}",
        bodies={
            f"rod_{k}": {
                "ansatz": ["1", "xi", "xi^2"],
                "mass": 1 + k,
                "length": 0.7,
                "bending_stiffness": 30,
                "markers": {"left": -1, "right": 1},
            }
            for k in range(count)
        },
        joints={name: {"kind": "revolute", "between": between} for name, between in joints.items()},
    )
    made = lowered(scene, "ring", count)
    assert made
    return made


def sliding_chain(count: int, driven: bool) -> Graph:
    """Carriages that differ in their numbers alone, each on a guide of the one before, the first one on a free body."""
    carriage = {"keep_coordinates": True, "markers": {"left": [-0.3, 0.1], "right": [0.4, 0.2]}}
    joints = {
        f"guide_{k}": {"kind": "translational", "between": [f"body_{k}.right", f"body_{k + 1}.left"], "axis": [3, 1]}
        for k in range(count - 1)
    }
    scene = derive.scene(
        f"sliding_{count}",
        bodies={f"body_{k}": carriage | {"mass": 1 + k, "inertia": 0.1 + 0.02 * k} for k in range(count)},
        joints=joints,
        inputs={"pull": {"unit": "m", "value": 0}} if driven else {},
        drives={f"drive_{k}": {"joint": name, "motion": {"input": "pull"}} for k, name in enumerate(joints)}
        if driven
        else {},
        outputs={f"held_{k}": {"kind": "reaction", "joint": name} for k, name in enumerate(joints)},
    )
    made = lowered(scene, "chain", count)
    assert made
    return made


def lowered(scene: derive.Scene, shape: str, seed: int, ports: bool = False, redundant: int = 0) -> Graph | None:
    """A scene both ways with a random state; None if more than so many of its constraints depend on others."""
    mechanism = derive.derive(scene)
    form = {"sensitivities": ports, "proximal": redundant > 0}
    try:
        with only():  # M and G, a small part of the work: many graphs are rejected by these
            first = lower_flat(mechanism.expanded(), proximal=redundant > 0)
        if not _well_posed(first, random_state(first, scene, np.random.default_rng(seed)), redundant):
            return None
        flat = lower_flat(mechanism.expanded(), **form)
    except DependentConstraints:
        return None
    state = random_state(flat, scene, np.random.default_rng(seed))
    number = {multiplier.name: k for k, multiplier in enumerate(flat.multipliers)}
    for name, k in number.items():  # right-hand sides of equal constraints are equal
        twin = number.get(f"{TWIN}{name}", k)
        state["r"][twin], state["b"][twin] = state["r"][k], state["b"][k]
    taken = {i for i, _ in flat.kernel("constraint_jacobian").outputs[0].pattern.entries}
    for k in set(number.values()) - taken:  # no coordinate can meet these
        state["r"][k] = state["b"][k] = 0.0
    if not _solvable(flat, state):
        return None
    return Graph(scene, shape, flat, lower_instances(mechanism, **form), state)


def random_state(model: Model, scene: derive.Scene, rng: np.random.Generator) -> dict[str, Any]:
    """A random state, with small amplitudes of the deformation, and with unit quaternions."""
    n, nv, rows = len(model.coordinates), len(model.velocities), len(model.multipliers)
    scale = [3.0 if c.role is Role.ROTATION else 1.0 for c in model.coordinates]
    deformed = np.array([c.role is Role.AMPLITUDE for c in model.coordinates])
    q = rng.uniform(-1, 1, n) * np.where(deformed, 0.02, scale)
    for k in [i for i, c in enumerate(model.coordinates) if c.role is Role.QUATERNION][::4]:
        q[k : k + 4] /= np.linalg.norm(q[k : k + 4])
    size = n + nv + 2 * rows
    y = np.concatenate([q, rng.uniform(-1, 1, nv), rng.uniform(-3, 3, 2 * rows)])
    return {
        "t": 0.3,
        "q": q.tolist(),
        "v": rng.uniform(-1, 1, nv).tolist(),
        "k": constants(model),
        "r": rng.uniform(-1, 1, rows).tolist(),
        "y": y.tolist(),
        "ydot": rng.uniform(-1, 1, size).tolist(),
        "u": rng.uniform(-1, 1, len(model.inputs)).tolist(),
        "vdot": rng.uniform(-1, 1, nv).tolist(),
        "lam": rng.uniform(-1, 1, rows).tolist(),
        "a": rng.uniform(-1, 1, nv).tolist(),
        "b": rng.uniform(-1, 1, rows).tolist(),
        "cj": 7.5,
        "F": [0.3, -0.7, 0.4][: 3 if model.in_space else 2],
    }


def _well_posed(model: Model, state: dict[str, Any], redundant: int) -> bool:
    """Whether M is positive definite and the constraints are independent of each other, but for so many."""
    m, g = (dense(model, name, state) for name in ("mass", "constraint_jacobian"))
    try:
        values = relative_eigenvalues(m, g)
    except np.linalg.LinAlgError:
        return False
    return int((values > WELL_POSED).sum()) == len(g) - redundant


def _solvable(model: Model, state: dict[str, Any]) -> bool:
    """Whether the pivots of the elimination are as they have to be."""
    try:
        interpret(model.kernel("solve"), {a.name: state[a.name] for a in model.kernel("solve").arguments})
    except (RequirementError, ZeroDivisionError):
        return False
    return True


def relative_eigenvalues(m: np.ndarray, g: np.ndarray) -> np.ndarray:
    """The eigenvalues of G M^-1 G^T, scaled to ones on the diagonal where it is not zero. Raises LinAlgError."""
    half = np.linalg.solve(np.linalg.cholesky(m), g.T)
    norms = np.linalg.norm(half, axis=0)
    values: np.ndarray = np.linalg.svd(half / np.where(norms > 0, norms, 1.0), compute_uv=False) ** 2
    return values


def dense(model: Model, name: str, state: dict[str, Any]) -> np.ndarray:
    """The matrix of a function as an array."""
    kernel = model.kernel(name)
    (output,) = kernel.outputs
    assert output.pattern
    (values,) = interpret(kernel, {a.name: state[a.name] for a in kernel.arguments}).values()
    return output.pattern.dense(np.array(values))
