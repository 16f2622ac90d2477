"""The tables of joints; kinds and keys of joints are those of the registry of joints."""

from __future__ import annotations

from functools import cache
from typing import Annotated, Any, assert_never

from pydantic import Field, PlainValidator, WithJsonSchema, create_model, model_validator

from derive.mechanics.multibody.joints.joint_type import JointType
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.keys import Key, KeyType
from derive.spec.model.scene import CustomJoint, Joint
from derive.spec.parsing import values
from derive.spec.tables.markers import Axis, Float, TwoMarkers
from derive.spec.tables.shared import Positive, QuantityInput, TomlTable, quantity


class JointTable(TomlTable):
    """A joint between two markers."""

    kind: str
    between: Annotated[TwoMarkers, Field(description='Two markers, such as ["ground.bearing", "crank.hub"].')]

    @model_validator(mode="after")
    def check(self) -> JointTable:
        """Kind and other keys have to go together."""
        joint_type = JOINTS[self.kind]
        own = {key.name for key in joint_type.keys}
        for key in _keys(tuple(JOINTS.items())):
            given = getattr(self, key.name) is not None
            if given and key.name not in own:
                kinds = [f'"{kind}"' for kind, other in JOINTS.items() if key.name in {k.name for k in other.keys}]
                raise values.WrongValueError(
                    f"a {self.kind} joint has no {key.name}; leave `{key.name}` out, or choose {_either(kinds)}"
                )
            if key.required and key.name in own and not given:
                text = key.description[:1].lower() + key.description[1:].rstrip(".")
                raise values.WrongValueError(f"a {self.kind} joint needs the key `{key.name}`: {text}")
        return self

    def joint(self, name: str) -> Joint:
        """The joint as the derivation takes it."""
        given = {key.name: key_value(key, getattr(self, key.name)) for key in JOINTS[self.kind].keys}
        given = {key: value for key, value in given.items() if value is not None}
        fields = {key: given.pop(key) for key in ("angle", "axis") if key in given}
        if given:
            return CustomJoint(name, self.kind, *self.between, values=given, **fields)
        return Joint(name, self.kind, *self.between, **fields)


def joint_table() -> type[JointTable]:
    """The table of a joint, with the kinds and keys of all joints that are registered now."""
    return _joint_table(tuple(JOINTS.items()))


@cache
def _joint_table(joints: tuple[tuple[str, JointType], ...]) -> type[JointTable]:
    kinds = tuple(name for name, _ in joints)
    kind = Annotated[
        str,
        PlainValidator(lambda value: values.choice(value, kinds, "the joint")),
        WithJsonSchema({"enum": [*kinds]}),
        Field(description=_kinds_text(joints)),
    ]
    keys: dict[str, Any] = {key.name: key_field(key) for key in _keys(joints)}
    return create_model("JointTable", __base__=JointTable, __doc__=JointTable.__doc__, kind=(kind, ...), **keys)


def _keys(joints: tuple[tuple[str, JointType], ...]) -> tuple[Key, ...]:
    """The keys of all joints, each once."""
    return tuple({key.name: key for _, joint in joints for key in joint.keys}.values())


def _kinds_text(joints: tuple[tuple[str, JointType], ...]) -> str:
    names: dict[JointType, list[str]] = {}
    for name, joint in joints:
        names.setdefault(joint, []).append(name)
    return ", ".join(f"{' or '.join(of)} ({joint.doc})" for joint, of in names.items()) + "."


def _either(names: list[str]) -> str:
    return f"{', '.join(names[:-1])} or {names[-1]}" if len(names) > 1 else names[0]


def key_field(key: Key, required: bool = False) -> tuple[Any, Any]:
    """A key that a joint or a body declares, as a field of a pydantic model."""
    match key.type:
        case KeyType.FLOAT:
            annotation: Any = Float
        case KeyType.DIRECTION:
            annotation = Axis
        case KeyType.POSITIVE:
            annotation = Positive
        case KeyType.POSITIVE_QUANTITY:
            annotation = QuantityInput
        case _ as never:
            assert_never(never)
    field = Field(description=key.description)
    return (Annotated[annotation, field], ...) if required else (Annotated[annotation | None, field], None)


def key_value(key: Key, value: Any) -> Any:
    """The value of a key as the derivation takes it."""
    return quantity(value, key.unit) if key.type is KeyType.POSITIVE_QUANTITY and value is not None else value
