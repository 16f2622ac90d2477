"""The roles of generalised coordinates: what each of them describes, as data that every stage can read."""

from __future__ import annotations

from enum import Enum


class Role(Enum):
    """What a generalised coordinate describes; the values are those of the descriptor of a generated model."""

    TRANSLATION = 1
    """Component of the position of the origin of a floating frame in the inertial frame."""
    ROTATION = 2
    """Rotation angle of a floating frame."""
    QUATERNION = 3
    """Component of the unit quaternion of a floating frame, scalar first."""
    DISPLACEMENT = 4
    """Displacement of a body along its guide."""
    AMPLITUDE = 5
    """Amplitude of an assumed mode."""
