"""The tables of joints, drives, forces, springs, and of what to simulate, as pydantic models."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, PlainValidator, WithJsonSchema, model_validator

from derive.spec.model.scene import (
    SPRING_UNITS,
    Deflection,
    Drive,
    Force,
    Joint,
    JointKind,
    MarkerRef,
    Plot,
    ReferenceCurve,
    Simulation,
    Spring,
    TimeFunction,
    Torque,
)
from derive.spec.parsing import scene_values, values
from derive.spec.parsing.parser import MAX_LENGTH
from derive.spec.parsing.scene_values import SpringKind
from derive.spec.tables.scene_bodies import Axis, Float, PieceCount, PositiveFloat
from derive.spec.tables.shared import (
    NotNegativeInput,
    Number,
    SignedInput,
    TomlTable,
    components,
    few,
    number_schema,
    quantity,
)

MAX_STEPS = 10**7
SPEED_UNITS = {"revolute": "rad/s", "translational": "m/s"}

_PLACE = {"type": "string", "pattern": r"^[^.]+\.[^.]+$"}
_TIME = {"anyOf": [{"type": "number"}, {"type": "string", "minLength": 1, "maxLength": MAX_LENGTH}]}
_NAMED = {"type": "string", "minLength": 1}

PlaceInput = Annotated[MarkerRef, PlainValidator(scene_values.place), WithJsonSchema(_PLACE)]
TwoPlaces = Annotated[tuple[PlaceInput, PlaceInput], components(('"ground.bearing"', '"crank.hub"'), "places")]
Time = Annotated[TimeFunction, PlainValidator(scene_values.function), WithJsonSchema(_TIME)]
NameOf = Annotated[str, PlainValidator(scene_values.name_of), WithJsonSchema(_NAMED)]
Text = Annotated[str, PlainValidator(scene_values.text), WithJsonSchema(_NAMED)]


class JointTable(TomlTable):
    """A joint between two markers."""

    kind: Annotated[
        JointKind,
        PlainValidator(scene_values.joint_kind),
        WithJsonSchema({"enum": [*scene_values.JOINT_KINDS]}),
        Field(
            description="revolute (the markers coincide), weld or fixed (nor do the bodies turn against each other), "
            "translational (the second marker stays on a line through the first)."
        ),
    ]
    between: Annotated[TwoPlaces, Field(description='Two markers, such as ["ground.bearing", "crank.hub"].')]
    angle: Annotated[
        Float | None, Field(description="The angle of the second body against the first, rad; not of revolute joints.")
    ] = None
    axis: Annotated[
        Axis | None, Field(description="The direction of the line of a translational joint, in the first body.")
    ] = None

    @model_validator(mode="after")
    def check(self) -> JointTable:
        """Kind and other keys have to go together."""
        if self.kind == "revolute" and self.angle is not None:
            raise values.WrongValueError('a revolute joint turns freely; leave `angle` out, or choose "weld"')
        if self.kind != "translational" and self.axis is not None:
            raise values.WrongValueError(
                f'a {self.kind} joint has no axis; leave `axis` out, or choose "translational"'
            )
        return self

    def joint(self, name: str) -> Joint:
        """The joint as the derivation takes it."""
        axis = (Fraction(1), Fraction(0)) if self.axis is None else self.axis
        return Joint(name, self.kind, *self.between, angle=self.angle or 0.0, axis=axis)


class DriveTable(TomlTable):
    """A joint whose motion is prescribed."""

    joint: Annotated[NameOf, Field(description="The name of a revolute or translational joint.")]
    motion: Annotated[
        Time | None, Field(description='Its angle or displacement as a function of t, such as "0.1*sin(2*pi*t)".')
    ] = None
    speed: Annotated[
        SignedInput | None, Field(description="Instead of a motion, its constant speed: rad/s or m/s.")
    ] = None
    offset: Annotated[Number | None, Field(description="With a speed, the angle or displacement at t = 0.")] = None

    @model_validator(mode="after")
    def check(self) -> DriveTable:
        """One of the two ways to say it."""
        if (self.motion is None) == (self.speed is None):
            raise values.WrongValueError('write either motion = "0.1*sin(2*pi*t)", a function of t, or speed = 150')
        if self.motion is not None and self.offset is not None:
            raise values.WrongValueError("`offset` goes with `speed`; add it to `motion` instead")
        return self

    def drive(self, name: str, kind: JointKind) -> Drive:
        """The drive as the derivation takes it, of a joint of some kind."""
        speed = None if self.speed is None else quantity(self.speed, SPEED_UNITS[kind])
        return Drive(name, self.joint, self.motion, speed, self.offset or Fraction(0))


class ForceTable(TomlTable):
    """A force at a marker."""

    at: Annotated[PlaceInput, Field(description='The marker it acts at, such as "rod.right".')]
    components: Annotated[
        tuple[Time, Time],
        components(("0", '"-10*sin(t)"'), "components"),
        Field(description="Its components in the inertial base, N: numbers, or functions of t."),
    ]

    def force(self, name: str) -> Force:
        """The force as the derivation takes it."""
        return Force(name, self.at, self.components)


class TorqueTable(TomlTable):
    """A torque at a marker."""

    at: Annotated[PlaceInput, Field(description='The marker it acts at, such as "crank.hub".')]
    value: Annotated[Time, Field(description="The torque, N m: a number, or a function of t.")]
    against: Annotated[
        PlaceInput | None, Field(description="The marker that its reaction acts at; nowhere if left out.")
    ] = None

    def torque(self, name: str) -> Torque:
        """The torque as the derivation takes it."""
        return Torque(name, self.at, self.value, self.against)


class SpringTable(TomlTable):
    """A spring with a damper between two markers."""

    kind: Annotated[
        SpringKind,
        PlainValidator(scene_values.spring_kind),
        WithJsonSchema({"enum": [*scene_values.SPRING_KINDS]}),
        Field(description="linear (along the line between the markers), or rotational."),
    ] = "linear"
    between: Annotated[TwoPlaces, Field(description='Two markers, such as ["ground.bearing", "crank.hub"].')]
    stiffness: Annotated[NotNegativeInput, Field(description="N/m, or N m/rad.")]
    damping: Annotated[NotNegativeInput, Field(description="N s/m, or N m s/rad.")] = Fraction(0)
    rest: Annotated[SignedInput, Field(description="Its length without force, m, or its angle, rad.")] = Fraction(0)

    @model_validator(mode="after")
    def check(self) -> SpringTable:
        """A length is not negative; an angle may be."""
        rest = self.rest if isinstance(self.rest, Fraction) else self.rest.default
        if self.kind == "linear" and rest < 0:
            raise values.WrongValueError(
                "`rest` is a length, zero or more; only that of a rotational spring has a sign"
            )
        return self

    def spring(self, name: str) -> Spring:
        """The spring as the derivation takes it."""
        unit = SPRING_UNITS[self.kind]
        return Spring(
            name,
            self.kind,
            *self.between,
            stiffness=quantity(self.stiffness, unit["stiffness"]),
            damping=quantity(self.damping, unit["damping"]),
            rest=quantity(self.rest, unit["rest"]),
        )


class SimulationTable(TomlTable):
    """How long is simulated, and how exactly."""

    duration: Annotated[PositiveFloat, Field(description="How long, s.")]
    output: Annotated[PositiveFloat, Field(description="The time between rows of the output, s.")]
    tolerance: Annotated[
        float,
        PlainValidator(scene_values.tolerance),
        WithJsonSchema(number_schema(exclusiveMinimum=0, exclusiveMaximum=1)),
        Field(description="The relative error that the integrator aims at."),
    ] = 1e-9

    @model_validator(mode="after")
    def check(self) -> SimulationTable:
        """The output has to have a reasonable number of rows."""
        if self.duration < self.output:
            raise values.WrongValueError("`output`, the time between rows, is longer than `duration`; make it shorter")
        if self.duration > MAX_STEPS * self.output:
            raise values.WrongValueError(
                f"the output would have more than {MAX_STEPS} rows; make `duration` shorter or `output` longer"
            )
        return self

    def simulation(self) -> Simulation:
        """The simulation as it is run."""
        return Simulation(self.duration, self.output, self.tolerance)


def _few_piece_counts(value: object) -> object:
    if not isinstance(value, (list, tuple)):
        raise values.WrongValueError(
            f"a list of whole numbers is needed, such as [1, 2, 3], not {values.kind_of(value)}"
        )
    few(len(value), 1, scene_values.MAX_PIECES, "numbers of pieces")
    return value


class ReferenceTable(TomlTable):
    """A curve to compare with: two columns of a CSV file."""

    file: Annotated[Text, Field(description="The CSV file; its path begins at this file.")]
    x: Annotated[Text, Field(description="The column of what the plot is over, as the header of the file names it.")]
    y: Annotated[Text, Field(description="The column of what is plotted.")]


class PlotTable(TomlTable):
    """The distance of a marker from the chord between two others, as a picture."""

    deflection: Annotated[PlaceInput, Field(description="The marker whose distance to the left of the chord is drawn.")]
    chord: Annotated[TwoPlaces, Field(description="The markers that the chord begins and ends at.")]
    divided_by: Annotated[PositiveFloat, Field(description="A length that the distance is divided by, m.")]
    over: Annotated[
        NameOf | None, Field(description="The drive over whose motion it is drawn; over the time if left out.")
    ] = None
    cut: Annotated[NameOf | None, Field(description="The beam that is cut into other numbers of pieces.")] = None
    pieces: Annotated[
        tuple[PieceCount, ...] | None,
        BeforeValidator(_few_piece_counts),
        Field(description="The numbers of pieces, a curve for each."),
    ] = None
    reference: Annotated[ReferenceTable | None, Field(description="A curve to compare with.")] = None

    @model_validator(mode="after")
    def check(self) -> PlotTable:
        """A cut needs to know what is cut, and into how many pieces."""
        if (self.cut is None) != (self.pieces is None):
            raise values.WrongValueError('`cut` and `pieces` go together: write cut = "rod" and pieces = [1, 2, 3]')
        return self

    def plot(self, name: str, rows: Any) -> Plot:
        """The plot as it is drawn; `rows` are the numbers of its reference."""
        known = self.reference
        return Plot(
            name=name,
            quantity=Deflection(self.deflection, *self.chord, self.divided_by),
            over=self.over,
            cut=self.cut,
            pieces=self.pieces or (),
            reference=None if known is None else ReferenceCurve(known.file, known.x, known.y, rows),
        )
