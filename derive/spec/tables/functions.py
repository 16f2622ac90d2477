"""The tables to which functions of time refer: parameters of the scene, and tables of values."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, PlainValidator, WithJsonSchema

from derive.spec.parsing import values
from derive.spec.tables.markers import Text
from derive.spec.tables.shared import TomlTable, Unit, number_schema


class FunctionParameterTable(TomlTable):
    """A run-time parameter of the generated code that functions of time call by its name."""

    default: Annotated[
        float,
        PlainValidator(values.any_float),
        WithJsonSchema(number_schema()),
        Field(description="Default value."),
    ]
    unit: Unit = None


class ValuesTable(TomlTable):
    """A table of values, two columns of a CSV file, which functions of time call by its name.

    Between the rows it is a cubic spline with two continuous derivatives; outside them the value is constant.
    """

    file: Annotated[Text, Field(description="CSV file, relative to the specification.")]
    x: Annotated[Text, Field(description="Name of the column of the argument, which increases from row to row.")]
    y: Annotated[Text, Field(description="Name of the column of the values.")]
