"""Scenes with joints whose constraints depend on both of their bodies at once, and with a body whose motion is known.

Their axes move with a body, as those of translational joints and of screws, or they remove a function of several
relative motions, as rods without mass and screws do.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import sympy as sp

import derive
import derive.extensions as ext

DISTANCE = ext.Key("distance", ext.KeyType.POSITIVE_QUANTITY, "m", "The distance, m.", required=True)


def _elongation(joint: Any, displacement: sp.Matrix, rotation: sp.Expr) -> sp.Expr:
    length = joint.values["distance"]
    return (displacement.dot(displacement) - length**2) / (2 * length)


def _advance(joint: Any, displacement: sp.Matrix, rotation: sp.Expr) -> sp.Expr:
    return displacement[0] - rotation / 3 + rotation * displacement[1]


class Rod(ext.JointType):
    """A rod without mass: the distance of the markers is constant."""

    doc = "the distance of the markers is constant"
    removes = (ext.RelativeRow("tension", "{markers} keep their distance", "m", _elongation, (DISTANCE,)),)
    drawing = ext.Drawing(lines=(((-1, -2), (1, 2)),))


class Cam(ext.JointType):
    """A cam: a displacement along an axis of the first body follows the rotation and the displacement across."""

    doc = "the displacement along an axis follows the rotation"
    axes = ext.Axes.OF_BODY_1
    removes = (ext.RelativeRow("advance", "{second} follows {joint}", "m", _advance),)
    driven = ext.NORMAL_TO_AXIS
    drawing = ext.Drawing(guide=True)


@contextmanager
def more_joints() -> Iterator[None]:
    """Register the joints of this module."""
    derive.JOINTS.register("rod", Rod())
    derive.JOINTS.register("cam", Cam())
    try:
        yield
    finally:
        derive.JOINTS.unregister("cam")
        derive.JOINTS.unregister("rod")


def with_varying_joints(tables: dict[str, Any], draws: random.Random, carried: bool) -> dict[str, Any]:
    """A scene of beams and rigid bodies with such joints in place of some.

    A spring acts between points of the ground; there may be a body that a drive moves, on which forces act. carried:
    whether such a body may have a joint with another one.
    """
    bodies = dict(tables["bodies"])
    if draws.random() < 0.7:
        bodies |= {name: _rigid(draws) for name in bodies if draws.random() < 0.5}
    rigid = {"ground", "carrier", *(name for name, body in bodies.items() if "inertia" in body)}
    joints = {
        name: _varying(joint["between"], rigid, draws) if draws.random() < 0.6 else joint
        for name, joint in tables["joints"].items()
    }
    springs = tables.get("springs", {}) | {
        "stretched": {"between": ["ground.at_0", "ground.at_2"], "stiffness": 2, "rest": 9}  # longer than any
    }
    result = tables | {"bodies": bodies, "joints": joints, "springs": springs}
    if draws.random() < 0.5:
        carrier = {key: value for key, value in _rigid(draws).items() if key != "keep_coordinates"}
        with_other = _varying(["carrier.right", f"{draws.choice(list(bodies))}.inner"], rigid, draws)
        result |= {
            "bodies": bodies | {"carrier": carrier},
            "joints": joints
            | {"bearing": {"kind": "revolute", "between": ["ground.at_1", "carrier.left"]}}
            | ({"carried": with_other} if carried else {}),
            "drives": tables.get("drives", {}) | {"turning": {"joint": "bearing", "motion": "0.2 + 0.4*sin(3*t)"}},
            "springs": springs | {"tied": {"between": ["ground.at_0", "carrier.right"], "stiffness": 2, "rest": 0.1}},
            "forces": tables.get("forces", {}) | {"pressed": {"at": "carrier.right", "components": [1, "t"]}},
        }
    return result


def _rigid(draws: random.Random) -> dict[str, Any]:
    return {
        "mass": draws.choice((0.5, 1, 2)),
        "inertia": draws.choice((0.1, 0.2)),
        "centre": [0.1, 0.05],
        "keep_coordinates": True,
        "markers": {"left": [-0.4, 0.1], "right": [0.5, 0.2], "inner": [0.1, -0.3]},
    }


def _varying(between: list[str], rigid: set[str], draws: random.Random) -> dict[str, Any]:
    """A joint between two markers, in either order."""
    ends = draws.sample(between, 2)
    first = next((end for end in ends if end.partition(".")[0] in rigid), None)
    if first is None or draws.random() < 0.3:
        return {"kind": "rod", "between": ends, "distance": draws.choice((0.5, 0.8))}
    ends.sort(key=lambda end: end != first)
    axis = draws.choice(([1, 0], [3, 4], [-1, 2]))
    if draws.random() < 0.3:
        return {"kind": "cam", "between": ends, "axis": axis}
    return {"kind": "translational", "between": ends, "axis": axis, "angle": draws.choice((0, 0.3))}
