"""The single values of a scene: each function converts a written value to its meaning.

Like those of `values`, they raise WrongValueError with a sentence that states what to write.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from derive.errors import quoted
from derive.spec.model.markers import MarkerRef
from derive.spec.model.time_function import TimeFunction
from derive.spec.parsing import values
from derive.spec.parsing.condition import condition
from derive.spec.parsing.time_expression import Known, number_function, time_function

MAX_PIECES = 64
MAX_INSTANCES = 10_000


def marker_ref(value: object) -> MarkerRef:
    """A reference to a marker of a body or of the ground, written with a dot between the names."""
    if not isinstance(value, str):
        raise values.WrongValueError(
            f'a body and one of its markers is needed, such as "rod.left" or "ground.bearing", not '
            f"{values.kind_of(value)}"
        )
    body, dot, marker = value.partition(".")
    if not dot or not body or not marker or "." in marker:
        raise values.WrongValueError(
            f"{quoted(value)} is no marker: write a body and one of its markers with a dot between, such as "
            '"rod.left" or "ground.bearing"'
        )
    return MarkerRef(body, marker)


def name_of(value: object) -> str:
    """The name of another element of the specification; cross-reference checks look whether it exists."""
    if not isinstance(value, str):
        raise values.WrongValueError(
            f'a name in quotation marks is needed, such as "motor", not {values.kind_of(value)}'
        )
    return value


def text(value: object) -> str:
    """The name of a file or of a column."""
    if not isinstance(value, str) or not value:
        given = "empty text" if value == "" else values.kind_of(value)
        raise values.WrongValueError(f'text in quotation marks is needed, such as "curve.csv", not {given}')
    return value


def function(value: object, known: Known | None = None) -> TimeFunction:
    """A function of the time: text such as "2*pi*t", a number, a run-time input, or, in Python, a
    TimeFunction.

    `known` are the names that a text may refer to.
    """
    if isinstance(value, TimeFunction):
        return _with_parameters(value, known) if known else value
    if isinstance(value, Mapping):
        name = value.get("input")
        if set(value) != {"input"} or not isinstance(name, str) or not name:
            raise values.WrongValueError('the name of a run-time input is needed, such as { input = "motor" }')
        return TimeFunction("input", name=name)
    if isinstance(value, str):
        return time_function(value, known)
    return number_function(values.number(value))


def _with_parameters(function: TimeFunction, known: Known) -> TimeFunction:
    """A function of time whose parameters are replaced by those of the scene with the same symbols."""
    if function.parameter is not None:
        return known.names.get(function.parameter.symbol, function)
    return replace(function, args=tuple(_with_parameters(arg, known) for arg in function.args))


def piece_count(value: object) -> int:
    """The number of beams into which a rod is cut."""
    count = values.whole(value)
    if not 1 <= count <= MAX_PIECES:
        raise values.WrongValueError(f"a beam is cut into 1 to {MAX_PIECES} pieces, not {values.shown(count)}")
    return count


def instance_count(value: object) -> int:
    """The number of instances of a table."""
    number = value if isinstance(value, int) and not isinstance(value, bool) else None
    if number is None or not 1 <= number <= MAX_INSTANCES:
        given = values.kind_of(value) if number is None else values.shown(number)
        given = f"{given} in decimals" if isinstance(value, (float, values.TomlFloat)) else given
        raise values.WrongValueError(f"a count is a whole number from 1 to {MAX_INSTANCES}, not {given}")
    return number


def axis(value: tuple[Fraction, Fraction]) -> tuple[Fraction, Fraction]:
    """A direction of any length except zero."""
    if not any(value):
        raise values.WrongValueError("[0, 0] is no direction; write one such as [1, 0]")
    return value


def tolerance(value: object) -> float:
    """The tolerance of the integration."""
    exact = values.positive(value)
    if exact >= 1:
        raise values.WrongValueError(f"a tolerance is a small positive number, such as 1e-9, not {exact}")
    return float(exact)


def until(value: object) -> str:
    """A condition that ends a simulation; whether its columns exist is checked when they are known."""
    if not isinstance(value, str):
        raise values.WrongValueError(
            f'a comparison in quotation marks is needed, such as "rod_phi > pi/2", not {values.kind_of(value)}'
        )
    return condition(value).text
