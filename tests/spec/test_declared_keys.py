"""A key is declared once, on a field: its reading, its refusals, its JSON schema and its writing follow."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Literal

import pytest
from pydantic import TypeAdapter, ValidationError

from derive.spec.as_tables import as_table
from derive.spec.model.keys import KeyType, declared_keys, key
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.parsing.values import WrongValueError
from derive.spec.tables.declared_tables import TABLES, declare
from derive.spec.tables.value_types import VALUE_TYPES


@dataclass(frozen=True)
class Bearing:
    """A bearing of a shaft."""

    stiffness: Annotated[Quantity, key(KeyType.POSITIVE_QUANTITY, "Radial stiffness, N/m.", "N/m")]
    kind: Annotated[Literal["ball", "plain"], key(KeyType.CHOICE, "Its kind.", choice_of="the bearing")] = "ball"
    clearance: Annotated[Fraction, key(KeyType.NOT_NEGATIVE, "Clearance, m.")] = Fraction(0)


@dataclass(frozen=True)
class Shaft:
    """A shaft in bearings."""

    name: str
    bearings: Annotated[Bearing, key(Bearing, "Its bearings.", name="held_by")]
    length: Annotated[float | None, key(KeyType.POSITIVE_FLOAT, "Length, m.")] = None


def no_loose_ball_bearing(bearing: Bearing) -> None:
    if bearing.kind == "ball" and bearing.clearance:
        raise WrongValueError("a ball bearing has no clearance")


@pytest.fixture
def reader():
    declare(Bearing, "BearingTable", check=no_loose_ball_bearing)
    yield TypeAdapter(declare(Shaft, "ShaftTable").value)
    for of in (Bearing, Shaft):
        del TABLES[of]


BEARING = Bearing(Parameter("k", "N/m", 100.0), "plain", Fraction(1, 1000))


def test_a_table_is_read_and_written(reader):
    table = {"held_by": {"stiffness": {"symbol": "k", "default": 100.0}, "kind": "plain", "clearance": "1/1000"}}
    shaft = reader.validate_python(table)
    assert shaft == Shaft("", BEARING)
    written = {"symbol": "k", "unit": "N/m", "default": 100.0}
    assert as_table(shaft) == {"held_by": {"stiffness": written, "kind": "plain", "clearance": Fraction(1, 1000)}}
    assert reader.validate_python(as_table(shaft)) == shaft


@pytest.mark.parametrize(
    ("table", "where", "text"),
    [
        ({"stiffness": -1}, ("held_by", "stiffness", "plain"), "a positive number is needed"),
        ({"stiffness": 1, "kind": "bal"}, ("held_by", "kind"), 'the bearing is one of "ball", "plain"'),
        ({"stiffness": 1, "clearance": 1}, ("held_by",), "a ball bearing has no clearance"),
        ({"stiffness": 1, "play": 1}, ("held_by", "play"), "Extra inputs are not permitted"),
        ({}, ("held_by", "stiffness"), "Field required"),
    ],
)
def test_a_table_is_refused(reader, table, where, text):
    with pytest.raises(ValidationError) as caught:
        reader.validate_python({"held_by": table})
    (fault,) = caught.value.errors()
    assert fault["loc"] == where
    assert text in fault["msg"]


def test_the_json_schema_has_the_docs_and_the_defaults(reader):
    schema = reader.json_schema()
    assert schema["description"] == "A shaft in bearings."
    of_bearing = schema["$defs"]["BearingTable"]
    assert of_bearing["required"] == ["stiffness"]
    assert of_bearing["properties"]["kind"]["enum"] == ["ball", "plain"]
    assert of_bearing["properties"]["kind"]["default"] == "ball"
    assert of_bearing["properties"]["stiffness"]["description"] == "Radial stiffness, N/m."


def test_keys_have_the_names_and_the_defaults_of_their_fields():
    assert [(k.field, k.name, k.required, k.default) for k in declared_keys(Shaft)] == [
        ("bearings", "held_by", True, None),
        ("length", "length", False, None),
    ]


def test_every_type_of_value_is_read():
    assert {*VALUE_TYPES} == {*KeyType} - {KeyType.CHOICE}
