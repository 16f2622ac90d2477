"""Relative motions of two marker frames: what joints remove, what they leave, and what drives prescribe.

d = A1^T (x2 - x1), R = A1^T A2 for the axes A1, A2 of the markers.
"""

from __future__ import annotations

from collections.abc import Mapping
from decimal import Decimal
from typing import Any

import mpmath
import numpy as np
from decimal_vectors import ZERO, Array, about, elementary, identity, length, zeros
from written_scene import Numbers, Table

FREE_MOTIONS: Mapping[str, tuple[str, ...]] = {
    "fixed": (),
    "revolute": ("phi",),
    "prismatic": ("s",),
    "cylindrical": ("s", "phi"),
    "planar": ("x", "y", "phi"),
    "universal": ("phi1", "phi2"),
    "spherical": ("rotation",),
}
"""The coordinates that remain of a body which a joint places."""

REMOVED: Mapping[str, tuple[str, ...]] = {
    "fixed": ("x", "y", "z", "rx", "ry", "rz"),
    "revolute": ("x", "y", "z", "rx", "ry"),
    "prismatic": ("x", "y", "rx", "ry", "rz"),
    "cylindrical": ("x", "y", "rx", "ry"),
    "planar": ("z", "rx", "ry"),
    "spherical": ("x", "y", "z"),
    "point_on_line": ("x", "y"),
}
"""The relative displacements and rotations that joints remove."""


def relative(coordinates: Mapping[str, Any]) -> tuple[Array, Array]:
    """d and R of the coordinates that a joint leaves."""
    d, R = zeros(3), identity(3)
    for name, value in coordinates.items():
        match name:
            case "phi" | "phi1":
                R = R @ about(np.array([ZERO, ZERO, value]))
            case "phi2":
                R = R @ about(np.array([value, ZERO, ZERO]))
            case "rotation":
                R = value
            case "x" | "y" | "s":
                d["xys".index(name)] = value
    return d, R


def joint_rows(table: Table, d: Array, R: Array, value: Numbers) -> dict[str, Decimal]:
    """g of a joint, by row."""
    kind = table["kind"]
    if kind == "distance":
        return {"distance": length(d) - value(table["distance"])}
    if kind == "universal":
        return {"x": d[0], "y": d[1], "z": d[2], "rz": R[2, 0]}  # z of marker 1 by x of marker 2
    removed = tuple(table["removes"]) if kind == "general" else REMOVED[kind]
    rows = {name: d[k] for k, name in enumerate("xyz") if name in removed}
    return rows | rotation_rows(R, tuple(name for name in ("rx", "ry", "rz") if name in removed))


def rotation_rows(R: Array, removed: tuple[str, ...]) -> dict[str, Decimal]:
    """g of the relative rotations that a joint removes."""
    axial = {"rx": R[2, 1] - R[1, 2], "ry": R[0, 2] - R[2, 0], "rz": R[1, 0] - R[0, 1]}
    return {name: axial[name] / 2 for name in removed}


def driven_value(table: Table, d: Array, R: Array) -> Decimal:
    """The angle or the displacement that a drive of a joint prescribes."""
    if table["kind"] == "revolute":
        return elementary(mpmath.atan2, R[1, 0], R[0, 0])
    return d[2]
