"""The motion of marker frames with places on links in a loop, from the arrays of these links."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from derive.lowering.trees.link_loop import LinkLoop
from derive.lowering.trees.links import BodyPlace
from derive.lowering.trees.motion import FRAME, ORIGIN, SPEED, SPIN, matrix
from derive.lowering.vectors import applied, cross, plus, product

CARRIED = "carried"
"""The array of accelerations of links without those of coordinates."""


def frame_motion(
    loop: LinkLoop, name: str, places: Sequence[BodyPlace], moving: bool, biased: bool = False
) -> dict[str, list[ca.SX]]:
    """The vectors of the motion of a frame, of each iteration at one of `places`, and its axes by rows.

    moving: with velocities; biased: with the accelerations that the coordinates do not change. The lever from the
    origin of the link is in the inertial frame.
    """
    slot = loop.place(name, [loop.arrays.slot(of.link) for of in places], loop.arrays.spacing)
    Q = matrix(loop.vector(FRAME, slot, 9))
    lever = applied(Q, [loop.column([of.origin[k] for of in places]) for k in range(3)])
    attitude = [[loop.column([of.attitude[i][j] for of in places]) for j in range(3)] for i in range(3)]
    result = {
        "lever": lever,
        "position": plus(loop.vector(ORIGIN, slot), lever),
        "axes": [x for row in product(Q, attitude) for x in row],
    }
    if moving:
        w = loop.vector(SPIN, slot)
        turned = cross(w, lever)
        result |= {"angular_velocity": w, "velocity": plus(loop.vector(SPEED, slot), turned)}
    if biased:
        alpha = loop.vector(CARRIED, slot, first=3)
        a = plus(loop.vector(CARRIED, slot), cross(alpha, lever), cross(w, turned))
        result |= {"angular_acceleration": alpha, "acceleration": a}
    return result
