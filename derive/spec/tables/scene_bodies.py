"""The tables of the bodies of a scene, and of what they stand on, as pydantic models."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    WithJsonSchema,
)

from derive.spec.model.body import DEFAULT_LENGTH, DEFAULT_MASS, Quantity
from derive.spec.model.scene import BeamBody, InitialGuess, PointMarker, RigidBody, SceneBody
from derive.spec.parsing import scene_values, values
from derive.spec.tables.beam import BeamKeys
from derive.spec.tables.shared import (
    MAX_MARKERS,
    Name,
    PlanarGravity,
    QuantityInput,
    SignedInput,
    TomlTable,
    Truth,
    components,
    few,
    few_markers,
    number_schema,
    quantity,
)

MAX_NAMED = 100
BEAM_KEYS = ("length", "bending_stiffness", "ansatz", "frame")
"""A body with one of these keys is a beam."""
INERTIA_UNIT = "kg m^2"
LENGTH_UNIT = DEFAULT_LENGTH.unit


def few_named(noun: str, example: str) -> BeforeValidator:
    """A table of at most so many tables."""

    def check(value: object) -> object:
        if not isinstance(value, Mapping):
            raise values.WrongValueError(
                f"a table of {noun} by their names is needed, such as {example}, not {values.kind_of(value)}"
            )
        few(len(value), 0, MAX_NAMED, noun)
        return value

    return BeforeValidator(check)


Float = Annotated[float, PlainValidator(values.any_float), WithJsonSchema(number_schema())]
PositiveFloat = Annotated[
    float, PlainValidator(values.positive_float), WithJsonSchema(number_schema(exclusiveMinimum=0))
]
FloatPair = Annotated[tuple[Float, Float], components(("0.1", "0"), "numbers")]
NumberPair = Annotated[
    tuple[
        Annotated[Fraction, PlainValidator(values.number), WithJsonSchema(number_schema())],
        Annotated[Fraction, PlainValidator(values.number), WithJsonSchema(number_schema())],
    ],
    components(("1", "0"), "numbers"),
]
Axis = Annotated[NumberPair, AfterValidator(scene_values.axis)]
Coordinates = Annotated[tuple[SignedInput, SignedInput], components(("0.15", "0"), "coordinates")]
PieceCount = Annotated[
    int,
    PlainValidator(scene_values.piece_count),
    WithJsonSchema({"type": "integer", "minimum": 1, "maximum": scene_values.MAX_PIECES}),
]
Markers = Annotated[
    dict[Name, Coordinates],
    few_markers("coordinates"),
    Field(
        description="Named points and their coordinates, [x, y], in the base of the body or of the ground, m.",
        json_schema_extra={"maxProperties": MAX_MARKERS, "additionalProperties": False},
    ),
]


def _points(markers: Mapping[str, Coordinates]) -> tuple[PointMarker, ...]:
    return tuple(PointMarker(name, *_pair(at)) for name, at in markers.items())


def _pair(at: Coordinates) -> tuple[Quantity, Quantity]:
    return quantity(at[0], LENGTH_UNIT), quantity(at[1], LENGTH_UNIT)


class GroundTable(TomlTable):
    """The inertial base, which does not move."""

    markers: Markers = {}  # noqa: RUF012  pydantic copies it

    def points(self) -> tuple[PointMarker, ...]:
        """Its markers."""
        return _points(self.markers)


class SceneTable(TomlTable):
    """What acts on all bodies of a scene."""

    gravity: PlanarGravity = None


class StartTable(TomlTable):
    """A guess of the state at the start, which is made consistent with the joints."""

    position: Annotated[
        FloatPair, Field(description="Where the origin of a rigid body is, or the centre of a beam, m.")
    ] = (0.0, 0.0)
    angle: Annotated[Float, Field(description="How far it is turned, rad.")] = 0.0
    velocity: Annotated[FloatPair, Field(description="The velocity of that point, m/s.")] = (0.0, 0.0)
    spin: Annotated[Float, Field(description="How fast it turns, rad/s.")] = 0.0

    def start(self) -> InitialGuess:
        """The start that the table describes."""
        return InitialGuess(self.position, self.angle, self.velocity, self.spin)


StartInput = Annotated[StartTable, Field(description="A guess of the state at the start; all zero if left out.")]


class RigidTable(TomlTable):
    """A rigid body in the plane; it has none of the keys length, bending_stiffness, ansatz and frame."""

    mass: Annotated[QuantityInput | None, Field(description="The mass; not needed where the motion is prescribed.")] = (
        None
    )
    inertia: Annotated[
        QuantityInput | None,
        Field(description="The moment of inertia about the centre of mass; not needed where the motion is prescribed."),
    ] = None
    centre: Annotated[Coordinates, Field(description="Where the centre of mass is, in the base of the body, m.")] = (
        Fraction(0),
        Fraction(0),
    )
    markers: Markers = {}  # noqa: RUF012  pydantic copies it
    start: StartInput = StartTable()
    keep_coordinates: Annotated[
        Truth,
        Field(
            description="Whether it has three coordinates even where a joint or a drive takes some away; the "
            "multipliers then tell what that joint or drive exerts."
        ),
    ] = False

    def body(self, name: str) -> RigidBody:
        """The body as the derivation takes it."""
        return RigidBody(
            name=name,
            mass=None if self.mass is None else quantity(self.mass, DEFAULT_MASS.unit),
            inertia=None if self.inertia is None else quantity(self.inertia, INERTIA_UNIT),
            centre=_pair(self.centre),
            markers=_points(self.markers),
            start=self.start.start(),
            keep_coordinates=self.keep_coordinates,
        )


class BeamBodyTable(BeamKeys):
    """A beam in a scene: it has one of the keys length, bending_stiffness, ansatz and frame."""

    model_config = ConfigDict(json_schema_extra={"anyOf": [{"required": [key]} for key in BEAM_KEYS]})

    pieces: Annotated[PieceCount, Field(description="Into how many beams of equal length it is cut.")] = 1
    start: StartInput = StartTable()

    def body(self, name: str) -> BeamBody:
        """The body as the derivation takes it."""
        return BeamBody(name, self.planar_beam(name), self.pieces, self.start.start())


def kind_of_scene_body(value: Any) -> str:
    """Which kind of body a table describes: a discriminator."""
    return "beam" if isinstance(value, Mapping) and any(key in value for key in BEAM_KEYS) else "rigid"


SceneBodyInput = Annotated[
    Annotated[RigidTable, Tag("rigid")] | Annotated[BeamBodyTable, Tag("beam")], Discriminator(kind_of_scene_body)
]
Bodies = Annotated[
    dict[Name, SceneBodyInput],
    few_named("bodies", "[bodies.rod]"),
    Field(
        description="The bodies of a scene by their names: beams, and rigid bodies.",
        json_schema_extra={"minProperties": 1, "maxProperties": MAX_NAMED, "additionalProperties": False},
    ),
]


def scene_bodies(bodies: Mapping[str, RigidTable | BeamBodyTable]) -> tuple[SceneBody, ...]:
    """The bodies as the derivation takes them."""
    return tuple(table.body(name) for name, table in bodies.items())
