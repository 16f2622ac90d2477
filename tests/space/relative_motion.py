"""Relative motions of two marker frames: what joints remove, what they leave, and what drives prescribe.

d = A1^T (x2 - x1), R = A1^T A2 for the axes A1, A2 of the markers. Rotations are removed by products of axes that
vanish: each is the rotation about its axis where the frames are nearly parallel, and a single free axis stays parallel
for all rotations about it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from decimal import Decimal

import mpmath
import numpy as np
from decimal_vectors import ONE, Array, about, elementary, identity, zeros
from written_scene import Numbers, Table

MOTIONS = ("x", "y", "z", "rx", "ry", "rz")
REMOVED: Mapping[str, tuple[str, ...]] = {
    "fixed": MOTIONS,
    "revolute": ("x", "y", "z", "rx", "ry"),
    "prismatic": ("x", "y", "rx", "ry", "rz"),
    "cylindrical": ("x", "y", "rx", "ry"),
    "screw": ("x", "y", "rx", "ry"),
    "universal": ("x", "y", "z", "ry"),
    "planar": ("z", "rx", "ry"),
    "spherical": ("x", "y", "z"),
    "point_on_line": ("x", "y"),
}
"""The relative displacements and rotations that joints remove."""

WHOLE_TURN = elementary(lambda: 2 * mpmath.pi)
TWO_ROTATIONS = {"rx": ("rz", "ry"), "ry": ("rz", "rx"), "rz": ("ry", "rx")}
"""The rotations that are left where one is removed, in their order: the first one is about an axis of marker 1."""


def removed(table: Table) -> tuple[str, ...]:
    """The relative motions that a joint removes."""
    of = table["removes"] if table["kind"] == "general" else REMOVED[table["kind"]]
    return tuple(name for name in MOTIONS if name in of)


def free_motions(table: Table, sign: int) -> dict[str, str]:
    """The relative motions that a joint leaves, with the ends of the names of their coordinates, in their order.

    sign: 1 if the body that the joint places is the second one, else -1.
    """
    left = [name for name in MOTIONS if name not in removed(table)]
    displacements = [name for name in left if not name.startswith("r")]
    rotations = [name for name in left if name.startswith("r")]
    if len(rotations) == 2:
        (gone,) = {"rx", "ry", "rz"} - {*rotations}
        rotations = list(TWO_ROTATIONS[gone][::sign])
    result = {}
    for group, symbol in ((displacements, "s"), (rotations, "phi")):
        for name in group:
            result[name] = f"{symbol}{'xyz'.index(name[-1]) + 1}" if len(group) > 1 else symbol
    return result


def relative(values: Mapping[str, Decimal]) -> tuple[Array, Array]:
    """The displacement along the axes of the known marker, and the rotation about one axis after the other."""
    d, R = zeros(3), identity(3)
    for name, value in values.items():
        vector = zeros(3)
        vector["xyz".index(name[-1])] = value
        if name.startswith("r"):
            R = R @ about(vector)
        else:
            d = d + vector
    return d, R


def joint_rows(table: Table, d: Array, R: Array, value: Numbers, A1: Array) -> dict[str, Decimal]:
    """g of a joint, by row: a joint that removes all displacements has those along the inertial axes."""
    if table["kind"] == "distance":
        kept = value(table["distance"])
        return {"distance": (d @ d - kept * kept) / (2 * kept)}
    gone = removed(table)
    if {"x", "y", "z"} <= {*gone}:
        d = A1 @ d
    rows = {name: d[MOTIONS.index(name)] for name in gone if not name.startswith("r")}
    rows |= rotation_rows(R, [name for name in gone if name.startswith("r")])
    if table["kind"] == "screw":
        turn = value(table["pitch"]) / WHOLE_TURN
        rows["screw"] = without_turns(d[2] - turn * relative_angle(R), turn)
    return rows


def without_turns(x: Decimal, turn: Decimal) -> Decimal:
    """The number next to zero among x and what whole turns, of `turn` for each rad, make of it."""
    period = abs(turn) * WHOLE_TURN
    return x - period * (x / period).to_integral_value()


def gear_turn(ratio: Decimal, teeth: int, counted: tuple[bool, bool]) -> Decimal | None:
    """The change of g of a gear by whole turns, for each rad; None where both of its motions count them.

    teeth: the denominator of the ratio in lowest terms.
    """
    match counted:
        case True, True:
            return None
        case True, False:
            return ONE
        case False, True:
            return ratio
    return ONE / teeth


def coupled(table: Table) -> str:
    """The relative motion of a joint that a gear couples: the rotation about z, or of a prismatic joint z."""
    return "rz" if "rz" not in removed(table) else "z"


def rotation_rows(R: Array, gone: Sequence[str]) -> dict[str, Decimal]:
    """g of the relative rotations that a joint removes."""
    zy, yz, zx, xz, yx, xy = R[2, 1], -R[1, 2], -R[2, 0], R[0, 2], R[1, 0], -R[0, 1]  # z1 . y2, - y1 . z2, ...
    match tuple(gone):
        case ("rx", "ry"):  # z2 is normal to x1 and y1
            values = [yz, xz]
        case ("rx", "rz"):  # y2 is normal to x1 and z1
            values = [zy, xy]
        case ("ry", "rz"):  # x2 is normal to y1 and z1
            values = [zx, yx]
        case ("rx", "ry", "rz"):
            values = [zy, xz, yx]
        case _:
            values = [{"rx": zy, "ry": zx, "rz": yx}[name] for name in gone]
    return dict(zip(gone, values, strict=True))


def driven_row(table: Table, d: Array, R: Array, motion: Decimal) -> Decimal:
    """g of a drive: the displacement less the prescribed one, or the sine of the angle less the prescribed one."""
    if coupled(table) == "rz":
        return R[1, 0] * elementary(mpmath.cos, motion) - R[0, 0] * elementary(mpmath.sin, motion)
    return d[2] - motion


def relative_angle(R: Array) -> Decimal:
    """The angle about z between the x axes."""
    return elementary(mpmath.atan2, R[1, 0], R[0, 0])


def axial(R: Array) -> Array:
    """The axial vector of R: for small rotations, those about the three axes."""
    return np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]], dtype=object) / 2
