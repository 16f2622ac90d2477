"""The bodies of a planar scene as frozen data: rigid bodies, beams with their loads, and registered types."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Annotated, ClassVar

from derive.short_text import record_text
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import DEFAULT_LENGTH, DEFAULT_MASS, INERTIA_UNIT, Marker, Polynomial
from derive.spec.model.documentation import documented
from derive.spec.model.forces import ForceFrame
from derive.spec.model.keys import KeyType, key
from derive.spec.model.markers import PointMarker
from derive.spec.model.quantity import Quantity
from derive.spec.model.simulation import NOT_GIVEN, InitialValues
from derive.spec.model.time_function import TimeFunction

NOT_NEEDED = "not needed if the motion is prescribed: energies, powers and reactions then count what is not given as 0."


BODY_MASS = key(KeyType.POSITIVE_QUANTITY, f"Mass, kg; {NOT_NEEDED}", DEFAULT_MASS.unit)


POINTS = key(
    KeyType.POINTS,
    "Named points and their coordinates [x, y], m, in the frame of the body or the inertial frame.",
    default=(),
)


START = key(InitialValues, "Initial values; those that are not given adapt to the others and to the joints.")


@documented
@dataclass(frozen=True)
class RigidBody:
    """A rigid body in the plane; it has none of the keys length, bending_stiffness, ansatz and frame.

    Attributes:
        name: the name of the body.

    Examples:
        >>> import derive
        >>> rod = derive.RigidBody("rod", mass=2, inertia="1/6", markers=[derive.PointMarker("top", 0, 0.5)])
        >>> derive.scene("free", bodies=[rod]).bodies[0].inertia
        Fraction(1, 6)
    """

    name: str
    mass: Annotated[Quantity | None, BODY_MASS] = None
    inertia: Annotated[
        Quantity | None,
        key(
            KeyType.POSITIVE_QUANTITY,
            f"Moment of inertia about the centre of mass, kg m^2; {NOT_NEEDED}",
            INERTIA_UNIT,
        ),
    ] = None
    centre: Annotated[
        tuple[Quantity, Quantity],
        key(KeyType.COORDINATES, "Position of the centre of mass in the frame of the body, m.", DEFAULT_LENGTH.unit),
    ] = (Fraction(0), Fraction(0))
    markers: Annotated[tuple[PointMarker, ...], POINTS] = ()
    start: Annotated[InitialValues, START] = NOT_GIVEN
    keep_coordinates: Annotated[
        bool,
        key(
            KeyType.TRUTH,
            "Whether the body keeps all three coordinates even if a joint or a drive could eliminate some; the "
            "multipliers are then the constraint reactions.",
        ),
    ] = False
    kind: ClassVar[str] = "rigid"
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class DistributedLoad:
    """A force per length on a beam: polynomials in xi times a function of t.

    Attributes:
        name: the name of the load.

    Examples:
        >>> import derive
        >>> wind = {"force": [0, "-10*(1 - xi^2)"], "time": "sin(t)"}
        >>> scene = derive.scene("bar", bodies={"rod": {"length": 1, "frame": "mean", "loads": {"wind": wind}}})
        >>> scene.bodies[0].loads[0].force
        ((), (Fraction(-10, 1), Fraction(0, 1), Fraction(10, 1)))
    """

    name: str
    force: Annotated[
        tuple[Polynomial, Polynomial],
        key(
            KeyType.LOAD_PAIR,
            "Components, N/m: numbers, or polynomials in xi, which goes from -1 to 1 along the beam.",
            example='[0, "-10*(1 - xi^2)"]',
        ),
    ]
    time: Annotated[
        TimeFunction,
        key(
            KeyType.FUNCTION,
            "Factor of the load: a number, or a function of t.",
            default=TimeFunction("number", value=Fraction(1)),
            shown=1,
        ),
    ]
    frame: Annotated[
        ForceFrame,
        key(KeyType.CHOICE, "The frame of the components: inertial, or body, the floating frame of the beam."),
    ] = "inertial"
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class BeamBody:
    """A beam in a scene: it has one of the keys length, bending_stiffness, ansatz and frame.

    Attributes:
        name: the name of the body.
        beam: the beam, as `planar_beam` makes it.

    Examples:
        >>> import derive
        >>> rod = derive.BeamBody("rod", derive.planar_beam("rod", frame="mean", length=2), pieces=2)
        >>> scene = derive.scene("bar", bodies=[rod])
        >>> derive.derive(scene).names
        ('rod_1', 'rod_2')
    """

    # The whole rod, before it is cut into pieces that are welded together; its gravity is None.
    name: str
    beam: PlanarBeam
    pieces: Annotated[
        int, key(KeyType.PIECE_COUNT, "Number of beams of equal length into which the rod is divided.")
    ] = 1
    start: Annotated[InitialValues, START] = NOT_GIVEN
    loads: Annotated[
        tuple[DistributedLoad, ...],
        key(DistributedLoad, "Distributed loads by name.", example="[bodies.rod.loads.wind]"),
    ] = ()
    kind: ClassVar[str] = "beam"
    __repr__ = record_text

    @property
    def markers(self) -> tuple[Marker, ...]:
        """The markers of the whole rod."""
        return self.beam.markers


@documented
@dataclass(frozen=True)
class CustomBody:
    """A body of a type that is registered from outside the package.

    Attributes:
        name: the name of the body.
        kind: its name in `BODIES`.
        values: those of the keys of the type.

    Examples:
        >>> import derive
        >>> derive.CustomBody("drop", "drop", {"radius": 0.1}).values
        {'radius': 0.1}
    """

    name: str
    kind: str
    values: Mapping[str, object] = field(default_factory=dict, hash=False)
    markers: Annotated[tuple[PointMarker, ...], POINTS] = ()
    start: Annotated[InitialValues, START] = NOT_GIVEN
    __repr__ = record_text


SceneBody = RigidBody | BeamBody | CustomBody
