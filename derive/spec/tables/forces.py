"""The tables of forces, torques and springs; their kinds and keys are those of the registry of forces."""

from __future__ import annotations

from functools import cache
from typing import Annotated, Any, ClassVar

from pydantic import Field, create_model, model_validator

from derive.mechanics.multibody.forces.force_type import ForceType
from derive.mechanics.multibody.forces.registry import DEFAULT_KINDS, FORCES, kinds
from derive.spec.model.forces import SceneForce
from derive.spec.model.markers import MarkerRef
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import NAMED
from derive.spec.parsing import values
from derive.spec.tables.declared_keys import check_keys, fields_of_kinds, key_values, kind_field
from derive.spec.tables.markers import MarkerInput, TwoMarkers
from derive.spec.tables.shared import TomlTable


class AnyForceTable(TomlTable):
    """What the tables of forces, torques and springs have in common."""

    section: ClassVar[str]
    kind: str

    @property
    def markers(self) -> tuple[MarkerRef, ...]:
        """The markers at which the element acts."""
        raise NotImplementedError

    @model_validator(mode="after")
    def check(self) -> AnyForceTable:
        """Refuse keys that do not go with the kind, and negative lengths."""
        check_keys(self, self.kind, kinds(self.section), NAMED[self.section])
        force_type = FORCES[self.kind]
        for key, value in key_values(force_type.keys, self).items():
            if key in force_type.lengths and (value.default if isinstance(value, Parameter) else value) < 0:
                raise values.WrongValueError(
                    f"`{key}` is a length, zero or more; only that of a rotational spring has a sign"
                )
        return self

    def force(self, name: str) -> SceneForce:
        """The model of the element that the derivation takes."""
        force_type = FORCES[self.kind]
        return force_type.element(name, self.kind, self.markers, key_values(force_type.keys, self))


class ForceTable(AnyForceTable):
    """A force at a marker."""

    section = "forces"
    at: Annotated[MarkerInput, Field(description='Marker at which it acts, such as "rod.right".')]

    @property
    def markers(self) -> tuple[MarkerRef, ...]:
        """The marker at which the force acts."""
        return (self.at,)


class TorqueTable(AnyForceTable):
    """A torque at a marker."""

    section = "torques"
    at: Annotated[MarkerInput, Field(description='Marker at which it acts, such as "crank.hub".')]
    against: Annotated[
        MarkerInput | None, Field(description="Marker at which the reaction acts; by default there is no reaction.")
    ] = None

    @property
    def markers(self) -> tuple[MarkerRef, ...]:
        """The marker at which the torque acts, and that of its reaction, if there is one."""
        return (self.at,) if self.against is None else (self.at, self.against)


class SpringTable(AnyForceTable):
    """A spring with a damper between two markers."""

    section = "springs"
    between: Annotated[TwoMarkers, Field(description='Two markers, such as ["ground.bearing", "crank.hub"].')]

    @property
    def markers(self) -> tuple[MarkerRef, ...]:
        """The two markers between which the spring acts."""
        return self.between


_TABLES: dict[str, type[AnyForceTable]] = {table.section: table for table in (ForceTable, TorqueTable, SpringTable)}


def force_table(section: str) -> type[AnyForceTable]:
    """The table of an element of a section, with all kinds that are registered now."""
    return _force_table(section, tuple(kinds(section).items()))


@cache
def _force_table(section: str, types: tuple[tuple[str, ForceType[Any]], ...]) -> type[AnyForceTable]:
    base, kind = _TABLES[section], kind_field(dict(types), f"the {NAMED[section]}", DEFAULT_KINDS[section])
    keys = fields_of_kinds(dict(types))
    return create_model(base.__name__, __base__=base, __doc__=base.__doc__, kind=kind, **keys)
