"""The table of a drive: a joint whose motion is prescribed."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Annotated

from pydantic import Field, model_validator

from derive.mechanics.multibody.joints.registry import JOINTS
from derive.spec.model.scene import Drive
from derive.spec.parsing import values
from derive.spec.tables.initial_values import JointStartInput, JointStartTable
from derive.spec.tables.joints import JointTable
from derive.spec.tables.markers import NameOf, Time
from derive.spec.tables.shared import Number, SignedInput, TomlTable, quantity


class DriveTable(TomlTable):
    """A joint whose motion is prescribed."""

    joint: Annotated[NameOf, Field(description="The name of a revolute or translational joint.")]
    motion: Annotated[
        Time | None, Field(description='Angle, rad, or displacement, m, as a function of t, such as "0.1*sin(2*pi*t)".')
    ] = None
    speed: Annotated[SignedInput | None, Field(description="Constant speed in place of a motion, rad/s or m/s.")] = None
    offset: Annotated[
        Number | None, Field(description="Angle, rad, or displacement, m, at t = 0; only with a speed.")
    ] = None
    start: JointStartInput = JointStartTable()

    @model_validator(mode="after")
    def check(self) -> DriveTable:
        """Either `motion` or `speed` is given."""
        if (self.motion is None) == (self.speed is None):
            raise values.WrongValueError('write either motion = "0.1*sin(2*pi*t)", a function of t, or speed = 150')
        if self.motion is not None and self.offset is not None:
            raise values.WrongValueError("`offset` goes with `speed`; add it to `motion` instead")
        return self

    def drive(self, name: str, joints: Mapping[str, JointTable]) -> Drive:
        """The drive as the derivation takes it, of one of the joints."""
        unit = speed_unit(joints[self.joint].kind) or ""
        speed = None if self.speed is None else quantity(self.speed, unit)
        return Drive(name, self.joint, self.motion, speed, self.offset or Fraction(0), self.start.start())


def speed_unit(kind: str) -> str | None:
    """The unit of the speed of a drive of a joint of some kind; None if there is no such drive."""
    joint_type = JOINTS.get(kind)
    return joint_type.driven.speed_unit if joint_type and joint_type.driven else None
