"""Beams in space in which a monitor decides that the random corpus hardly reaches.

Cantilevers near lateral buckling: a force bends them in their stiff plane, and a small one disturbs them in the weak
one. Free beams with lost inertia: forces at an end bend them so far that the truncated kinetic energy in a frame at the
other end is nearly indefinite. Each has three stiffnesses, as the scenes of `spatial_monitor_scenes.py`.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from spatial_monitor_scenes import RandomScene

from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.toml.read import parse
from derive.study.accuracy.ladder_model import ORDERS, LadderModel, Shapes

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from corpus.draws import Draws

FIRST, TRUNCATED = ORDERS["first"], ORDERS["truncated"]
POLYNOMIALS = Shapes.POLYNOMIALS
SOFTER = (3.0, 1.5, 1.0)
"""The stiffnesses over the least."""
BUCKLING = 4.013
"""The load of lateral buckling over sqrt(EI GJ) / length^2."""
MODELS = {
    "buckling": (
        LadderModel(POLYNOMIALS, 4, FIRST, "tangent", torsion=3),
        LadderModel(POLYNOMIALS, 3, FIRST, torsion=2),
    ),
    "inertia": (
        LadderModel(POLYNOMIALS, 5, TRUNCATED, "tangent", torsion=1),
        LadderModel(POLYNOMIALS, 6, TRUNCATED, "tangent", torsion=1),
    ),
}
"""Each scene has one of its kind, in turn."""
SCENE = """
name = "{name}"
[bodies.beam]
length = 1
mass = {mass}
rotary_inertia = {rotary}
bending_stiffness = 1
ansatz = ["1", "xi", "xi^2", "xi^3", "xi^4"]
torsion = {{ ansatz = ["xi"], stiffness = 1 }}
damping = {{ ratio = {damping} }}
markers = {{ root = -1, tip = 1 }}
start = {{ position = [0.5, 0, 0] }}
[forces.load]
at = "beam.tip"
force = [0, "{along}", "{across}"]
[simulation]
duration = 1
output = 0.01
"""
CLAMP = """
[ground.markers]
wall = [0, 0, 0]
[joints.clamp]
kind = "fixed"
between = ["ground.wall", "beam.root"]
"""


def composed_scene(kind: str, seed: int) -> RandomScene:
    """The scene of a kind from a seed."""
    draws = Draws(f"{kind} {seed}")
    mass, twist = draws.scale(0.5, 2), draws.between(0.4, 1.0)
    if kind == "buckling":
        weak, strong, torsion = 1.0, draws.scale(40, 200), twist
        load = draws.between(0.2, 0.9) * BUCKLING * np.sqrt(weak * torsion)
        disturbance, lowest = load * draws.scale(3e-4, 3e-3), 3.516 * np.sqrt(weak / mass)
    else:
        weak, torsion = 1.0, 50 * twist
        strong, load = weak * draws.between(1, 1.5), draws.between(0.2, 0.5)
        disturbance, lowest = load * draws.between(0.2, 0.8), 22.37 * np.sqrt(weak / mass)
    rates = [draws.between(0.1, 0.6) * lowest for _ in range(2)]
    along, across = (f"{f:.6g}*sin({w:.4g}*t)" for f, w in zip((load, disturbance), rates, strict=True))
    text = SCENE.format(
        name=f"{kind}_{seed}",
        mass=f"{mass:.4g}",
        rotary=f"{1e-4 * mass:.4g}",
        damping=f"{draws.between(0, 0.02):.3g}",
        along=along,
        across=across,
    )
    scene = parse(text + (CLAMP if kind == "buckling" else ""))
    assert isinstance(scene, SpatialScene)
    stiffnesses = tuple((strong * s, weak * s, torsion * s) for s in SOFTER)
    return RandomScene(seed, scene, stiffnesses, draws.between(3, 8))


def composed_scenes(kind: str, seeds: range) -> Iterator[tuple[RandomScene, LadderModel]]:
    """The scenes of a kind, each with its model."""
    models = MODELS[kind]
    return ((composed_scene(kind, seed), models[seed % len(models)]) for seed in seeds)
