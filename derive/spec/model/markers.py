"""Markers: named points of bodies and of the ground, and references to them."""

from __future__ import annotations

from dataclasses import dataclass

from derive.short_text import record_text
from derive.spec.model.quantity import Quantity

GROUND = "ground"
"""The name by which joints and forces refer to the inertial frame."""


@dataclass(frozen=True)
class PointMarker:
    """A named material point of a rigid body or of the ground, with its coordinates in the frame of that body."""

    name: str
    x: Quantity
    y: Quantity
    __repr__ = record_text


@dataclass(frozen=True)
class MarkerRef:
    """A marker of a body, or of the ground."""

    body: str
    marker: str

    def __str__(self) -> str:
        return f"{self.body}.{self.marker}"
