"""Numbers that may be run-time parameters of the generated code, as pydantic types."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Annotated, Any

from pydantic import Field, PlainValidator, WithJsonSchema, create_model

from derive.spec.model.quantity import UNIT, Parameter
from derive.spec.parsing import values
from derive.spec.tables.shared import Example, Name, TomlTable, number_schema, plain_or_table

Unit = Annotated[
    str, PlainValidator(values.unit), WithJsonSchema({"type": "string", "pattern": f"^{values.UNIT_PATTERN}$"})
]


class BaseParameterTable(TomlTable):
    """The keys of all parameters."""

    symbol: Annotated[Name, Field(description="Name in the code and in the equations.")]
    unit: Annotated[Unit | None, Field(description=UNIT.description)] = None
    default: float


def _parameter(
    title: str, doc: str, read: Callable[[object], Fraction], default: Any = ..., **limits: float
) -> tuple[Any, Any]:
    """The types of a number that a function reads, and of a parameter that has such a number as its default."""
    schema = WithJsonSchema(number_schema(**limits))
    number = Annotated[
        float,
        PlainValidator(lambda value: float(read(value))),
        schema,
        Field(description="Default value."),
        Example("default = 0.1"),
    ]
    table = create_model(title, __base__=BaseParameterTable, __doc__=doc, default=(number, default))
    return Annotated[Fraction, PlainValidator(read), schema], table


_positive = _parameter(
    "ParameterTable", "A run-time parameter of the generated code.", values.positive, 1.0, exclusiveMinimum=0
)
_not_negative = _parameter(
    "NotNegativeTable",
    "A number that may be zero as a run-time parameter of the generated code.",
    values.not_negative,
    minimum=0,
)
Number, SIGNED = _parameter(
    "SignedTable", "A number of any sign as a run-time parameter of the generated code.", values.number
)
_nonzero = _parameter(
    "NonzeroTable", "A number that is not zero as a run-time parameter of the generated code.", values.nonzero
)
PositiveQuantity = plain_or_table(*_positive)
NotNegativeQuantity = plain_or_table(*_not_negative)
SignedQuantity = plain_or_table(Number, SIGNED)
NonzeroQuantity = plain_or_table(*_nonzero)


def quantity(value: Any, unit: str) -> Any:
    """A physical constant as the derivation takes it; `unit` is the default unit of a parameter."""
    if isinstance(value, BaseParameterTable):
        return Parameter(value.symbol, value.unit or unit, value.default)
    return value
