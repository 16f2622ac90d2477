"""Markers: named points of bodies and of the ground, and references to them."""

from __future__ import annotations

from dataclasses import dataclass

from derive.short_text import record_text
from derive.spec.model.quantity import Quantity

GROUND = "ground"
"""The name by which joints and forces refer to the inertial frame."""


@dataclass(frozen=True)
class PointMarker:
    """A named material point of a rigid body or of the ground, with its coordinates in the frame of that body.

    Attributes:
        name: the name of the marker.
        x: m, a number or a parameter.
        y: m, a number or a parameter.

    Examples:
        >>> import derive
        >>> points = [derive.PointMarker("o", 0, 0), derive.PointMarker("wall", 2, "1/2")]
        >>> derive.scene("room", ground=points, bodies={"ball": {"mass": 1, "inertia": 1}}).ground[1].y
        Fraction(1, 2)
    """

    name: str
    x: Quantity
    y: Quantity
    __repr__ = record_text


@dataclass(frozen=True)
class MarkerRef:
    """A marker of a body, or of the ground; in tables a text such as "rod.left".

    Attributes:
        body: the name of the body, or "ground".
        marker: the name of the marker.

    Examples:
        >>> import derive
        >>> str(derive.MarkerRef("rod", "left"))
        'rod.left'
    """

    body: str
    marker: str

    def __str__(self) -> str:
        return f"{self.body}.{self.marker}"
