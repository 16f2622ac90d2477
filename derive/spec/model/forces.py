"""Forces, torques, springs and bushings of a scene as frozen data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Annotated, ClassVar, Literal

from derive.short_text import record_text
from derive.spec.model.documentation import documented
from derive.spec.model.keys import Key, KeyType, key
from derive.spec.model.markers import MarkerRef
from derive.spec.model.quantity import Quantity
from derive.spec.model.time_function import TimeFunction

ForceFrame = Literal["inertial", "body"]
LOAD_FACTOR = key(
    KeyType.FUNCTION,
    "Factor of the load: a number, a function of t, or an input.",
    default=TimeFunction("number", value=Fraction(1)),
    shown=1,
)

BETWEEN = key(
    KeyType.MARKER_PAIR,
    'Two markers, such as ["ground.bearing", "crank.hub"].',
    name="between",
    example='["ground.bearing", "crank.hub"]',
)
"""The markers of a joint, and of a spring."""


def at_marker(example: str) -> Key:
    """The key of the marker at which a force or a torque acts."""
    return key(KeyType.MARKER, f"Marker at which it acts, such as {example}.", example=example)


AGAINST = key(KeyType.MARKER, "Marker at which the reaction acts; by default there is no reaction.")
"""The marker of the reaction of a torque."""


class AtMarker:
    """The base class of forces at one marker."""

    at: MarkerRef

    @property
    def markers(self) -> tuple[MarkerRef]:
        """The marker at which the force acts."""
        return (self.at,)


@documented
@dataclass(frozen=True)
class Force(AtMarker):
    """A force at a marker.

    Attributes:
        name: the name of the force.

    Examples:
        >>> import derive
        >>> push = derive.Force("push", derive.MarkerRef("block", "o"), ("10*t", 0))
        >>> block = derive.RigidBody("block", mass=1, inertia=1, markers=[derive.PointMarker("o", 0, 0)])
        >>> scene = derive.scene("pushed", bodies=[block], forces=[push])
        >>> derive.simulate(scene, duration=1, output=1)["block_c1dot"].round(6)  # 10 t^2 / 2
        array([0., 5.])
    """

    name: str
    at: Annotated[MarkerRef, at_marker('"rod.right"')]
    components: Annotated[
        tuple[TimeFunction, TimeFunction],
        key(
            KeyType.FUNCTION_PAIR,
            "Components in the frame of the force, N: numbers, or functions of t.",
            "N",
            example="[0, -10]",
        ),
    ]
    frame: Annotated[
        ForceFrame,
        key(
            KeyType.CHOICE,
            "The frame of the components: inertial, or body, which rotates with the section of the body at the marker, "
            "so that the force follows the body.",
        ),
    ] = "inertial"
    kind: ClassVar[str] = "force"
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class Torque:
    """A torque at a marker.

    Attributes:
        name: the name of the torque.

    Examples:
        >>> import derive
        >>> motor = derive.Torque("motor", derive.MarkerRef("wheel", "o"), 3)
        >>> wheel = derive.RigidBody("wheel", mass=1, inertia=2, markers=[derive.PointMarker("o", 0, 0)])
        >>> scene = derive.scene("run_up", bodies=[wheel], torques=[motor])
        >>> derive.simulate(scene, duration=1, output=1)["wheel_phidot"].round(6)  # rad/s
        array([0. , 1.5])
    """

    name: str
    at: Annotated[MarkerRef, at_marker('"crank.hub"')]
    value: Annotated[
        TimeFunction,
        key(KeyType.FUNCTION, "Torque, N m: a number, or a function of t.", "N m", example="1.5"),
    ]
    against: Annotated[MarkerRef | None, AGAINST] = None
    kind: ClassVar[str] = "torque"
    __repr__ = record_text

    @property
    def markers(self) -> tuple[MarkerRef, ...]:
        """The marker at which the torque acts, and the marker of its reaction, if there is one."""
        return (self.at,) if self.against is None else (self.at, self.against)


class BetweenMarkers:
    """The base class of elements that act between two markers."""

    first: MarkerRef
    second: MarkerRef

    @property
    def markers(self) -> tuple[MarkerRef, MarkerRef]:
        """The two markers between which the element acts."""
        return (self.first, self.second)


def _coefficient(power: int) -> Key:
    """The key of the coefficient of a power of the extension in the characteristic of a spring."""
    text = f"Coefficient of power {power} of the extension in the characteristic, N/m^{power} or N m/rad^{power}."
    return key(KeyType.QUANTITY, text, f"{{force}}/{{length}}^{power}")


@documented
@dataclass(frozen=True)
class Spring(BetweenMarkers):
    """A spring with a damper between two markers.

    Attributes:
        name: the name of the spring.
        kind: "linear" or "rotational".
        second: the second marker.

    Examples:
        >>> import derive
        >>> spring = derive.Spring(
        ...     "spring", "rotational", derive.MarkerRef("ground", "o"), derive.MarkerRef("wheel", "o"), stiffness=4
        ... )
        >>> wheel = derive.RigidBody("wheel", mass=1, inertia=1, markers=[derive.PointMarker("o", 0, 0)])
        >>> hinge = derive.Joint("hinge", "revolute", derive.MarkerRef("ground", "o"), derive.MarkerRef("wheel", "o"))
        >>> scene = derive.scene("balance", ground={"o": (0, 0)}, bodies=[wheel], joints=[hinge], springs=[spring])
        >>> derive.modes(scene).frequencies.round(4)  # 2 rad/s in Hz
        array([0.3183])
    """

    # The units depend on the kind, a name of the registry of forces. With the extension x = length - rest its force is
    # stiffness * x + quadratic * x^2 + ... + quintic * x^5 + damping * (rate of the length); for rotational ones the
    # length is the rotation of the second marker against the first.

    name: str
    kind: str
    first: Annotated[MarkerRef, replace(BETWEEN, example='["ground.bearing", "slider.pin"]')]
    second: MarkerRef
    stiffness: Annotated[
        Quantity,
        key(KeyType.NOT_NEGATIVE_QUANTITY, "Stiffness, N/m or N m/rad.", "{force}/{length}", example="1000"),
    ]
    damping: Annotated[
        Quantity,
        key(KeyType.NOT_NEGATIVE_QUANTITY, "Damping constant, N s/m or N m s/rad.", "{force} s/{length}"),
    ] = Fraction(0)
    rest: Annotated[
        Quantity,
        key(KeyType.QUANTITY, "Length, m, or angle, rad, at which the spring exerts no force.", "{length}"),
    ] = Fraction(0)
    quadratic: Annotated[Quantity, _coefficient(2)] = Fraction(0)
    cubic: Annotated[Quantity, _coefficient(3)] = Fraction(0)
    quartic: Annotated[Quantity, _coefficient(4)] = Fraction(0)
    quintic: Annotated[Quantity, _coefficient(5)] = Fraction(0)
    __repr__ = record_text


def _stiffness(direction: str, force: str = "N", length: str = "m") -> Key:
    return _of_bushing(KeyType.NOT_NEGATIVE_QUANTITY, f"Stiffness {direction}", f"{force}/{length}")


def _damping(direction: str, force: str = "N", length: str = "m") -> Key:
    return _of_bushing(KeyType.NOT_NEGATIVE_QUANTITY, f"Damping constant {direction}", f"{force} s/{length}")


def _rest(direction: str, length: str = "m") -> Key:
    return _of_bushing(KeyType.QUANTITY, f"Displacement at which the spring exerts no force, {direction}", length)


def _of_bushing(of: KeyType, text: str, unit: str) -> Key:
    """The key of a constant of a bushing, in the frame of the section at the first marker."""
    return key(of, f"{text} of the frame of the first marker, {unit}.", unit)


@documented
@dataclass(frozen=True)
class Bushing(BetweenMarkers):
    """Linear springs with dampers between two markers: along both axes of the section at the first, and about e3.

    The forces are stiffness * (displacement - rest) + damping * (rate), where displacement and rate are those of the
    second marker relative to the first, in the frame of the section there; the torque likewise with the rotation.

    Attributes:
        name: the name of the bushing.
        second: the second marker.

    Examples:
        >>> import derive
        >>> mount = derive.Bushing(
        ...     "mount",
        ...     first=derive.MarkerRef("ground", "o"),
        ...     second=derive.MarkerRef("block", "o"),
        ...     stiffness_x=400,
        ...     stiffness_y=900,
        ...     stiffness_rotation=1600,
        ... )
        >>> block = derive.RigidBody("block", mass=1, inertia=1, markers=[derive.PointMarker("o", 0, 0)])
        >>> scene = derive.scene("mounted", ground={"o": (0, 0)}, bodies=[block], springs=[mount])
        >>> (derive.modes(scene).frequencies * 2 * 3.14159265).round(3)  # 20, 30 and 40 rad/s
        array([20., 30., 40.])
    """

    name: str
    first: Annotated[MarkerRef, BETWEEN]
    second: MarkerRef
    stiffness_x: Annotated[Quantity, _stiffness("along x")] = Fraction(0)
    stiffness_y: Annotated[Quantity, _stiffness("along y")] = Fraction(0)
    stiffness_rotation: Annotated[Quantity, _stiffness("about e3", "N m", "rad")] = Fraction(0)
    damping_x: Annotated[Quantity, _damping("along x")] = Fraction(0)
    damping_y: Annotated[Quantity, _damping("along y")] = Fraction(0)
    damping_rotation: Annotated[Quantity, _damping("about e3", "N m", "rad")] = Fraction(0)
    rest_x: Annotated[Quantity, _rest("along x")] = Fraction(0)
    rest_y: Annotated[Quantity, _rest("along y")] = Fraction(0)
    rest_rotation: Annotated[Quantity, _rest("about e3", "rad")] = Fraction(0)
    kind: ClassVar[str] = "bushing"
    __repr__ = record_text


@dataclass(frozen=True)
class CustomForce:
    """A force, torque or spring of a kind that is registered from outside the package.

    Attributes:
        name: the name of the element.
        kind: its name in `FORCES`.
        markers: the markers at which it acts.
        values: the values of the keys of the kind.

    Examples:
        >>> import derive
        >>> brush = derive.CustomForce("brush", "brush", (derive.MarkerRef("rod", "tip"),), {"coefficient": 0.3})
        >>> str(brush.markers[0]), brush.values["coefficient"]
        ('rod.tip', 0.3)
    """

    name: str
    kind: str
    markers: tuple[MarkerRef, ...]
    values: Mapping[str, object] = field(default_factory=dict, hash=False)
    __repr__ = record_text


SceneForce = Force | Torque | Spring | Bushing | CustomForce
