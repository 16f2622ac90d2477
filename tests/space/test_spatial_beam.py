"""Beams in space in motion: planar motion as that of the planar beam, and rotating cantilevers."""

from __future__ import annotations

import json
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rods_in_space import FRAMES, PLANAR_ROD, SHAPES, accelerations

import derive

DATA = Path(__file__).parents[1] / "second_order" / "rotating_cantilever.json"
KNOWN = json.loads(DATA.read_text())["inextensible"]
"""The frequencies of a rotating cantilever in units of sqrt(EI/(m l^3))."""
OTHERS = {"rotary_inertia": "1/1000", "torsion": {"ansatz": ["xi"], "stiffness": 7}, "markers": {"left": {"at": -1}}}


ORDERS: dict[str, Any] = {"first": {}} | {terms: {"order": 2, "terms": terms} for terms in ("truncated", "full")}


@pytest.mark.parametrize(
    ("order", "frame"),
    [("truncated", "chord"), *(pytest.param(*case, marks=pytest.mark.long) for case in product(ORDERS, FRAMES))],
)
def test_motion_in_a_plane_is_that_of_the_planar_beam(order: str, frame: Any) -> None:
    """A pendulum that bends, stretches and swings in a plane has the accelerations of the planar beam."""
    rod = PLANAR_ROD | {"ansatz": SHAPES, "frame": frame} | ORDERS[order]
    planar = rod | {"markers": {"left": -1}}
    hinge = {"h": {"kind": "revolute", "between": ["ground.o", "rod.left"]}}
    joint = derive.Joint("h", "revolute", derive.MarkerRef("ground", "o"), derive.MarkerRef("rod", "left"))
    gravity = (0, "-9.81")
    plane = derive.scene("plane", ground={"o": (0, 0)}, gravity=gravity, bodies={"rod": planar}, joints=[joint])
    space = derive.spatial_scene(
        "space", ground={"o": (0, 0, 0)}, gravity=(*gravity, 0), bodies={"rod": rod | OTHERS}, joints=hinge
    )
    rng = np.random.default_rng(1)
    c, alpha, cdot, alphadot = (size * rng.normal(size=n) for size, n in ((1, 2), (0.01, 4), (1, 2), (0.3, 4)))
    half, none = 0.35, np.zeros(4)
    ours = accelerations(plane, np.r_[c, 2 * half, alpha], np.r_[cdot, 2.0, alphadot])
    quaternion = [np.cos(half), 0, 0, np.sin(half)]
    q = np.r_[c, 0, quaternion, alpha[:3], none, alpha[3]]
    v = np.r_[cdot, 0, 0, 0, 2.0, alphadot[:3], none, alphadot[3]]
    both = accelerations(space, q, v)
    in_plane = np.r_[both[:2], both[5:9], both[13]]
    limit = 1e-12 if "tangent" in str(frame) else 2e-13  # M of a tangent frame is ill-conditioned
    assert np.abs(in_plane - ours).max() < limit * np.abs(ours).max()
    assert not np.any(np.r_[both[2:5], both[9:13]])


# ---- loads and rotation


def cantilever(order: int = 2, **changes: Any) -> derive.SpatialScene:
    """A cantilever of unit length, mass and lateral stiffness, clamped at its left end."""
    rod: dict[str, Any] = {
        "length": 1,
        "mass": 1,
        "bending_stiffness": 1,
        "rotary_inertia": "1/100000",
        "torsion": {"ansatz": ["xi"], "stiffness": 1},
        "frame": {"kind": "tangent", "at": -1},
        "ansatz": [f"xi^{power}" for power in range(6)],
        "order": order,
        "markers": {"left": -1, "right": 1},
    }
    given = {
        "ground": {"root": (0, 0, 0)},
        "joints": {"root": {"kind": "fixed", "between": ["ground.root", "rod.left"]}},
    }
    given |= {key: changes.pop(key) for key in tuple(changes) if key in SECTIONS}
    bodies = {"rod": rod | changes, **given.pop("others", {})}
    return derive.spatial_scene("cantilever", bodies=bodies, **given)


SECTIONS = ("ground", "joints", "forces", "drives", "others", "start")


@pytest.mark.long
@pytest.mark.parametrize("number", [1, 3])
def test_rotating_cantilever(number: int) -> None:
    """The first frequencies of a rotating cantilever in lag and in flap are those of an inextensible beam."""
    spin = KNOWN["mu"][number]
    shaft = {"markers": {"hub": (0, 0, 0), "root": (0, 0, 0)}}
    scene = cantilever(
        others={"shaft": shaft},
        ground={"hub": (0, 0, 0)},
        joints={
            "hub": {"kind": "revolute", "between": ["ground.hub", "shaft.hub"]},
            "root": {"kind": "fixed", "between": ["shaft.root", "rod.left"]},
        },
        drives={"spin": {"joint": "hub", "speed": spin}},
        start="steady",
    )
    found = sorted(abs(mode.eigenvalue.imag) for mode in derive.modes(scene).modes)[:2]
    assert found == pytest.approx([KNOWN["chordwise"][number], KNOWN["flapwise"][number]], rel=5e-4)
