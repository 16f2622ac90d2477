"""The registry of forces: one line for each; those of the section `springs` are what `kind` may be there."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from derive.mechanics.multibody.forces.force import ForceAtMarker
from derive.mechanics.multibody.forces.force_type import ForceType
from derive.mechanics.multibody.forces.linear_spring import LinearSpring
from derive.mechanics.multibody.forces.rotational_spring import RotationalSpring
from derive.mechanics.multibody.forces.torque import TorqueAtMarker
from derive.registry import Registry
from derive.spec.model.scene import Force, Scene, Spring, Torque

FORCES: Registry[ForceType[Any]] = Registry(
    "force",
    {
        "force": ForceAtMarker(),
        "torque": TorqueAtMarker(),
        "linear": LinearSpring(),
        "rotational": RotationalSpring(),
    },
)


def elements(scene: Scene) -> Iterator[tuple[Force | Torque | Spring, ForceType[Any]]]:
    """The forces of a scene with their types."""
    yield from ((force, FORCES["force"]) for force in scene.forces)
    yield from ((torque, FORCES["torque"]) for torque in scene.torques)
    yield from ((spring, FORCES[spring.kind]) for spring in scene.springs)
