"""The table of a drive: a joint whose motion is prescribed."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Annotated

from pydantic import (
    BeforeValidator,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)

from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.time_integrals.closed_form import NoClosedForm, time_integral
from derive.spec.model.scene import Drive
from derive.spec.model.time_function import TimeFunction, value_at
from derive.spec.parsing import scene_values, values
from derive.spec.parsing.parser import MAX_LENGTH
from derive.spec.parsing.time_text import function_text
from derive.spec.tables.initial_values import JointStartInput, JointStartTable
from derive.spec.tables.joints import JointTable
from derive.spec.tables.markers import NameOf, Time
from derive.spec.tables.shared import Number, SignedTable, TomlTable, quantity, written_as


def _speed(value: object, info: ValidationInfo) -> Fraction | TimeFunction:
    """A number, or a function of the time whose integral is known."""
    if not isinstance(value, (str, TimeFunction)):
        return values.number(value)
    function = scene_values.function(value, info.context)
    if function.kind == "number":
        return function.value
    try:
        value_at(time_integral(function), 0.0)
    except (ArithmeticError, ValueError):
        raise values.WrongValueError(
            f"the integral of {function_text(function)} has no value at t = 0 with the defaults of the parameters, "
            "which happens where a parameter that it divides by is zero; write the `motion` in place of the speed"
        ) from None
    except NoClosedForm as error:
        part = "this speed" if error.part is None else function_text(error.part)
        raise values.WrongValueError(
            f"the integral of {part}, which the motion would be, has no closed form that is known here; write the "
            "`motion` in place of the speed, or the speed as a table of values, see [tables.NAME]"
        ) from None
    return function


def _no_input(value: object) -> object:
    if isinstance(value, Mapping) and "input" in value:
        raise values.WrongValueError(
            'a run-time input prescribes the motion, not the speed: write motion = { input = "motor" }, with whose '
            "values the generated code takes their first and second time derivatives"
        )
    return value


_SPEED = {"anyOf": [{"type": "number"}, {"type": "string", "minLength": 1, "maxLength": MAX_LENGTH}]}
SpeedInput = Annotated[
    Annotated[Fraction | TimeFunction, PlainValidator(_speed), WithJsonSchema(_SPEED), Tag("plain")]
    | Annotated[SignedTable, Tag("table")],
    Discriminator(written_as),
    BeforeValidator(_no_input),
]


class DriveTable(TomlTable):
    """A joint whose motion is prescribed."""

    joint: Annotated[NameOf, Field(description="The name of a revolute or translational joint.")]
    motion: Annotated[
        Time | None, Field(description='Angle, rad, or displacement, m, as a function of t, such as "0.1*sin(2*pi*t)".')
    ] = None
    speed: Annotated[
        SpeedInput | None,
        Field(
            description="Speed in place of a motion, rad/s or m/s: a number, a parameter, or a function of t, such as "
            '"150*step(t, 0, 0.3)", whose integral from t = 0 the motion is.'
        ),
    ] = None
    offset: Annotated[
        Number | None, Field(description="Angle, rad, or displacement, m, at t = 0; only with a speed.")
    ] = None
    start: JointStartInput = JointStartTable()

    @model_validator(mode="after")
    def check(self) -> DriveTable:
        """Require either `motion` or `speed`, and refuse `offset` with `motion`."""
        if (self.motion is None) == (self.speed is None):
            raise values.WrongValueError('write either motion = "0.1*sin(2*pi*t)", a function of t, or speed = 150')
        if self.motion is not None and self.offset is not None:
            raise values.WrongValueError("`offset` goes with `speed`; add it to `motion` instead")
        return self

    def drive(self, name: str, joints: Mapping[str, JointTable]) -> Drive:
        """The model of the drive of one of the joints that the derivation takes."""
        unit = speed_unit(joints[self.joint].kind) or ""
        speed = self.speed if self.speed is None or isinstance(self.speed, TimeFunction) else quantity(self.speed, unit)
        return Drive(name, self.joint, self.motion, speed, self.offset or Fraction(0), self.start.start())


def speed_unit(kind: str) -> str | None:
    """The unit of the speed of a drive of a joint of some kind; None if there is no such drive."""
    joint_type = JOINTS.get(kind)
    return joint_type.driven.speed_unit if joint_type and joint_type.driven else None
