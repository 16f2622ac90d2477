"""The pydantic type of each type of value: the function that reads it, and its JSON schema."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, PlainValidator, ValidationInfo, WithJsonSchema

from derive.mechanics.multibody.space.rows import RELATIVE_MOTIONS
from derive.spec.files.nodal_forces import MAX_LOADED
from derive.spec.model.beam_parts import DEFAULT_LENGTH, INERTIA_UNIT, Marker, Polynomial
from derive.spec.model.body import ACCELERATION_UNIT
from derive.spec.model.keys import KeyType
from derive.spec.model.markers import MarkerRef, PointMarker
from derive.spec.model.node_markers import NodeMarker
from derive.spec.model.quantity import Quantity
from derive.spec.model.time_function import TimeFunction
from derive.spec.model.visuals import Mesh
from derive.spec.parsing import scene_values, values
from derive.spec.parsing.parser import MAX_LENGTH
from derive.spec.tables.bushings import BushingMatrix
from derive.spec.tables.quantities import (
    NonzeroQuantity,
    NotNegativeQuantity,
    Number,
    PositiveQuantity,
    SignedQuantity,
    Unit,
    quantity,
)
from derive.spec.tables.rotation import Rotation, Triple
from derive.spec.tables.shared import MAX_MARKERS, Name, SchemaExtra, choice_type, components, few, number_schema
from derive.spec.tables.speeds import Speed
from derive.spec.tables.units import Nodes, UnitNames

MAX_CURVES = 12
"""The largest number of curves of a plot of columns."""
MAX_AROUND = 1000
MAX_SHAPES = 20
MAX_DIGITS = 800


def _read(of: Any, reader: Callable[..., Any], schema: Mapping[str, Any]) -> Any:
    """The type of a value that a function reads."""
    return Annotated[of, PlainValidator(reader), WithJsonSchema(dict(schema))]


def _pair(of: Any, example: tuple[str, str], noun: str) -> Any:
    """The type of a list of two values."""
    return Annotated[tuple[of, of], components(example, noun)]


def several_type(of: Any, least: int, most: int, noun: str, needed: str) -> Any:
    """The type of a list with a limited number of elements; `needed` describes it in messages."""

    def check(value: object) -> object:
        if not isinstance(value, (list, tuple)):
            raise values.WrongValueError(f"a list of {needed}, not {values.kind_of(value)}")
        few(len(value), least, most, noun)
        return tuple(value)

    return Annotated[tuple[of, ...], BeforeValidator(check)]


def markers_type(place: Any, noun: str, marker: Callable[[str, Any], object]) -> Any:
    """The type of a limited number of markers by their names; `noun` names their places in messages."""

    def check(value: object) -> object:
        if not isinstance(value, Mapping):
            raise values.WrongValueError(f"a table of names and {noun} is needed, not {values.kind_of(value)}")
        few(len(value), 0, MAX_MARKERS, "markers")
        return value

    def made(places: Mapping[str, Any]) -> tuple[object, ...]:
        return tuple(marker(name, at) for name, at in places.items())

    schema = SchemaExtra(maxProperties=MAX_MARKERS, additionalProperties=False)
    return Annotated[dict[Name, place], BeforeValidator(check), AfterValidator(made), schema]


def _quantities(example: tuple[str, ...], unit: str, noun: str = "components") -> Any:
    """The type of a list of quantities of either sign, as many as in the example."""

    def with_unit(of: tuple[Any, ...]) -> tuple[Quantity, ...]:
        return tuple(quantity(component, unit) for component in of)

    signed: Any = (SignedQuantity,) * len(example)
    return Annotated[tuple[signed], components(example, noun), AfterValidator(with_unit)]


def _function(value: object, info: ValidationInfo) -> TimeFunction:
    """A function of time; the context of the validation contains the names to which it may refer."""
    return scene_values.function(value, info.context)


def _mesh(value: object) -> Mesh | str:
    """A mesh, which has been read before, or the name of its file where it cannot be read."""
    return value if isinstance(value, Mesh) else scene_values.text(value)


def _columns(value: object) -> object:
    if isinstance(value, str):
        return (value,)
    if not isinstance(value, (list, tuple)):
        kind = values.kind_of(value)
        raise values.WrongValueError(f'a column or a list of columns is needed, such as ["rod_phi"], not {kind}')
    few(len(value), 1, MAX_CURVES, "columns")
    return value


def _columns_of(text: Any) -> Any:
    several = {"type": "array", "items": {"type": "string"}, "minItems": 1, "maxItems": MAX_CURVES}
    return Annotated[tuple[text, ...], BeforeValidator(_columns), WithJsonSchema({"anyOf": [_TEXT, several]})]


def _few_digits(ansatz: tuple[Polynomial, ...]) -> tuple[Polynomial, ...]:
    # Shapes are computed exactly, and their fractions are about as long as those of the whole ansatz together.
    digits = sum(values.digits(shape) for shape in ansatz)
    if digits > MAX_DIGITS:
        raise values.WrongValueError(
            f"over common denominators, the coefficients of the ansatz have {digits} digits, and at most "
            f"{MAX_DIGITS} are allowed; round them"
        )
    return ansatz


def _family_count(value: object) -> int:
    count = values.whole(value)
    if not 1 <= count <= MAX_SHAPES:
        raise values.WrongValueError(f"1 to {MAX_SHAPES} shapes of a family are allowed, not {values.shown(count)}")
    return count


_NUMBER: Mapping[str, Any] = {"type": "number"}
_TEXT: Mapping[str, Any] = {"type": "string", "minLength": 1}
_FORMULA = {**_TEXT, "maxLength": MAX_LENGTH}
_INPUT = {"type": "object", "properties": {"input": _TEXT}, "required": ["input"], "additionalProperties": False}
_COUNT: Mapping[str, Any] = {"type": "integer", "minimum": 0}
MODE_COUNT_SCHEMA: dict[str, Any] = {**_COUNT, "maximum": values.MAX_MODES}
"""The JSON schema of a number of modes."""

_float = _read(float, values.any_float, number_schema())
_time = _read(TimeFunction, _function, {"anyOf": [_NUMBER, _FORMULA, _INPUT]})
_marker = _read(MarkerRef, scene_values.marker_ref, {"type": "string", "pattern": r"^[^.]+\.[^.]+$"})
_name_of = _read(str, scene_values.name_of, _TEXT)
_text = _read(str, scene_values.text, _TEXT)
_shape = _read(Polynomial, values.shape, _FORMULA)
_load = _read(Polynomial, values.load_polynomial, {"anyOf": [_NUMBER, _FORMULA]})
_pieces = _read(int, scene_values.piece_count, {**_COUNT, "minimum": 1, "maximum": scene_values.MAX_PIECES})
_position = _read(Fraction, values.beam_position, number_schema(minimum=-1, maximum=1))
_coordinates = _quantities(("0.15", "0"), DEFAULT_LENGTH.unit, "coordinates")
_count = _read(int, values.whole, _COUNT)

COORDINATE_TRIPLE = _quantities(("0.1", "0", "0"), DEFAULT_LENGTH.unit, "coordinates")
"""The type of three coordinates, m."""
_relative_motion = choice_type(RELATIVE_MOTIONS, "a relative motion")

VALUE_TYPES: dict[KeyType, Any] = {
    KeyType.TRUTH: _read(bool, values.truth, {"type": "boolean"}),
    KeyType.FLOAT: _float,
    KeyType.POSITIVE_FLOAT: _read(float, values.positive_float, number_schema(exclusiveMinimum=0)),
    KeyType.TOLERANCE: _read(float, scene_values.tolerance, number_schema(exclusiveMinimum=0, exclusiveMaximum=1)),
    KeyType.FLOAT_PAIR: _pair(_float, ("0.1", "0"), "numbers"),
    KeyType.TRIPLE: Triple,
    KeyType.ROTATION: Rotation,
    KeyType.AMPLITUDES: Annotated[
        several_type(_float, 0, values.MAX_MODES, "amplitudes", "numbers is needed, such as [1e-3, 0]"),
        SchemaExtra(maxItems=values.MAX_MODES),
    ],
    KeyType.NUMBER: Number,
    KeyType.POSITIVE: _read(Fraction, values.positive, number_schema(exclusiveMinimum=0)),
    KeyType.NOT_NEGATIVE: _read(Fraction, values.not_negative, number_schema(minimum=0)),
    KeyType.POSITION: _position,
    KeyType.DIRECTION: Annotated[_pair(Number, ("1", "0"), "numbers"), AfterValidator(scene_values.axis)],
    KeyType.COORDINATE_TRIPLE: COORDINATE_TRIPLE,
    KeyType.INERTIA_TENSOR: _quantities(("0.01", "0.02", "0.02", "0", "0", "0"), INERTIA_UNIT, "entries"),
    KeyType.WEIGHTS: several_type(
        _read(Fraction, values.positive, number_schema(exclusiveMinimum=0)),
        1,
        MAX_AROUND,
        "weights",
        "weights is needed, such as [1, 1, 2]",
    ),
    KeyType.LOADED_NODES: Annotated[
        several_type(_count, 0, MAX_LOADED, "nodes", "nodes is needed, such as [3, 4, 5]"),
        SchemaExtra(maxItems=MAX_LOADED),
    ],
    KeyType.NODAL_FORCES: several_type(
        Annotated[tuple[Number, Number, Number], components(("0", "0", "-5"), "components")],
        0,
        MAX_LOADED,
        "forces",
        "forces is needed, such as [[0, 0, -5], [0, 0, -10]]",
    ),
    KeyType.RELATIVE_MOTIONS: several_type(
        _relative_motion, 1, len(RELATIVE_MOTIONS), "relative motions", 'words is needed, such as ["x", "y"]'
    ),
    KeyType.POSITIVE_QUANTITY: PositiveQuantity,
    KeyType.NOT_NEGATIVE_QUANTITY: NotNegativeQuantity,
    KeyType.QUANTITY: SignedQuantity,
    KeyType.NONZERO_QUANTITY: NonzeroQuantity,
    KeyType.COORDINATES: _coordinates,
    KeyType.PLANAR_ACCELERATION: _quantities(("0", "-9.81"), ACCELERATION_UNIT),
    KeyType.ACCELERATION: _quantities(("0", "0", "-9.81"), ACCELERATION_UNIT),
    KeyType.SPEED: Speed,
    KeyType.FUNCTION: _time,
    KeyType.FUNCTION_TRIPLE: Annotated[
        tuple[_time, _time, _time],  # type: ignore[valid-type]  # a type that is made
        components(("0", "0", '"-10*sin(t)"'), "components"),
    ],
    KeyType.BUSHING_MATRIX: BushingMatrix,
    KeyType.FUNCTION_PAIR: _pair(_time, ("0", '"-10*sin(t)"'), "components"),
    KeyType.DEFLECTION: _read(Polynomial, values.deflection, _FORMULA),
    KeyType.DEFLECTIONS: _pair(_load, ('"0.01*(1 - xi^2)"', "0"), "polynomials"),
    KeyType.SHAPES: Annotated[
        several_type(
            _shape,
            1,
            MAX_SHAPES,
            "polynomials",
            'polynomials is needed, such as ["1", "xi", "xi^2"], or a family, such as { kind = "pinned", count = 3 }',
        ),
        AfterValidator(_few_digits),
        SchemaExtra(minItems=1, maxItems=MAX_SHAPES),
    ],
    KeyType.SHAPE_COUNT: _read(int, _family_count, {"type": "integer", "minimum": 1, "maximum": MAX_SHAPES}),
    KeyType.LOAD_PAIR: _pair(_load, ("0", '"-10*(1 - xi^2)"'), "components"),
    KeyType.LOAD_TRIPLE: Annotated[
        tuple[_load, _load, _load],  # type: ignore[valid-type]  # a type that is made
        components(("0", "0", '"-10*(1 - xi^2)"'), "components"),
    ],
    KeyType.ORDER: _read(int, values.order, {"enum": [1, 2]}),
    KeyType.COUNT: _count,
    KeyType.INSTANCE_COUNT: _read(
        int, scene_values.instance_count, {"type": "integer", "minimum": 1, "maximum": scene_values.MAX_INSTANCES}
    ),
    KeyType.COUNTS: Annotated[
        several_type(_count, 0, MAX_AROUND, "nodes", "nodes is needed, such as [3, 4, 5]"),
        SchemaExtra(maxItems=MAX_AROUND),
    ],
    KeyType.MODE_COUNT: _read(int, values.mode_count, MODE_COUNT_SCHEMA),
    KeyType.PIECE_COUNT: _pieces,
    KeyType.PIECE_COUNTS: several_type(
        _pieces, 1, scene_values.MAX_PIECES, "numbers of pieces", "whole numbers is needed, such as [1, 2, 3]"
    ),
    KeyType.MARKER: _marker,
    KeyType.BEAM_MARKER: _marker,
    KeyType.MARKER_PAIR: _pair(_marker, ('"ground.bearing"', '"crank.hub"'), "markers"),
    KeyType.POINTS: markers_type(_coordinates, "coordinates", lambda name, at: PointMarker(name, *at)),
    KeyType.BEAM_POINTS: markers_type(_position, "places", Marker),
    KeyType.NODE_POINTS: markers_type(_count, "nodes", NodeMarker),
    KeyType.MARKER_NAMES: Annotated[
        several_type(_name_of, 0, MAX_MARKERS, "markers", 'names of markers is needed, such as ["left", "right"]'),
        SchemaExtra(maxItems=MAX_MARKERS, uniqueItems=True),
    ],
    KeyType.NODES: Nodes,
    KeyType.UNITS: UnitNames,
    KeyType.JOINT: _name_of,
    KeyType.JOINT_PAIR: _pair(_name_of, ('"sun"', '"planet"'), "joints"),
    KeyType.DRIVE: _name_of,
    KeyType.SPRING: _name_of,
    KeyType.JOINT_LOAD: _name_of,
    KeyType.BEAM: _name_of,
    KeyType.TEXT: _text,
    KeyType.MESH: _read(Any, _mesh, _TEXT),
    KeyType.UNIT: Unit,
    KeyType.CONDITION: _read(str, scene_values.until, {"type": "string", "minLength": 3}),
    KeyType.COLUMNS: _columns_of(_text),
}
"""The pydantic type of a value by its type; that of a CHOICE is made of its words, see `declared_tables`."""
