"""Numbers, vectors and rotations of robots as text: with all their digits, and without those of rounding errors."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from derive.urdf.robot import Matrix, Placement, Vector


def number_text(value: float) -> str:
    """A number with all its digits; a whole one without a point."""
    return str(int(value)) if value == int(value) and abs(value) < 1e15 else repr(float(value))


NOISE = 1e-14
"""The part of the largest number of an array below which the others are rounding errors of zero."""


def list_text(values: Iterable[float] | Vector) -> str:
    """Numbers as an array of TOML, without rounding errors of zeros."""
    numbers = [float(x) for x in values]
    least = NOISE * max(map(abs, numbers), default=0.0)
    return f"[{', '.join(number_text(x if abs(x) > least else 0.0) for x in numbers)}]"


def axes_text(rotation: Matrix) -> str:
    """A rotation by two axes of the frame."""
    return f"{{ x = {list_text(rotation[:, 0])}, z = {list_text(rotation[:, 2])} }}"


def frame_text(placement: Placement, axes: Matrix) -> str:
    """A marker: its point, and the rotation of its axes where there is one."""
    rotation = placement.rotation @ axes
    at = list_text(placement.position)
    return at if np.array_equal(rotation, np.eye(3)) else f"{{ at = {at}, rotation = {axes_text(rotation)} }}"


def axes_along(direction: Vector) -> Matrix:
    """A rotation matrix whose z axis has a direction: none for z itself, and no rounding for x and y."""
    if direction[2] == 1:
        return np.eye(3)
    across = np.eye(3)[(int(np.argmax(abs(direction))) + 1) % 3]
    x = across - (across @ direction) * direction
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(direction, x), direction])
