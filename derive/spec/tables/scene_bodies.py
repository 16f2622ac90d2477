"""The tables of the bodies of a scene, and of the ground, as pydantic models."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import cache, reduce
from operator import or_
from typing import Annotated, Any, ClassVar

from pydantic import (
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    WithJsonSchema,
    create_model,
    model_validator,
)

from derive.mechanics.multibody.bodies.beam import WHOLE_BEAM
from derive.mechanics.multibody.bodies.beam_loads import point_names
from derive.mechanics.multibody.bodies.body_type import BodyType
from derive.mechanics.multibody.bodies.registry import BODIES
from derive.spec.model.body import DEFAULT_LENGTH, DEFAULT_MASS, Polynomial
from derive.spec.model.forces import FORCE_FRAMES, ForceFrame
from derive.spec.model.markers import PointMarker
from derive.spec.model.quantity import Quantity
from derive.spec.model.scene import BeamBody, CustomBody, DistributedLoad, RigidBody, SceneBody
from derive.spec.parsing import choices, values
from derive.spec.parsing.polynomial import MAX_LENGTH
from derive.spec.parsing.time_expression import number_function
from derive.spec.tables.beam import BeamKeys
from derive.spec.tables.beam_parts import MASS_UNITS
from derive.spec.tables.beam_shapes import ShapeFamilyTable
from derive.spec.tables.declared_keys import key_field, key_values
from derive.spec.tables.initial_values import BeamStartInput, BeamStartTable, SceneStartInput, StartInput, StartTable
from derive.spec.tables.markers import MAX_NAMED, Coordinates, Markers, PieceCount, Time, few_named
from derive.spec.tables.shared import Name, PlanarGravity, QuantityInput, TomlTable, Truth, components, quantity

BEAM_KEYS = BODIES["beam"].identifying_keys
"""The keys by which a body is a beam."""
LENGTH_UNIT = DEFAULT_LENGTH.unit
NOT_NEEDED = "not needed if the motion is prescribed: energies, powers and reactions then count what is not given as 0."


LoadPolynomial = Annotated[
    Polynomial,
    PlainValidator(values.load_polynomial),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string", "minLength": 1, "maxLength": MAX_LENGTH}]}),
]


def _points(markers: Mapping[str, Coordinates]) -> tuple[PointMarker, ...]:
    return tuple(PointMarker(name, *_pair(at)) for name, at in markers.items())


def _pair(at: Coordinates) -> tuple[Quantity, Quantity]:
    return quantity(at[0], LENGTH_UNIT), quantity(at[1], LENGTH_UNIT)


class GroundTable(TomlTable):
    """The inertial frame, which does not move."""

    markers: Markers = {}  # noqa: RUF012  pydantic copies it

    def points(self) -> tuple[PointMarker, ...]:
        """The markers of the ground."""
        return _points(self.markers)


class SceneTable(TomlTable):
    """Gravity and initial state of a scene."""

    gravity: PlanarGravity = None
    start: SceneStartInput = None


class RigidTable(TomlTable):
    """A rigid body in the plane; it has none of the keys length, bending_stiffness, ansatz and frame."""

    mass: Annotated[QuantityInput | None, Field(description=f"Mass, kg; {NOT_NEEDED}")] = None
    inertia: Annotated[
        QuantityInput | None,
        Field(description=f"Moment of inertia about the centre of mass, kg m^2; {NOT_NEEDED}"),
    ] = None
    centre: Annotated[Coordinates, Field(description="Position of the centre of mass in the frame of the body, m.")] = (
        Fraction(0),
        Fraction(0),
    )
    markers: Markers = {}  # noqa: RUF012  pydantic copies it
    start: StartInput = StartTable()
    keep_coordinates: Annotated[
        Truth,
        Field(
            description="Whether the body keeps all three coordinates even if a joint or a drive could eliminate some; "
            "the multipliers are then the constraint reactions."
        ),
    ] = False

    def body(self, name: str) -> RigidBody:
        """The model of the body that the derivation takes."""
        return RigidBody(
            name=name,
            mass=None if self.mass is None else quantity(self.mass, DEFAULT_MASS.unit),
            inertia=None if self.inertia is None else quantity(self.inertia, MASS_UNITS["inertia"]),
            centre=_pair(self.centre),
            markers=_points(self.markers),
            start=self.start.start(),
            keep_coordinates=self.keep_coordinates,
        )


class LoadTable(TomlTable):
    """A force per length on a beam: polynomials in xi times a function of t."""

    force: Annotated[
        tuple[LoadPolynomial, LoadPolynomial],
        components(("0", '"-10*(1 - xi^2)"')),
        Field(description="Components, N/m: numbers, or polynomials in xi, which goes from -1 to 1 along the beam."),
    ]
    time: Annotated[
        Time, Field(description="Factor of the load: a number, or a function of t.", json_schema_extra={"default": 1})
    ] = number_function(Fraction(1))
    frame: Annotated[
        ForceFrame,
        PlainValidator(lambda value: choices.choice(value, FORCE_FRAMES, "`frame`")),
        WithJsonSchema({"enum": [*FORCE_FRAMES]}),
        Field(description="The frame of the components: inertial, or body, the floating frame of the beam."),
    ] = "inertial"

    @model_validator(mode="after")
    def check(self) -> LoadTable:
        """Refuse a load without components other than zero."""
        if not any(self.force):
            raise values.WrongValueError("both components of the load are zero; leave it out")
        return self

    def load(self, name: str) -> DistributedLoad:
        """The model of the load that the derivation takes."""
        return DistributedLoad(name, self.force, self.time, self.frame)


class BeamBodyTable(BeamKeys):
    """A beam in a scene: it has one of the keys length, bending_stiffness, ansatz and frame."""

    model_config = ConfigDict(json_schema_extra={"anyOf": [{"required": [key]} for key in BEAM_KEYS]})

    pieces: Annotated[
        PieceCount, Field(description="Number of beams of equal length into which the rod is divided.")
    ] = 1
    start: BeamStartInput = BeamStartTable()
    loads: Annotated[
        dict[Name, LoadTable],
        few_named("loads", "[bodies.rod.loads.wind]"),
        Field(
            description="Distributed loads by name.",
            json_schema_extra={"maxProperties": MAX_NAMED, "additionalProperties": False},
        ),
    ] = {}  # noqa: RUF012

    @model_validator(mode="after")
    def check(self) -> BeamBodyTable:
        """Refuse families of shapes for a beam in pieces, and loads with names of markers."""
        for name in self.loads:
            if taken := point_names(name, self.pieces) & {*self.markers}:
                text = f"a point of the load {name} is called like the marker {min(taken)}; rename one of them"
                raise values.WrongValueError(text)
        if self.pieces > 1 and (self.ends is not None or isinstance(self.ansatz, ShapeFamilyTable)):
            raise values.WrongValueError(WHOLE_BEAM)
        return self

    def body(self, name: str) -> BeamBody:
        """The model of the body that the derivation takes."""
        loads = tuple(table.load(load) for load, table in self.loads.items())
        return BeamBody(name, self.planar_beam(name), self.pieces, self.start.start(), loads)


class CustomBodyTable(TomlTable):
    """A body of a type that is registered from outside the package."""

    kind_of_body: ClassVar[str]
    markers: Markers = {}  # noqa: RUF012  pydantic copies it
    start: StartInput = StartTable()

    def body(self, name: str) -> CustomBody:
        """The model of the body that the derivation takes."""
        given = key_values(BODIES[self.kind_of_body].keys, self)
        return CustomBody(name, self.kind_of_body, given, _points(self.markers), self.start.start())


BodyTable = RigidTable | BeamBodyTable | CustomBodyTable
_OWN: dict[str, type[BodyTable]] = {"rigid": RigidTable, "beam": BeamBodyTable}


def body_tables() -> dict[str, type[BodyTable]]:
    """The tables of all types of bodies that are registered now."""
    return {kind: _OWN.get(kind) or _custom_table(kind, body_type) for kind, body_type in BODIES.items()}


@cache
def _custom_table(kind: str, body_type: BodyType[Any]) -> type[CustomBodyTable]:
    keys: dict[str, Any] = {key.name: key_field(key, key.required) for key in body_type.keys}
    table = create_model(f"{kind.capitalize()}Table", __base__=CustomBodyTable, __doc__=body_type.doc, **keys)
    table.kind_of_body = kind
    return table


def kind_of_scene_body(value: Any) -> str:
    """The kind of body that a table describes: a discriminator."""
    if isinstance(value, Mapping):
        for kind, body_type in BODIES.items():
            if any(key in value for key in body_type.identifying_keys):
                return kind
    return "rigid"


def bodies_field(tables: Mapping[str, type[BodyTable]]) -> Any:
    """The table of the bodies of a scene, each of which is described by one of the tables."""
    options = [Annotated[table, Tag(kind)] for kind, table in tables.items()]
    body: Any = Annotated[reduce(or_, options), Discriminator(kind_of_scene_body)]
    return Annotated[
        dict[Name, body],
        few_named("bodies", "[bodies.rod]"),
        Field(
            description="Bodies of a scene by name: beams and rigid bodies.",
            json_schema_extra={"minProperties": 1, "maxProperties": MAX_NAMED, "additionalProperties": False},
        ),
    ]


def scene_bodies(bodies: Mapping[str, BodyTable]) -> tuple[SceneBody, ...]:
    """The models of the bodies that the derivation takes."""
    return tuple(table.body(name) for name, table in bodies.items())
