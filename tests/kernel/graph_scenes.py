"""The tables of random scenes in the plane: graphs of beams and rigid bodies in any order, with ports if wanted."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

Edges = list[tuple[int, int]]
GROUND = -1

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


def scene_tables(shape: Shape, draws: random.Random, most: int, kept: float) -> dict[str, Any]:
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


def in_pieces(bodies: dict[str, Any], draws: random.Random) -> dict[str, Any]:
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


def with_ports(tables: dict[str, Any], sums: bool) -> dict[str, Any]:
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
