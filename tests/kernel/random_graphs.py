"""Random graphs of bodies from a seed: chains, trees, stars, rings and grids of beams and rigid bodies, in any order.

Bodies are vertices and joints are edges; the ground is a further vertex. Markers, kinds, numbers, the order of the
joints and that of the bodies of each are drawn, and the masses of a scene differ by up to 1e6.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from varying_joints import more_joints, with_varying_joints

import derive
from derive.ir.interpreter import RequirementError, interpret
from derive.ir.model import Model
from derive.lowering.flat.kkt_matrix import DependentConstraints
from derive.lowering.flat.lower import lower as lower_flat
from derive.lowering.instances.lower import lower_instances
from derive.lowering.model_functions import FunctionKind, ModelFunction, functions_of
from derive.mechanics.equations import Equations
from derive.roles import Role

Edges = list[tuple[int, int]]
GROUND = -1
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
        tables = _scene(shape, random.Random(seed), most, kept)
        if pieces:
            tables |= {"bodies": _in_pieces(tables["bodies"], random.Random(f"pieces {seed}"))}
        twin = [*tables["joints"]][:twins]
        if varying:
            tables = with_varying_joints(tables, random.Random(f"varying {seed}"), carried=kept > 0)
        joints = tables["joints"]
        tables |= {"joints": joints | {f"{TWIN}{name}": joints[name] for name in twin}}
        with more_joints():
            scene = derive.scene(f"graph_{seed}", **(_with_ports(tables, seed % 2 == 1) if ports else tables))
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
        first = _constrained_mass(mechanism.expanded(), form["proximal"])
        if not _well_posed(first, _state(first, scene, np.random.default_rng(seed)), redundant):
            return None
        flat = lower_flat(mechanism.expanded(), **form)
    except DependentConstraints:
        return None
    state = _state(flat, scene, np.random.default_rng(seed))
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


# ---- shapes: the edges of a spanning tree, and those that close loops ----


def _chain(draws: random.Random, most: int) -> tuple[int, Edges, Edges]:
    count = draws.randint(1, most)
    return count, [(k, k + 1) for k in range(count - 1)], [(GROUND, count - 1)] if draws.random() < 0.4 else []


def _tree(draws: random.Random, most: int) -> tuple[int, Edges, Edges]:
    count = draws.randint(3, most)
    return count, [(draws.randrange(k), k) for k in range(1, count)], [(GROUND, draws.randrange(count))]


def _star(draws: random.Random, most: int) -> tuple[int, Edges, Edges]:
    count = draws.randint(4, most)
    return count, [(0, k) for k in range(1, count)], [(GROUND, k) for k in range(1, count) if draws.random() < 0.3]


def _ring(draws: random.Random, most: int) -> tuple[int, Edges, Edges]:
    count = draws.randint(2, most)
    return count, [(k, k + 1) for k in range(count - 1)], [(count - 1, 0)]


def _grid(draws: random.Random, most: int) -> tuple[int, Edges, Edges]:
    rows, columns = 2, draws.randint(2, max(2, most // 2))
    along = [(i * columns + j, i * columns + j + 1) for i in range(rows) for j in range(columns - 1)]
    down = [(i * columns + j, (i + 1) * columns + j) for i in range(rows - 1) for j in range(columns)]
    return rows * columns, along + down[::columns], [e for k, e in enumerate(down) if k % columns]


def _any(draws: random.Random, most: int) -> tuple[int, Edges, Edges]:
    count = draws.randint(3, most)
    pairs = [(i, j) for j in range(count) for i in (GROUND, *range(j))]
    return count, [(draws.randrange(k), k) for k in range(1, count)], draws.sample(pairs, 3)


Shape = Callable[[random.Random, int], tuple[int, Edges, Edges]]
SHAPES: tuple[Shape, ...] = (_chain, _tree, _star, _ring, _grid, _any)


# ---- bodies and joints ----


def _scene(shape: Shape, draws: random.Random, most: int, kept: float) -> dict[str, Any]:
    """The tables of a scene."""
    count, tree, closing = shape(draws, most)
    kinds = [_kind(draws) for _ in range(draws.randint(1, 3))]
    loops = bool(closing)
    regular = draws.random() < 0.7  # bodies of one kind between like markers, so that classes have several members
    if regular or (loops and draws.random() < 0.7):
        kinds = [_beam_kind(draws) if loops else _kind(draws)]
    spread = draws.choice((0.0, 1.0, 3.0))
    bodies = {f"body_{k}": draws.choice(kinds)(spread) for k in range(count)}
    fixed = [(GROUND, k) for k in range(count) if draws.random() < 0.2] or [(GROUND, draws.randrange(count))]
    if shape is _chain:
        fixed = [(GROUND, 0)]
    edges = [*fixed[:1], *tree] if draws.random() < 0.85 else list(tree)
    closing = draws.sample([*closing, *fixed[1:]], k=round(kept * len([*closing, *fixed[1:]])))
    weld = draws.choice((0.0, 1.0) if regular else (0.0, 0.3, 1.0))
    joints: list[dict[str, Any]] = [_joint(edge, draws, weld, regular) for edge in edges]
    joints += [_joint(edge, draws, 0.15, regular) for edge in closing]
    if draws.random() < 0.5:
        draws.shuffle(joints)
    gravity = draws.choice(([0, -9.81], ["1/3", 2], None))
    return {
        "ground": {f"at_{k}": [_rounded(draws.uniform(-2, 2)), _rounded(draws.uniform(-2, 2))] for k in range(3)},
        "gravity": gravity,
        "bodies": bodies,
        "joints": {f"joint_{k}": joint for k, joint in enumerate(joints)},
    }


def _in_pieces(bodies: dict[str, Any], draws: random.Random) -> dict[str, Any]:
    """Bodies of which some beams are cut into pieces; in half of the scenes all are, and into equally many."""
    beams = [name for name, body in bodies.items() if "length" in body]
    if draws.random() < 0.5:
        counts = dict.fromkeys(beams, draws.choice((2, 3)))
    else:
        counts = {name: draws.choice((1, 2, 3)) for name in beams} | dict.fromkeys(beams[:1], 2)
    damping = draws.choice(({}, {"damping": {"mass": 0.3, "stiffness": 0.001}}))
    loaded = draws.random() < 0.3
    load = {"loads": {"wind": {"force": [0, _rounded(draws.uniform(1, 5))]}}} if loaded else {}
    return {n: body | ({"pieces": counts[n]} | damping | load if n in counts else {}) for n, body in bodies.items()}


def _with_ports(tables: dict[str, Any], sums: bool) -> dict[str, Any]:
    """A scene in which numbers are parameters, equal ones the same, with an input, springs, a drive and outputs.

    sums: whether energies and powers are among the outputs.
    """
    symbols: dict[tuple[str, float], dict[str, Any]] = {}

    def parameter(name: str, value: float) -> dict[str, Any]:
        return symbols.setdefault((name, value), {"symbol": f"{name}_{len(symbols)}", "default": value})

    numbers = ("mass", "length", "bending_stiffness")
    bodies = {
        name: body | {key: parameter(key, body[key]) for key in numbers if key in body}
        for name, body in tables["bodies"].items()
    }
    ground = tables["ground"] | {"at_0": [parameter("x", 0.5), 0.25]}
    first, *_, last = [*bodies, *bodies]
    joint = next(iter(tables["joints"]), "")  # none where those that close loops are all
    unit = {"revolute": "rad", "translational": "m"}.get(tables["joints"][joint]["kind"], "") if joint else ""
    driven = bool(unit)
    across = [f"{first}.left", f"{last}.right"]
    if any({*other["between"]} == {*across} for other in tables["joints"].values()):  # a joint holds both at one place
        across = [f"{first}.left", f"{last}.left"]
    pushed = {"push": {"at": f"{last}.left", "components": [{"input": "push"}, "sin(2*t)"]}}
    return tables | {
        "bodies": bodies,
        "ground": ground,
        "inputs": {"push": {"unit": "N", "value": 0.7}, **({"turn": {"unit": unit, "value": 0}} if driven else {})},
        "forces": tables.get("forces", {}) | pushed,
        "springs": tables.get("springs", {})
        | {
            "held": {"between": ["ground.at_0", f"{last}.right"], "stiffness": parameter("stiffness", 3.0)},
            **({"between": {"between": across, "stiffness": 2.0}} if first != last else {}),
        },
        "drives": tables.get("drives", {})
        | ({"motor": {"joint": joint, "motion": {"input": "turn"}}} if driven else {}),
        "outputs": {
            "place": {"kind": "position", "marker": f"{last}.right"},
            **({"pull": {"kind": "reaction", "joint": joint}} if joint else {}),
            **({"energies": {"kind": "energy"}, "powers": {"kind": "power"}} if sums else {}),
        },
    }


def _rounded(value: float) -> float:
    return float(f"{value:.4g}")


def _kind(draws: random.Random) -> Callable[[float], dict[str, Any]]:
    return _rigid_kind(draws) if draws.random() < 0.3 else _beam_kind(draws)


def _rigid_kind(draws: random.Random) -> Callable[[float], dict[str, Any]]:
    centred = draws.random() < 0.5

    def body(spread: float) -> dict[str, Any]:
        mass = 10 ** draws.uniform(-spread, spread)
        return {
            "mass": _rounded(mass),
            "inertia": _rounded(mass * draws.uniform(0.02, 0.2)),
            **({} if centred else {"centre": [_rounded(draws.uniform(-0.3, 0.3)), 0.1]}),
            "keep_coordinates": True,
            "markers": {
                name: [_rounded(draws.uniform(-0.8, 0.8)), _rounded(draws.uniform(-0.4, 0.4))]
                for name in ("left", "right", "inner")
            },
        }

    return body


def _beam_kind(draws: random.Random) -> Callable[[float], dict[str, Any]]:
    frame = draws.choice(("mean", "mean", "chord", {"kind": "point", "at": draws.choice((0, "1/2"))}, "tangent"))
    if frame == "tangent":
        frame = {"kind": "tangent", "at": draws.choice((-1, 1))}
    shapes, order = draws.choice(((1, 1), (2, 1), (2, 1), (3, 1), (4, 1), (1, 2), (2, 2)))
    damping = draws.choice((None, None, {"mass": 0.3, "stiffness": 0.001}))
    same, inner = draws.random() < 0.3, _rounded(draws.uniform(-0.8, 0.8))

    def numbers(spread: float) -> dict[str, Any]:
        return {
            "mass": _rounded(10 ** draws.uniform(-spread, spread)),
            "length": _rounded(draws.uniform(0.4, 2)),
            "bending_stiffness": _rounded(10 ** draws.uniform(-1, 2)),
            "markers": {"left": -1, "right": 1, "inner": inner},
        }

    first = numbers(0.5)

    def body(spread: float) -> dict[str, Any]:
        return {
            "ansatz": [f"xi^{power}" for power in range(shapes + 2)],
            "frame": frame,
            "order": order,
            **({} if damping is None else {"damping": damping}),
            **(first if same else numbers(spread)),
        }

    return body


def _joint(edge: tuple[int, int], draws: random.Random, weld: float, regular: bool) -> dict[str, Any]:
    def marker(body: int, names: tuple[str, ...]) -> str:
        return f"ground.at_{draws.randrange(3)}" if body == GROUND else f"body_{body}.{draws.choice(names)}"

    inner = () if regular else ("inner",)
    between = [marker(edge[0], ("right", *inner)), marker(edge[1], ("left", *inner))]
    if draws.random() < 0.4 and not regular:
        between.reverse()
    if draws.random() < weld:
        return {
            "kind": "weld",
            "between": between,
            "angle": 0.3 if regular else _rounded(draws.choice((0.0, draws.uniform(-1, 1)))),
        }
    return {"kind": "revolute", "between": between}


# ---- states ----


def _state(model: Model, scene: derive.Scene, rng: np.random.Generator) -> dict[str, Any]:
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


def _constrained_mass(equations: Equations, proximal: bool) -> Model:
    """The model with the functions of M and G alone, a small part of the work: many graphs are rejected by these."""
    kinds = (FunctionKind.MASS, FunctionKind.CONSTRAINT_JACOBIAN)

    def functions(*of: Any) -> list[ModelFunction]:
        return [function for function in functions_of(*of) if function.kind in kinds]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("derive.lowering.flat.lower.functions_of", functions)
        return lower_flat(equations, proximal=proximal)


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
