"""The registry of the types of bodies in space."""

from __future__ import annotations

from typing import Any

from derive.mechanics.multibody.bodies.body_type import BodyType
from derive.mechanics.multibody.space.rigid import SpatialRigid
from derive.registry import Registry

SPATIAL_BODIES: Registry[BodyType[Any]] = Registry("body in space", {"rigid": SpatialRigid()})
