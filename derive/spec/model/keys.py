"""The declaration of a key of a specification, from which reading, writing, the JSON schema and messages follow.

Frozen types declare their keys on their fields, joints, bodies, forces and outputs as a tuple:

    stiffness: Annotated[Quantity, key(KeyType.POSITIVE_QUANTITY, "Axial stiffness EA, N.", "N")]
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass, replace
from enum import Enum
from functools import cache
from typing import Annotated, Any, get_args, get_origin, get_type_hints


class KeyType(Enum):
    """The type of the value of a key; the specification layer reads, checks and documents it accordingly."""

    TRUTH = "true or false"
    FLOAT = "a number, kept as a double"
    POSITIVE_FLOAT = "a positive number, kept as a double"
    TOLERANCE = "a positive number below 1, kept as a double"
    FLOAT_PAIR = "two numbers, kept as doubles"
    TRIPLE = "three numbers, kept as doubles"
    ROTATION = "a unit quaternion, or an axis and an angle"
    AMPLITUDES = "amplitudes of the first modes, kept as doubles"
    NUMBER = "a number, exact"
    NOT_NEGATIVE = "a number that is not negative, exact"
    POSITION = "a position xi on a beam, from -1 to 1, exact"
    DIRECTION = "two components of a direction, exact, not both zero"
    POSITIVE = "a positive number, exact"
    POSITIVE_QUANTITY = "a positive number, or a run-time parameter of the generated code"
    NOT_NEGATIVE_QUANTITY = "a number that is not negative, or a run-time parameter"
    QUANTITY = "a number of either sign, or a run-time parameter"
    NONZERO_QUANTITY = "a number of either sign but not zero, or a run-time parameter"
    SPEED = "a number, a run-time parameter, or a function of time whose integral is known"
    FUNCTION = "a function of time"
    FUNCTION_TRIPLE = "three components that are functions of time"
    BUSHING_MATRIX = "six numbers or run-time parameters, three for displacements and three for rotations, or a matrix"
    FUNCTION_PAIR = "two components that are functions of time"
    MARKER = "a marker"
    BEAM_MARKER = "a marker of a beam"
    MARKER_PAIR = "two markers"
    JOINT = "the name of a joint"
    JOINT_PAIR = "the names of two joints"
    DRIVE = "the name of a drive"
    SPRING = "the name of a spring"
    JOINT_LOAD = "the name of a force or a torque in a joint"
    BEAM = "the name of a beam"
    CHOICE = "one of several words"
    TEXT = "the name of a file or of a column"
    UNIT = "a unit"
    CONDITION = "a comparison of columns"
    COLUMNS = "columns, one or several"
    DEFLECTION = "a polynomial in xi"
    DEFLECTIONS = "two polynomials in xi"
    PIECE_COUNT = "a number of pieces of a beam"
    PIECE_COUNTS = "several numbers of pieces of a beam"
    SHAPES = "polynomials in xi"
    SHAPE_COUNT = "a number of shape functions"
    LOAD_PAIR = "two components that are polynomials in xi"
    LOAD_TRIPLE = "three components that are polynomials in xi"
    ORDER = "1 or 2"
    COUNT = "a whole number"
    INSTANCE_COUNT = "a number of instances"
    COUNTS = "whole numbers"
    MODE_COUNT = "a number of modes"
    COORDINATES = "two coordinates, numbers or run-time parameters"
    COORDINATE_TRIPLE = "three coordinates, numbers or run-time parameters"
    INERTIA_TENSOR = "six entries of a tensor of inertia, numbers or run-time parameters"
    FRAMES = "marker frames by their names, with three coordinates each and a rotation"
    MARKER_NAMES = "names of markers of the same body"
    SECTION_FRAMES = "marker frames of a beam in space by their names, with their positions xi and a rotation"
    NODE_FRAMES = "markers of a finite-element body by their names: nodes, or sets of nodes"
    WEIGHTS = "weights, positive numbers"
    LOADED_NODES = "numbers of nodes with forces"
    NODAL_FORCES = "forces at nodes, three numbers each"
    RELATIVE_MOTIONS = "relative motions of two marker frames, by their names"
    PLANAR_ACCELERATION = "two components, numbers or run-time parameters"
    ACCELERATION = "three components, numbers or run-time parameters"
    POINTS = "points by their names, with two coordinates each"
    BEAM_POINTS = "points of a beam by their names, with their positions xi"
    NODE_POINTS = "nodes by their names, with their numbers"
    NODES = "arrays of nodes, or the files with them"
    UNITS = "the names of units"
    MESH = "the name of a file with a mesh"
    VISUALS = "what pictures show of a body: boxes, cylinders, spheres and meshes"


@dataclass(frozen=True)
class Key:
    """A key of a table: name, type of its value, unit (the default unit of a parameter), and description in editors.

    A key that is not `required` may be left out; then the element has the `default`, or no value of that name if it is
    None. `choices` are the words that a CHOICE is one of.

    The type is a frozen type where the value is a table with the keys of that type, or tables by name if it has a name.
    example: a value, or the header of a table, for messages. choice_of: the noun for a CHOICE in messages, by default
    the name of the key. shown: the default as it is written in TOML, if that differs from the value that it has.
    optional: whether a key without a default may be left out, though its field has to have a value. field: the field of
    the frozen type; the further keys of a field have their own names there.
    """

    name: str
    type: KeyType | type
    unit: str
    description: str
    required: bool = False
    default: Any = None
    choices: tuple[str, ...] = ()
    example: str = ""
    choice_of: str = ""
    shown: Any = None
    optional: bool = False
    field: str = ""

    @property
    def has_names(self) -> bool:
        """Whether the value is a table of elements by their names."""
        return self.type in MARKER_TABLES or (isinstance(self.type, type) and has_name(self.type))


MARKER_TABLES = (
    KeyType.POINTS,
    KeyType.BEAM_POINTS,
    KeyType.NODE_POINTS,
    KeyType.FRAMES,
    KeyType.NODE_FRAMES,
    KeyType.SECTION_FRAMES,
)
"""The types of values that are tables of markers by their names."""

QUANTITIES = (
    KeyType.POSITIVE_QUANTITY,
    KeyType.NOT_NEGATIVE_QUANTITY,
    KeyType.QUANTITY,
    KeyType.NONZERO_QUANTITY,
)
"""The types of values that may be run-time parameters."""


def has_name(of: type) -> bool:
    """Whether a type is a frozen type whose values have names, under which their tables stand in a table."""
    return is_dataclass(of) and any(field.name == "name" for field in fields(of))


def key(of: KeyType | type, description: str, unit: str = "", name: str = "", **more: Any) -> Key:
    """The declaration of a key on a field of a frozen type, whose name it has if no other is given."""
    return Key(name, of, unit, description, **more)


@cache
def declared_keys(of: type) -> tuple[Key, ...]:
    """The keys that the fields of a frozen type declare, with their defaults.

    The words of a CHOICE are those of the Literal that the field is annotated with.
    """
    hints = get_type_hints(of, include_extras=True)
    hinted = ((field, hints[field.name]) for field in fields(of))
    return tuple(key for field, hint in hinted if get_origin(hint) is Annotated for key in _declared(field, hint))


def _declared(field: Field[Any], hint: Any) -> Iterator[Key]:
    annotation, first, *others = get_args(hint)
    if first.default is None and not first.optional:
        default = None if field.default is MISSING else field.default
        first = replace(first, default=default, required=field.default is MISSING)
    if first.type is KeyType.CHOICE:
        first = replace(first, choices=_words(annotation))
    yield replace(first, name=first.name or field.name, field=field.name)
    yield from (replace(other, field=other.name) for other in others)


def _words(annotation: Any) -> tuple[str, ...]:
    """The texts of the Literal in an annotation."""
    args = get_args(annotation)
    return tuple(arg for arg in args if isinstance(arg, str)) or tuple(word for arg in args for word in _words(arg))


def value_keys(of: type) -> tuple[Key, ...]:
    """The keys that a frozen type declares, without those of the markers at which it acts."""
    return tuple(key for key in declared_keys(of) if key.type not in (KeyType.MARKER, KeyType.MARKER_PAIR))


def quantities(keys: tuple[Key, ...]) -> dict[str, Key]:
    """The keys that may be run-time parameters, by their names."""
    return {key.name: key for key in keys if key.type in QUANTITIES}
