"""The registry of the types of bodies in space whose specification has all that they need."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from derive.mechanics.multibody.bodies.body_type import BodyType
from derive.mechanics.multibody.space.beam import BeamInSpace
from derive.mechanics.multibody.space.rigid import SpatialRigid

SPATIAL_BODIES: Mapping[str, BodyType[Any]] = {"rigid": SpatialRigid(), "beam": BeamInSpace()}
"""The types of bodies in space by their kinds; those of finite elements have a type each, with their data."""
