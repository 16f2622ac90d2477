"""Planar joints as frozen data, and the drives that prescribe their motion, which scenes in space have as well."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Annotated

from derive.short_text import record_text
from derive.spec.model.documentation import documented
from derive.spec.model.forces import BETWEEN
from derive.spec.model.keys import KeyType, key
from derive.spec.model.markers import MarkerRef
from derive.spec.model.quantity import Quantity
from derive.spec.model.simulation import GUESS
from derive.spec.model.time_function import TimeFunction


@documented
@dataclass(frozen=True)
class JointInitialValues:
    """Initial values of the relative motion of a joint, or of the joint of a drive: of body 2 relative to body 1.

    Examples:
        >>> import derive
        >>> bent = derive.JointInitialValues(angle=0.5, speed=2)
        >>> bent.coordinate
        0.5
    """

    angle: Annotated[float | None, key(KeyType.FLOAT, "Relative rotation of a revolute joint, rad.")] = None
    displacement: Annotated[
        float | None, key(KeyType.FLOAT, "Displacement of a translational joint along its axis, m.")
    ] = None
    speed: Annotated[float | None, key(KeyType.FLOAT, "Rate of that rotation or displacement, rad/s or m/s.")] = None
    guess: Annotated[bool, GUESS] = False
    __repr__ = record_text

    @property
    def coordinate(self) -> float | None:
        """The given angle or displacement."""
        return self.displacement if self.angle is None else self.angle


JOINT_START = key(JointInitialValues, "Initial values of the relative motion.")


@documented
@dataclass(frozen=True)
class Joint:
    """A joint between two markers.

    Attributes:
        name: the name of the joint.
        kind: a name in `JOINTS`.
        second: the second marker.

    Examples:
        >>> import derive
        >>> hinge = derive.Joint("hinge", "revolute", derive.MarkerRef("ground", "o"), derive.MarkerRef("rod", "left"))
        >>> rod = {"length": 1, "frame": "mean", "markers": {"left": -1}}
        >>> derive.scene("swing", ground={"o": (0, 0)}, bodies={"rod": rod}, joints=[hinge]).joints[0].kind
        'revolute'
    """

    # Its kind and the keys angle and axis are those of the registry of joints. Its multipliers are the force and the
    # torque that it exerts on the second body.
    name: str
    kind: str
    first: Annotated[MarkerRef, BETWEEN]
    second: MarkerRef
    angle: Annotated[
        float,
        key(
            KeyType.FLOAT,
            "Constant rotation of body 2 relative to body 1, rad; not for revolute joints.",
            "rad",
            optional=True,
        ),
    ] = 0.0
    axis: Annotated[
        tuple[Fraction, Fraction],
        key(
            KeyType.DIRECTION,
            "Direction of the line of a translational joint in the frame of body 1.",
            optional=True,
        ),
    ] = (Fraction(1), Fraction(0))
    start: Annotated[JointInitialValues, JOINT_START] = JointInitialValues()
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class CustomJoint(Joint):
    """A joint of a kind that is registered from outside the package; its kind is its name in `JOINTS`.

    Attributes:
        name: the name of the joint.
        kind: the kind of joint.
        second: the second marker.
        values: those of the keys of the kind.

    Examples:
        >>> import derive
        >>> first, second = derive.MarkerRef("ground", "o"), derive.MarkerRef("rod", "left")
        >>> derive.CustomJoint("slot", "slot", first, second, values={"length": 0.2}).values
        {'length': 0.2}
    """

    values: Mapping[str, object] = field(default_factory=dict, hash=False)
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class Drive:
    """A joint whose motion is prescribed, by the motion itself or by its speed.

    Attributes:
        name: the name of the drive.

    Examples:
        >>> import derive
        >>> motor = derive.Drive("motor", "hinge", motion=None, speed=5)
        >>> wheel = {"mass": 1, "inertia": 1, "markers": {"o": (0, 0)}}
        >>> hinge = {"kind": "revolute", "between": ["ground.o", "wheel.o"]}
        >>> parts = {"bodies": {"wheel": wheel}, "joints": {"hinge": hinge}, "drives": [motor]}
        >>> derive.scene("turning", ground={"o": (0, 0)}, **parts).drives[0].constant_speed
        Fraction(5, 1)
    """

    name: str
    joint: Annotated[str, key(KeyType.JOINT, "The name of a revolute or translational joint.", example='"bearing"')]
    motion: Annotated[
        TimeFunction | None,
        key(
            KeyType.FUNCTION,
            'Angle, rad, or displacement, m, as a function of t, such as "0.1*sin(2*pi*t)".',
            optional=True,
        ),
    ]
    speed: Annotated[
        Quantity | TimeFunction | None,
        key(
            KeyType.SPEED,
            "Speed in place of a motion, rad/s or m/s: a number, a parameter, or a function of t, such as "
            '"150*step(t, 0, 0.3)", whose integral from t = 0 the motion is.',
        ),
    ] = None
    offset: Annotated[
        Fraction,
        key(KeyType.NUMBER, "Angle, rad, or displacement, m, at t = 0; only with a speed.", optional=True),
    ] = Fraction(0)
    start: Annotated[JointInitialValues, JOINT_START] = JointInitialValues()
    __repr__ = record_text

    @property
    def constant_speed(self) -> Quantity | None:
        """The speed if it is a number or a parameter; None for a function of t."""
        return None if isinstance(self.speed, TimeFunction) else self.speed
