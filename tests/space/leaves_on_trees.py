"""Random trees of rigid bodies that carry flexible ones, and accelerations of scenes in both ways of lowering."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from trees_of_bodies import Table, random_tree

import derive
from derive.ir.analysis import operations
from derive.ir.interpreter import interpret
from derive.ir.kernel import Kernel
from derive.lowering.flat.constraints import right_hand_side
from derive.lowering.flat.context import Context
from derive.lowering.flat.kkt_matrix import by_factors
from derive.lowering.flat.setup import setup_kernel
from derive.lowering.flat.trees.accelerations import articulated_accelerations, by_articulated_bodies
from derive.lowering.flat.trees.tree_dynamics import tree_dynamics
from derive.lowering.model_functions import FunctionKind, OutputElements, functions_of
from derive.mechanics.symbols import Family, identity
from derive.spec.model.spatial_scene import SpatialScene

Array = NDArray[np.float64]
FRAMES = ("mean", "chord", "point")


def random_leaves(seed: int, kinds: tuple[str, ...], joints: tuple[str, ...], free: bool = False, **beam: Any) -> Table:
    """A random tree of rigid bodies, and a beam for each of `joints` on a random one of them; beam: further keys."""
    rng = np.random.default_rng(seed)
    tables = random_tree(seed, kinds, free)
    tables["ground"]["markers"]["far"] = [1, 0.2, 0.3]
    tables["springs"]["rope"]["between"][0] = "ground.far"
    for number, kind in enumerate(joints, 1):
        carrier, own = f"body{rng.integers(not free, len(kinds) + 1)}", f"beam{number}"
        tables["bodies"][carrier]["markers"][own] = _marker(rng)
        tables["bodies"][own] = {
            "length": 0.6,
            "mass": 0.9,
            "rotary_inertia": 1e-3,
            "bending_stiffness": 60,
            "ansatz": ["1", "xi", "xi^2"],
            "lateral": {"ansatz": ["1", "xi", "xi^2", "xi^3"], "bending_stiffness": 40},
            "torsion": {"ansatz": ["xi"], "stiffness": 20},
            "damping": {"ratio": 0.02},
            "markers": {"left": {"at": -1, "rotation": _marker(rng)["rotation"]}, "right": 1},
            **beam,
        }
        ends = [f"{carrier}.{own}", f"{own}.left"]
        tables["joints"][f"to_{own}"] = {"kind": kind, "between": ends if rng.integers(2) else ends[::-1]}
        tables["outputs"][f"r_{own}"] = {"kind": "reaction", "joint": f"to_{own}"}
    return tables


def _marker(rng: np.random.Generator) -> Table:
    e = rng.normal(size=4)
    return {"at": rng.uniform(-0.5, 0.5, 3).tolist(), "rotation": (e / np.linalg.norm(e)).tolist()}


@dataclass(frozen=True)
class Solved:
    """Accelerations and multipliers of a state, and the operations that they take."""

    vdot: Array
    multipliers: Array
    operations: int


def both_ways(tables: Table, seed: int = 0) -> tuple[Solved, Solved]:
    """A random state of a scene with a tree by articulated bodies and by the KKT matrix."""
    solved = both_ways_of(derive.spatial_scene(tables), seed)
    assert solved
    return solved


def both_ways_of(scene: SpatialScene, seed: int = 0, bent: float = 0.01) -> tuple[Solved, Solved] | None:
    """A random state by articulated bodies and by the KKT matrix; None without trees that have articulated bodies.

    bent: about the amplitudes of flexible bodies; those of truncated beams have to be small.
    """
    equations = derive.derive(replace(scene, coordinates="relative", lowering="flat")).expanded()
    context = Context(equations)
    function = next(f for f in functions_of(equations, explicit=True) if f.kind is FunctionKind.SOLVE)
    symbols = context.symbols(context.t, context.q, context.v)
    outputs = {"vdot": OutputElements(context.accelerations), "lam": OutputElements(context.multipliers)}
    tree = tree_dynamics(context, symbols)
    if tree is None or not by_articulated_bodies(context, tree):
        return None
    kernels = (
        articulated_accelerations(context, function, outputs, symbols, tree),
        by_factors(context, function, outputs, symbols, right_hand_side(context, symbols)),
    )
    setup, constants = setup_kernel(context, kernels)
    k = interpret(setup, {"p": [p.default for p in equations.parameters]})["k"]
    rng = np.random.default_rng(seed)
    deforms = [identity(c.q).family is Family.AMPLITUDE for c in equations.coordinates]
    q = np.where(deforms, bent, 1) * rng.normal(size=len(deforms))
    e0 = [n for n, c in enumerate(equations.coordinates) if identity(c.q).components == (0,)]
    for n in e0:
        q[n : n + 4] /= np.linalg.norm(q[n : n + 4])
    given = {
        "t": 0.1,
        "q": q,
        "v": rng.normal(size=len(context.rows)),
        "k": k,
        "u": rng.normal(size=len(equations.inputs)),
    }
    names = tuple(c.name for c in constants)
    solved = (_solved(kernel, names, given) for kernel in kernels)
    first, second = solved
    return first, second


def _solved(kernel: Kernel, constants: tuple[str, ...], given: dict[str, Any]) -> Solved:
    arguments = tuple(replace(a, elements=constants) if a.name == "k" else a for a in kernel.arguments)
    found = interpret(replace(kernel, arguments=arguments), {a.name: given[a.name] for a in arguments})
    return Solved(np.array(found["vdot"]), np.array(found["lam"]), sum(map(operations, kernel.statements)))
