"""The tables of forces, torques and springs; kinds of springs are those of the registry of forces."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import Annotated, Any

from pydantic import Field, PlainValidator, WithJsonSchema, create_model, model_validator

from derive.mechanics.multibody.forces.force_type import ForceType
from derive.mechanics.multibody.forces.registry import FORCES
from derive.spec.model.scene import Force, Spring, Torque
from derive.spec.parsing import values
from derive.spec.tables.markers import MarkerInput, Time, TwoMarkers
from derive.spec.tables.shared import NotNegativeInput, SignedInput, TomlTable, components, quantity


class ForceTable(TomlTable):
    """A force at a marker."""

    at: Annotated[MarkerInput, Field(description='Marker at which it acts, such as "rod.right".')]
    components: Annotated[
        tuple[Time, Time],
        components(("0", '"-10*sin(t)"'), "components"),
        Field(description="Components in the inertial frame, N: numbers, or functions of t."),
    ]

    def force(self, name: str) -> Force:
        """The force as the derivation takes it."""
        return Force(name, self.at, self.components)


class TorqueTable(TomlTable):
    """A torque at a marker."""

    at: Annotated[MarkerInput, Field(description='Marker at which it acts, such as "crank.hub".')]
    value: Annotated[Time, Field(description="Torque, N m: a number, or a function of t.")]
    against: Annotated[
        MarkerInput | None, Field(description="Marker at which the reaction acts; by default there is no reaction.")
    ] = None

    def torque(self, name: str) -> Torque:
        """The torque as the derivation takes it."""
        return Torque(name, self.at, self.value, self.against)


class SpringTable(TomlTable):
    """A spring with a damper between two markers."""

    kind: str = "linear"
    between: Annotated[TwoMarkers, Field(description='Two markers, such as ["ground.bearing", "crank.hub"].')]
    stiffness: Annotated[NotNegativeInput, Field(description="Stiffness, N/m or N m/rad.")]
    damping: Annotated[NotNegativeInput, Field(description="Damping constant, N s/m or N m s/rad.")] = Fraction(0)
    rest: Annotated[
        SignedInput, Field(description="Length, m, or angle, rad, at which the spring exerts no force.")
    ] = Fraction(0)

    @model_validator(mode="after")
    def check(self) -> SpringTable:
        """A length is not negative; an angle may be. Other kinds may do without some keys."""
        for key in ("damping", "rest"):
            if key not in FORCES[self.kind].units and getattr(self, key) != 0:
                raise values.WrongValueError(f"a {self.kind} spring has no {key}; leave `{key}` out")
        rest = self.rest if isinstance(self.rest, Fraction) else self.rest.default
        if "rest" in FORCES[self.kind].lengths and rest < 0:
            raise values.WrongValueError(
                "`rest` is a length, zero or more; only that of a rotational spring has a sign"
            )
        return self

    def spring(self, name: str) -> Spring:
        """The spring as the derivation takes it."""
        units = FORCES[self.kind].units
        return Spring(
            name,
            self.kind,
            *self.between,
            stiffness=quantity(self.stiffness, units.get("stiffness", "")),
            damping=quantity(self.damping, units.get("damping", "")),
            rest=quantity(self.rest, units.get("rest", "")),
        )


def spring_kinds() -> dict[str, ForceType[Any]]:
    """What `kind` may be in the table of a spring, with the types."""
    return {kind: force_type for kind, force_type in FORCES.items() if force_type.section == "springs"}


def spring_table() -> type[SpringTable]:
    """The table of a spring, with all kinds that are registered now."""
    return _spring_table(tuple(spring_kinds().items()))


@cache
def _spring_table(springs: tuple[tuple[str, ForceType[Any]], ...]) -> type[SpringTable]:
    kinds = tuple(kind for kind, _ in springs)
    texts = [f"{kind} ({of.doc})" if of.doc else kind for kind, of in springs]
    kind = Annotated[
        str,
        PlainValidator(lambda value: values.choice(value, kinds, "the spring")),
        WithJsonSchema({"enum": [*kinds]}),
        Field(description=f"{', '.join(texts[:-1])}, or {texts[-1]}."),
    ]
    return create_model("SpringTable", __base__=SpringTable, __doc__=SpringTable.__doc__, kind=(kind, "linear"))
