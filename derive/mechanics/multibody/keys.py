"""The keys that a joint, a body or a force declares for its table in a specification, as plain data."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from fractions import Fraction


class KeyType(Enum):
    """The type of the value of a key; the specification layer reads, checks and documents it accordingly."""

    FLOAT = "a number, kept as a double"
    DIRECTION = "two components of a direction, exact, not both zero"
    POSITIVE = "a positive number, exact"
    POSITIVE_QUANTITY = "a positive number, or a run-time parameter of the generated code"
    NOT_NEGATIVE_QUANTITY = "a number that is not negative, or a run-time parameter"
    QUANTITY = "a number of either sign, or a run-time parameter"
    FUNCTION = "a function of time"
    FUNCTION_PAIR = "two components that are functions of time"
    MARKER = "a marker"
    BEAM_MARKER = "a marker of a beam"
    MARKER_PAIR = "two markers"
    JOINT = "the name of a joint"
    DRIVE = "the name of a drive"
    SPRING = "the name of a spring"
    CHOICE = "one of several words"


@dataclass(frozen=True)
class Key:
    """A key of a table: name, type of its value, unit (the default unit of a parameter), and description in editors.

    A key that is not `required` may be left out; then the element has the `default`, or no value of that name if it is
    None. `choices` are the words that a CHOICE is one of.
    """

    name: str
    type: KeyType
    unit: str
    description: str
    required: bool = False
    default: Fraction | str | None = None
    choices: tuple[str, ...] = ()


QUANTITIES = (KeyType.POSITIVE_QUANTITY, KeyType.NOT_NEGATIVE_QUANTITY, KeyType.QUANTITY)
"""The types of values that may be run-time parameters."""


def quantities(keys: tuple[Key, ...]) -> dict[str, Key]:
    """The keys that may be run-time parameters, by their names."""
    return {key.name: key for key in keys if key.type in QUANTITIES}
