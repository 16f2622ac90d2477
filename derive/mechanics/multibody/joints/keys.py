"""Keys that several types of joints share."""

from __future__ import annotations

from derive.mechanics.multibody.keys import Key, KeyType

ANGLE = Key(
    "angle", KeyType.FLOAT, "rad", "Constant rotation of body 2 relative to body 1, rad; not for revolute joints."
)
