"""Forces, torques and springs in space: the values of their keys, and their loads by the type of each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from derive.mechanics.multibody.space.forces import (
    ActionLoads,
    CountedRotation,
    Frames,
    Markers,
    Values,
    force_loads,
    joint_load_loads,
    torque_loads,
)
from derive.mechanics.multibody.space.springs import spring_type
from derive.spec.model.keys import Key, value_keys
from derive.spec.model.spatial_forces import (
    SpatialAction,
    SpatialForce,
    SpatialJointForce,
    SpatialJointTorque,
    SpatialSpring,
    SpatialTorque,
)


def keys_of(action: SpatialAction) -> tuple[Key, ...]:
    """The keys of the table of a force, a torque or a spring besides its markers."""
    match action:
        case SpatialSpring():
            return spring_type(action.kind).keys
        case _:
            return value_keys(type(action))


def specified(action: SpatialAction) -> Mapping[str, Any]:
    """The values of these keys as they are specified."""
    match action:
        case SpatialSpring():
            return action.values
        case _:
            return {key.name: getattr(action, key.field) for key in value_keys(type(action))}


def loads_of(
    action: SpatialAction, markers: Markers, frames: Frames, values: Values, turns: CountedRotation | None
) -> ActionLoads:
    """The loads of a force, a torque or a spring at markers, whose keys have these values as expressions.

    turns: the rotation between the markers of a spring where these are those of a joint that counts turns.
    """
    match action:
        case SpatialForce():
            return force_loads(action, frames, values)
        case SpatialTorque():
            return torque_loads(action, frames, values)
        case SpatialJointForce() | SpatialJointTorque():
            return joint_load_loads(action, markers, frames, values)
        case SpatialSpring():
            return spring_type(action.kind).loads(action, frames, values, turns)
