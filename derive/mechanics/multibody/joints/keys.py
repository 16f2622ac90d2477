"""Keys that several types of joints share."""

from __future__ import annotations

from derive.mechanics.multibody.keys import Key, KeyType

ANGLE = Key(
    "angle", KeyType.FLOAT, "rad", "The angle of the second body against the first, rad; not of revolute joints."
)
