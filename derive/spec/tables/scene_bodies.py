"""The tables of the bodies of a scene, and of the ground."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Annotated, Any

from pydantic import AfterValidator, Field, create_model

from derive.mechanics.multibody.bodies.body_type import BodyType
from derive.mechanics.multibody.bodies.registry import BODIES
from derive.spec.model.instances import COUNT
from derive.spec.model.keys import declared_keys
from derive.spec.model.planar_bodies import BeamBody, CustomBody, RigidBody, SceneBody
from derive.spec.tables.beam import BEAM_BODY
from derive.spec.tables.declared_tables import DeclaredTable, declare, key_field, keyed_model, named
from derive.spec.tables.registered_tables import key_values
from derive.spec.tables.shared import ElementName, one_of

RIGID = declare(RigidBody, "RigidTable", keys=(*declared_keys(RigidBody), COUNT))
_OWN = {"rigid": RIGID, "beam": BEAM_BODY}


def body_tables() -> dict[str, DeclaredTable]:
    """The tables of all types of bodies that are registered now."""
    return {kind: _OWN.get(kind) or _custom_table(kind, body_type) for kind, body_type in BODIES.items()}


@cache
def _custom_table(kind: str, body_type: BodyType[Any]) -> DeclaredTable:
    """The table of a body of a type that is registered from outside the package."""
    keys: dict[str, Any] = {key.name: key_field(key, key.required) for key in body_type.keys}
    title, own = f"{kind.capitalize()}Table", declared_keys(CustomBody)
    model = create_model(title, __base__=keyed_model(title, None, (*own, COUNT)), __doc__=body_type.doc, **keys)

    def made(table: Any) -> CustomBody:
        values = {key.field: getattr(table, key.name) for key in own}
        return CustomBody("", kind, key_values(body_type.keys, table), **values)

    return DeclaredTable(model, Annotated[model, AfterValidator(made)])


def kind_of_scene_body(value: Any) -> str:
    """The kind of body that a table describes: a discriminator."""
    if isinstance(value, Mapping):
        for kind, body_type in BODIES.items():
            if any(key in value for key in body_type.identifying_keys):
                return kind
    return "rigid"


def bodies_field(tables: Mapping[str, DeclaredTable]) -> Any:
    """The table of the bodies of a scene, each of which is described by one of the tables."""

    def made(bodies: tuple[SceneBody, ...]) -> tuple[SceneBody, ...]:
        return tuple(replace(b, beam=replace(b.beam, name=b.name)) if isinstance(b, BeamBody) else b for b in bodies)

    body = one_of(kind_of_scene_body, **{kind: table.value for kind, table in tables.items()})
    return Annotated[
        named(body, "bodies", "[bodies.rod]", ElementName, minProperties=1),
        AfterValidator(made),
        Field(description="Bodies of a scene by name: beams and rigid bodies."),
    ]
