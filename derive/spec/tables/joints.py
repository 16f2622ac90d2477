"""The tables of joints; kinds and keys of joints are those of the registry of joints."""

from __future__ import annotations

from functools import cache
from typing import Annotated

from pydantic import Field, create_model, model_validator

from derive.mechanics.multibody.joints.joint_type import JointType
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.spec.model.scene import CustomJoint, Joint
from derive.spec.tables.declared_keys import check_keys, fields_of_kinds, key_values, kind_field
from derive.spec.tables.initial_values import JointStartInput, JointStartTable
from derive.spec.tables.markers import TwoMarkers
from derive.spec.tables.shared import TomlTable


class JointTable(TomlTable):
    """A joint between two markers."""

    kind: str
    between: Annotated[TwoMarkers, Field(description='Two markers, such as ["ground.bearing", "crank.hub"].')]
    start: JointStartInput = JointStartTable()

    @model_validator(mode="after")
    def check(self) -> JointTable:
        """Refuse keys that do not go with the kind."""
        check_keys(self, self.kind, JOINTS, "joint")
        return self

    def joint(self, name: str) -> Joint:
        """The model of the joint that the derivation takes."""
        given = key_values(JOINTS[self.kind].keys, self)
        fields = {key: given.pop(key) for key in ("angle", "axis") if key in given}
        if given:
            return CustomJoint(name, self.kind, *self.between, values=given, start=self.start.start(), **fields)
        return Joint(name, self.kind, *self.between, start=self.start.start(), **fields)


def joint_table() -> type[JointTable]:
    """The table of a joint, with the kinds and keys of all joints that are registered now."""
    return _joint_table(tuple(JOINTS.items()))


@cache
def _joint_table(joints: tuple[tuple[str, JointType], ...]) -> type[JointTable]:
    types = dict(joints)
    kind, keys = kind_field(types, "the joint"), fields_of_kinds(types)
    return create_model("JointTable", __base__=JointTable, __doc__=JointTable.__doc__, kind=kind, **keys)
