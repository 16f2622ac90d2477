"""Types that the tables of all specifications share: names, numbers and parameters as pydantic types.

Values are read by the functions of `values`; a model lists the keys of a table with their meaning.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Annotated, Any

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    WithJsonSchema,
)

from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.parsing import values
from derive.spec.parsing.names import MAX_LENGTH as MAX_NAME
from derive.spec.parsing.names import PATTERN as NAME_PATTERN
from derive.spec.parsing.polynomial import MAX_LENGTH

MAX_MARKERS = 64


def few(count: int, least: int, most: int, noun: str) -> None:
    """Refuse a number of elements that is not allowed, before the elements are validated one by one."""
    if not least <= count <= most:
        raise values.WrongValueError(f"there are {count} {noun}, and {least} to {most} are allowed")


def few_markers(what: str) -> BeforeValidator:
    """A validator of a table with a limited number of markers; `what` names their values in messages."""

    def check(value: object) -> object:
        if not isinstance(value, Mapping):
            raise values.WrongValueError(f"a table of names and {what} is needed, not {values.kind_of(value)}")
        few(len(value), 0, MAX_MARKERS, "markers")
        return value

    return BeforeValidator(check)


def number_schema(**limits: float) -> dict[str, Any]:
    """The JSON schema of a number."""
    exact = {"type": "string", "maxLength": MAX_LENGTH, "description": 'An exact number, such as "1/3".'}
    return {"anyOf": [{"type": "number", **limits}, exact]}


def written_as(value: Any) -> str:
    """The discriminator of the two forms of a value."""
    return "table" if isinstance(value, Mapping) else "plain"


_NAME = {"type": "string", "pattern": f"^{NAME_PATTERN}$", "maxLength": MAX_NAME}
_UNIT = {"type": "string", "pattern": f"^{values.UNIT_PATTERN}$"}
_POSITIVE = number_schema(exclusiveMinimum=0)
_NOT_NEGATIVE = number_schema(minimum=0)


class TomlTable(BaseModel):
    """A table in which every key is known."""

    model_config = ConfigDict(extra="forbid", frozen=True)


Name = Annotated[str, PlainValidator(values.name), WithJsonSchema(_NAME)]
Number = Annotated[Fraction, PlainValidator(values.number), WithJsonSchema(number_schema())]
Positive = Annotated[Fraction, PlainValidator(values.positive), WithJsonSchema(_POSITIVE)]
NotNegative = Annotated[Fraction, PlainValidator(values.not_negative), WithJsonSchema(_NOT_NEGATIVE)]
Truth = Annotated[bool, PlainValidator(values.truth), WithJsonSchema({"type": "boolean"})]
Symbol = Annotated[Name, Field(description="Name in the code and in the equations.")]
Unit = Annotated[
    str | None,
    PlainValidator(values.unit),
    WithJsonSchema(_UNIT),
    Field(description="Unit in comments and in the report; by default the SI unit."),
]


class ParameterTable(TomlTable):
    """A run-time parameter of the generated code."""

    symbol: Symbol
    unit: Unit = None
    default: Annotated[
        float,
        PlainValidator(values.positive_float),
        WithJsonSchema(_POSITIVE),
        Field(description="Default value."),
    ] = 1.0


class NotNegativeTable(TomlTable):
    """A number that may be zero as a run-time parameter of the generated code."""

    symbol: Symbol
    unit: Unit = None
    default: Annotated[
        float,
        PlainValidator(values.not_negative_float),
        WithJsonSchema(_NOT_NEGATIVE),
        Field(description="Default value."),
    ]


class SignedTable(TomlTable):
    """A number of any sign as a run-time parameter of the generated code."""

    symbol: Symbol
    unit: Unit = None
    default: Annotated[
        float,
        PlainValidator(values.any_float),
        WithJsonSchema(number_schema()),
        Field(description="Default value."),
    ]


QuantityInput = Annotated[
    Annotated[Positive, Tag("plain")] | Annotated[ParameterTable, Tag("table")], Discriminator(written_as)
]
NotNegativeInput = Annotated[
    Annotated[NotNegative, Tag("plain")] | Annotated[NotNegativeTable, Tag("table")], Discriminator(written_as)
]
SignedInput = Annotated[
    Annotated[Number, Tag("plain")] | Annotated[SignedTable, Tag("table")], Discriminator(written_as)
]


def quantity(value: Fraction | ParameterTable | NotNegativeTable | SignedTable, unit: str) -> Quantity:
    """A physical constant in the form that the derivation takes; `unit` is the default unit of a parameter."""
    return value if isinstance(value, Fraction) else Parameter(value.symbol, value.unit or unit, value.default)


def acceleration(value: Fraction | SignedTable) -> Quantity:
    """A component of gravity in the form that the derivation takes."""
    return quantity(value, "m/s^2")


def components(example: Sequence[str], noun: str = "components") -> BeforeValidator:
    """A validator of a list with as many elements as the example."""

    def check(value: object) -> object:
        if not isinstance(value, (list, tuple)) or len(value) != len(example):
            given = f"{len(value)}" if isinstance(value, (list, tuple)) else values.kind_of(value)
            raise values.WrongValueError(
                f"a list of {len(example)} {noun} is needed, such as [{', '.join(example)}], not {given}"
            )
        return tuple(value)

    return BeforeValidator(check)


_GRAVITY = Field(
    description="Acceleration of free fall in the inertial frame, m/s^2; each component a parameter or a number."
)
PlanarGravity = Annotated[tuple[SignedInput, SignedInput] | None, components(("0", "-9.81")), _GRAVITY]
SpatialGravity = Annotated[
    tuple[SignedInput, SignedInput, SignedInput] | None, components(("0", "0", "-9.81")), _GRAVITY
]
