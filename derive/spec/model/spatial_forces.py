"""Forces, torques and springs of a scene in space as frozen data: at markers, and in joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

from derive.short_text import record_text
from derive.spec.model.forces import AGAINST, BETWEEN, AtMarker, BetweenMarkers, ForceFrame, at_marker
from derive.spec.model.keys import Key, KeyType, key
from derive.spec.model.markers import MarkerRef
from derive.spec.model.time_function import TimeFunction

Components = tuple[TimeFunction, TimeFunction, TimeFunction]


def _components(unit: str, example: str) -> Key:
    text = f"Components, {unit}: numbers, or functions of t."
    return key(KeyType.FUNCTION_TRIPLE, text, unit, example=example)


def _frame(noun: str) -> Key:
    text = f"The frame of the components: inertial, or body, the frame of the marker, with which the {noun} turns."
    return key(KeyType.CHOICE, text)


@dataclass(frozen=True)
class SpatialForce(AtMarker):
    """A force at a marker in space."""

    name: str
    at: Annotated[MarkerRef, at_marker('"rod.right"')]
    force: Annotated[Components, _components("N", "[0, 0, -10]")]
    frame: Annotated[ForceFrame, _frame("force")] = "inertial"
    kind: ClassVar[str] = "force"
    __repr__ = record_text


@dataclass(frozen=True)
class SpatialTorque:
    """A torque at a marker in space, with a reaction at another one or without."""

    name: str
    on: Annotated[MarkerRef, at_marker('"crank.hub"')]
    torque: Annotated[Components, _components("N m", "[0, 0, 1.5]")]
    against: Annotated[MarkerRef | None, AGAINST] = None
    frame: Annotated[ForceFrame, _frame("torque")] = "inertial"
    kind: ClassVar[str] = "torque"
    __repr__ = record_text

    @property
    def markers(self) -> tuple[MarkerRef, ...]:
        """The marker at which the torque acts, and that of its reaction, if there is one."""
        return (self.on,) if self.against is None else (self.on, self.against)


@dataclass(frozen=True)
class SpatialSpring(BetweenMarkers):
    """A spring or a bushing between two markers in space; `values` are those of the keys of its kind."""

    name: str
    kind: str
    first: Annotated[MarkerRef, BETWEEN]
    second: MarkerRef
    values: Mapping[str, object] = field(default_factory=dict, hash=False)
    __repr__ = record_text


def _joint(motion: str, example: str) -> Key:
    return key(KeyType.JOINT, f"Joint whose bodies may {motion} z of its first marker.", example=example)


def _on_second_body(noun: str, unit: str, example: str) -> Key:
    text = f"{noun} on the second body, {unit}: a number, or a function of t."
    return key(KeyType.FUNCTION, text, unit, example=example)


@dataclass(frozen=True)
class SpatialJointForce:
    """A force in a joint: along z of its first marker on the second body, and its reaction on the first one."""

    name: str
    joint: Annotated[str, _joint("move along", '"guide"')]
    value: Annotated[TimeFunction, _on_second_body("Force", "N", "10")]
    kind: ClassVar[str] = "force"
    __repr__ = record_text


@dataclass(frozen=True)
class SpatialJointTorque:
    """A torque in a joint: about z of its first marker on the second body, and its reaction on the first one."""

    name: str
    joint: Annotated[str, _joint("turn about", '"hinge"')]
    value: Annotated[TimeFunction, _on_second_body("Torque", "N m", "1.5")]
    kind: ClassVar[str] = "torque"
    __repr__ = record_text


SpatialJointLoad = SpatialJointForce | SpatialJointTorque
"""Loads along or about the axis of a joint."""
SpatialAction = SpatialForce | SpatialTorque | SpatialSpring | SpatialJointLoad
"""Actions at markers and in joints in space."""
