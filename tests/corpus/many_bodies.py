"""Scenes of eight to twenty bodies: chains, rings, stars and ladders, with `count` and formulas in the index."""

from __future__ import annotations

import math

from corpus.draft import Table
from corpus.draws import Draws, rounded

SHARE = 0.04
"""The share of scenes with many bodies."""


def many_bodies(draws: Draws, name: str) -> tuple[Table, str]:
    """The tables of a scene, and the name of its linkage."""
    linkage = draws.choice([*LINKAGES])
    length = rounded(draws.scale(0.15, 1), 2)
    tables: Table = {"name": name, "ground": {"markers": {"o": [0, 0]}}, "scene": {"gravity": [0, -9.81]}}
    LINKAGES[linkage](draws, tables, length)
    bodies = tables["bodies"]
    if draws.chance(0.4):
        tables["springs"] = {"hinge": _springs(draws, tables)}
    if draws.chance(0.4):
        tables["forces"] = {"load": {"at": "link[1].right", "components": [0.1, "0.2*sin(20*t)"]}}
    if draws.chance(0.4):
        tables["outputs"] = {"end": {"kind": "position", "marker": "link[i].right", "count": bodies["link"]["count"]}}
    duration = rounded(0.05 * math.sqrt(length), 2)
    tables["simulation"] = {"duration": duration, "output": rounded(duration / 10, 2)}
    return tables, linkage


def _link(draws: Draws, length: float, count: int) -> Table:
    """Rods that are rigid or flexible, all alike or with masses that increase."""
    mass = rounded(length * draws.scale(0.2, 3), 3)
    table: Table = {"count": count, "mass": draws.choice([mass, f"{mass}*(1 + i/10)"])}
    if draws.chance(0.3):
        half = length / 2
        inertia = rounded(mass * length**2 / 12, 3)
        return table | {
            "inertia": inertia,
            "markers": {"left": [-half, 0], "right": [half, 0]},
            "keep_coordinates": True,
        }
    shapes = draws.whole(1, 3)
    table["ansatz"] = draws.choice([["xi^2 - 1/3"], [f"xi^{power}" for power in range(shapes + 2)]])
    stiffness = rounded(9.81 * mass * length**2 * count * draws.between(20, 60), 3)
    table |= {"length": length, "bending_stiffness": stiffness, "markers": {"left": -1, "right": 1}}
    if draws.chance(0.4):
        table["damping"] = {"stiffness": 1e-4}
    return table


def _springs(draws: Draws, tables: Table) -> Table:
    """Rotational springs between neighbours."""
    stiffness = rounded(draws.scale(0.1, 3), 2)
    between = ["link[i].right", "link[i+1].left"]
    table: Table = {"kind": "rotational", "count": tables["bodies"]["link"]["count"] - 1, "between": between}
    return table | {"stiffness": f"{stiffness}*(1 + i)", "damping": draws.choice([0, 0.01])}


def _pins(kind: str, count: int, first: str, second: str) -> Table:
    return {"kind": kind, "count": count, "between": [first, second]}


def _chain(draws: Draws, tables: Table, length: float) -> None:
    """Rods in a row that hang from the ground."""
    count = draws.whole(8, 16)
    kind = draws.choice(["revolute", "weld"])
    start = {"position": [f"{length / 2} + {length}*i", 0]}
    tables["bodies"] = {"link": _link(draws, length, count) | {"start": start}}
    root = {"kind": "revolute", "between": ["ground.o", "link[0].left"]}
    tables["joints"] = {"root": root, "joint": _pins(kind, count - 1, "link[i].right", "link[i+1].left")}


def _ring(draws: Draws, tables: Table, length: float) -> None:
    """Rods along a polygon, of which the first is pinned to the ground."""
    count = draws.whole(8, 12)
    middle, angle = f"{2 * math.pi / count:.12g}*i", math.pi / count
    radius = f"{length / 2 / math.tan(angle):.12g}"
    start = {"position": [f"{radius}*sin({middle})", f"-{radius}*cos({middle})"], "angle": middle}
    tables["bodies"] = {"link": _link(draws, length, count) | {"start": start}}
    tables["ground"]["markers"]["o"] = [rounded(-length / 2, 6), -float(radius)]
    tables["joints"] = {
        "root": {"kind": "revolute", "between": ["ground.o", "link[0].left"]},
        "joint": _pins("revolute", count - 1, "link[i].right", "link[i+1].left"),
        "last": {"kind": "revolute", "between": [f"link[{count - 1}].right", "link[0].left"]},
    }


def _star(draws: Draws, tables: Table, length: float) -> None:
    """Rods around a hub that is pinned to the ground."""
    count = draws.whole(7, 12)
    angle = f"{2 * math.pi / count:.12g}*i"
    start = {"position": [f"{length / 2}*cos({angle})", f"{length / 2}*sin({angle})"], "angle": angle}
    hub = {"mass": 1, "inertia": 0.1, "markers": {"centre": [0, 0]}, "keep_coordinates": True}
    tables["bodies"] = {"hub": hub, "link": _link(draws, length, count) | {"start": start}}
    root = {"kind": "revolute", "between": ["ground.o", "hub.centre"]}
    tables["joints"] = {"root": root, "joint": _pins("revolute", count, "hub.centre", "link[i].left")}


def _ladder(draws: Draws, tables: Table, length: float) -> None:
    """Two rows of rods that hang from the ground, with rungs between their ends."""
    count = draws.whole(3, 5)
    link = _link(draws, length, count)
    down = [f"-{length / 2} - {length}*i"]
    tables["ground"]["markers"]["right"] = [length, 0]
    tables["bodies"] = {
        "link": link | {"start": {"position": [0, *down], "angle": -math.pi / 2}},
        "other": link | {"start": {"position": [length, *down], "angle": -math.pi / 2}},
        "rung": link | {"start": {"position": [length / 2, f"-{length}*(i + 1)"]}},
    }
    tables["joints"] = {
        "left": {"kind": "revolute", "between": ["ground.o", "link[0].left"]},
        "right": {"kind": "revolute", "between": ["ground.right", "other[0].left"]},
        "joint": _pins("revolute", count - 1, "link[i].right", "link[i+1].left"),
        "other_joint": _pins("revolute", count - 1, "other[i].right", "other[i+1].left"),
        "near": _pins("revolute", count, "link[i].right", "rung[i].left"),
        "far": _pins("revolute", count, "other[i].right", "rung[i].right"),
    }


LINKAGES = {"chain": _chain, "ring": _ring, "star": _star, "ladder": _ladder}
"""The linkages of many bodies."""
