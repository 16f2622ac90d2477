"""The units of the numbers in the files of a body, and these files."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Annotated, Any

from pydantic import AfterValidator, PlainValidator, WithJsonSchema

from derive.spec.files.node_format import FILES, LENGTHS, MASSES, TIMES, Units
from derive.spec.parsing.values import WrongValueError
from derive.spec.tables.shared import Example, TomlTable, choice_type, plain_or_table

_FILE = {"type": "string", "minLength": 1}
_FILES = {
    "type": "object",
    "properties": {key: {**_FILE, "description": text} for key, text in FILES.items()},
    "required": ["positions", "mass"],
    "additionalProperties": False,
}


def _unit(table: Mapping[str, Fraction], noun: str, such: str) -> Any:
    """The type of the name of a unit, which is read as the size of the unit."""
    words = choice_type(tuple(table), f"the unit of {noun}")
    return Annotated[words, AfterValidator(lambda name: table[name]), Example(f'{noun} = "{such}"')]


class UnitsTable(TomlTable):
    """Units of the numbers in the files of a body; stiffness is in mass per time squared."""

    length: _unit(LENGTHS, "length", "mm")  # type: ignore[valid-type]  # made of the known units
    mass: _unit(MASSES, "mass", "t")  # type: ignore[valid-type]
    time: _unit(TIMES, "time", "s")  # type: ignore[valid-type]

    def units(self) -> Units:
        """The sizes of the units."""
        return Units(self.length, self.mass, self.time)


def _plain_units(value: object) -> Units:
    if value != "SI":
        raise WrongValueError(
            'units are "SI", or a table of all three such as { length = "mm", mass = "t", time = "s" }'
        )
    return Units()


UnitNames: Any = plain_or_table(
    Annotated[Units, PlainValidator(_plain_units), WithJsonSchema({"const": "SI"})],
    Annotated[UnitsTable, AfterValidator(UnitsTable.units)],
)

Nodes = Annotated[Any, WithJsonSchema({"anyOf": [_FILE, _FILES]})]
"""The type of the files of a body, which are read and checked elsewhere."""
