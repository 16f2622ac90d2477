"""The registry of bodies: one line for each type that a specification may contain."""

from __future__ import annotations

from typing import Any

from derive.mechanics.multibody.bodies.beam import Beam
from derive.mechanics.multibody.bodies.body_type import BodyType
from derive.mechanics.multibody.bodies.rigid import Rigid
from derive.registry import Registry

BODIES: Registry[BodyType[Any]] = Registry(
    "body",
    {
        "rigid": Rigid(),
        "beam": Beam(),
    },
)
