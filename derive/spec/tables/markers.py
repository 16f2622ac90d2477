"""Types that the tables of a scene share: references to markers, coordinates, functions of time, named tables."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field, PlainValidator, ValidationInfo, WithJsonSchema

from derive.spec.model.markers import MarkerRef
from derive.spec.model.time_function import TimeFunction
from derive.spec.parsing import scene_values, values
from derive.spec.parsing.parser import MAX_LENGTH
from derive.spec.tables.shared import MAX_MARKERS, Name, SignedInput, components, few, few_markers, number_schema

MAX_NAMED = 100


def few_named(noun: str, example: str) -> BeforeValidator:
    """A validator of a table with a limited number of tables."""

    def check(value: object) -> object:
        if not isinstance(value, Mapping):
            raise values.WrongValueError(
                f"a table of {noun} by their names is needed, such as {example}, not {values.kind_of(value)}"
            )
        few(len(value), 0, MAX_NAMED, noun)
        return value

    return BeforeValidator(check)


Float = Annotated[float, PlainValidator(values.any_float), WithJsonSchema(number_schema())]
PositiveFloat = Annotated[
    float, PlainValidator(values.positive_float), WithJsonSchema(number_schema(exclusiveMinimum=0))
]
FloatPair = Annotated[tuple[Float, Float], components(("0.1", "0"), "numbers")]
NumberPair = Annotated[
    tuple[
        Annotated[Fraction, PlainValidator(values.number), WithJsonSchema(number_schema())],
        Annotated[Fraction, PlainValidator(values.number), WithJsonSchema(number_schema())],
    ],
    components(("1", "0"), "numbers"),
]
Axis = Annotated[NumberPair, AfterValidator(scene_values.axis)]
Coordinates = Annotated[tuple[SignedInput, SignedInput], components(("0.15", "0"), "coordinates")]
PieceCount = Annotated[
    int,
    PlainValidator(scene_values.piece_count),
    WithJsonSchema({"type": "integer", "minimum": 1, "maximum": scene_values.MAX_PIECES}),
]
Markers = Annotated[
    dict[Name, Coordinates],
    few_markers("coordinates"),
    Field(
        description="Named points and their coordinates [x, y], m, in the frame of the body or the inertial frame.",
        json_schema_extra={"maxProperties": MAX_MARKERS, "additionalProperties": False},
    ),
]

_MARKER = {"type": "string", "pattern": r"^[^.]+\.[^.]+$"}
_INPUT = {
    "type": "object",
    "properties": {"input": {"type": "string", "minLength": 1}},
    "required": ["input"],
    "additionalProperties": False,
}
_TIME = {"anyOf": [{"type": "number"}, {"type": "string", "minLength": 1, "maxLength": MAX_LENGTH}, _INPUT]}
_NAMED = {"type": "string", "minLength": 1}


def _function(value: object, info: ValidationInfo) -> TimeFunction:
    """A function of time; the context of the validation contains the names to which it may refer."""
    return scene_values.function(value, info.context)


MarkerInput = Annotated[MarkerRef, PlainValidator(scene_values.marker_ref), WithJsonSchema(_MARKER)]
TwoMarkers = Annotated[tuple[MarkerInput, MarkerInput], components(('"ground.bearing"', '"crank.hub"'), "markers")]
Time = Annotated[TimeFunction, PlainValidator(_function), WithJsonSchema(_TIME)]
NameOf = Annotated[str, PlainValidator(scene_values.name_of), WithJsonSchema(_NAMED)]
Text = Annotated[str, PlainValidator(scene_values.text), WithJsonSchema(_NAMED)]
