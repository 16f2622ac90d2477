"""Forces, torques and springs of a scene in space as frozen data: at markers, and in joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

from derive.short_text import record_text
from derive.spec.model.documentation import documented
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


@documented
@dataclass(frozen=True)
class SpatialForce(AtMarker):
    """A force at a marker in space.

    Attributes:
        name: the name of the force.

    Examples:
        >>> import derive
        >>> push = derive.SpatialForce("push", derive.MarkerRef("ball", "o"), ("10*t", 0, 0))
        >>> body = {"mass": 1, "inertia": [1, 1, 1, 0, 0, 0], "markers": {"o": (0, 0, 0)}}
        >>> scene = derive.spatial_scene("pushed", bodies={"ball": body}, forces=[push])
        >>> derive.simulate(scene, duration=1, output=1)["ball_c1dot"].round(6)  # 10 t^2 / 2
        array([0., 5.])
    """

    name: str
    at: Annotated[MarkerRef, at_marker('"rod.right"')]
    force: Annotated[Components, _components("N", "[0, 0, -10]")]
    frame: Annotated[ForceFrame, _frame("force")] = "inertial"
    kind: ClassVar[str] = "force"
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class SpatialTorque:
    """A torque at a marker in space, with a reaction at another one or without.

    Attributes:
        name: the name of the torque.

    Examples:
        >>> import derive
        >>> motor = derive.SpatialTorque("motor", derive.MarkerRef("wheel", "o"), (0, 0, 3))
        >>> wheel = {"mass": 1, "inertia": [1, 1, 2, 0, 0, 0], "markers": {"o": (0, 0, 0)}}
        >>> scene = derive.spatial_scene("run_up", bodies={"wheel": wheel}, torques=[motor])
        >>> derive.simulate(scene, duration=1, output=1).v[-1].round(6)
        array([0. , 0. , 0. , 0. , 0. , 1.5])
    """

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


@documented
@dataclass(frozen=True)
class SpatialSpring(BetweenMarkers):
    """A spring or a bushing between two markers in space.

    Attributes:
        name: the name of the spring.
        kind: a name in `SPATIAL_SPRINGS`.
        second: the second marker.
        values: those of the keys of its kind.

    Examples:
        >>> import derive
        >>> ends = derive.MarkerRef("ground", "o"), derive.MarkerRef("ball", "o")
        >>> spring = derive.SpatialSpring("spring", "linear", *ends, {"stiffness": 400, "rest": 1})
        >>> body = {"mass": 1, "inertia": [1, 1, 1, 0, 0, 0], "markers": {"o": (0, 0, 0)}}
        >>> scene = derive.spatial_scene("bound", ground={"o": (0, 0, 0)}, bodies={"ball": body}, springs=[spring])
        >>> scene.springs[0].values["stiffness"]
        Fraction(400, 1)
    """

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


@documented
@dataclass(frozen=True)
class SpatialJointForce:
    """A force in a joint: along z of its first marker on the second body, and its reaction on the first one.

    Attributes:
        name: the name of the force.

    Examples:
        >>> import derive
        >>> derive.SpatialJointForce("push", "guide", 10).joint
        'guide'
    """

    name: str
    joint: Annotated[str, _joint("move along", '"guide"')]
    value: Annotated[TimeFunction, _on_second_body("Force", "N", "10")]
    kind: ClassVar[str] = "force"
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class SpatialJointTorque:
    """A torque in a joint: about z of its first marker on the second body, and its reaction on the first one.

    Attributes:
        name: the name of the torque.

    Examples:
        >>> import derive
        >>> wheel = {"mass": 1, "inertia": [1, 1, 2, 0, 0, 0], "markers": {"o": (0, 0, 0)}}
        >>> scene = derive.spatial_scene(
        ...     "run_up",
        ...     ground={"o": (0, 0, 0)},
        ...     bodies={"wheel": wheel},
        ...     joints={"hinge": {"kind": "revolute", "between": ["ground.o", "wheel.o"]}},
        ...     torques=[derive.SpatialJointTorque("motor", "hinge", 3)],
        ... )
        >>> derive.simulate(scene, duration=1, output=1).v[-1].round(6)  # rad/s
        array([1.5])
    """

    name: str
    joint: Annotated[str, _joint("turn about", '"hinge"')]
    value: Annotated[TimeFunction, _on_second_body("Torque", "N m", "1.5")]
    kind: ClassVar[str] = "torque"
    __repr__ = record_text


SpatialJointLoad = SpatialJointForce | SpatialJointTorque
"""Loads along or about the axis of a joint."""
SpatialAction = SpatialForce | SpatialTorque | SpatialSpring | SpatialJointLoad
"""Actions at markers and in joints in space."""
