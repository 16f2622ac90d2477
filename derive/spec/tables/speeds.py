"""The speed of a drive: a number, a parameter, or a function of time whose integral is known."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import partial
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, PlainValidator, ValidationInfo, WithJsonSchema

from derive.mechanics.time_integrals.kept import kept_integral
from derive.mechanics.time_integrals.no_closed_form import NoClosedForm
from derive.spec.model.time_function import TimeFunction, value_at
from derive.spec.parsing import scene_values, values
from derive.spec.parsing.parser import MAX_LENGTH
from derive.spec.parsing.time_text import function_text
from derive.spec.tables.quantities import SIGNED, quantity
from derive.spec.tables.shared import plain_or_table


def _speed(value: object, info: ValidationInfo) -> Fraction | TimeFunction:
    """A number, or a function of the time whose integral is known."""
    if not isinstance(value, (str, TimeFunction)):
        return values.number(value)
    function = scene_values.function(value, info.context)
    if function.kind == "number":
        return function.value
    try:
        value_at(kept_integral(function), 0.0)
    except (ArithmeticError, ValueError):
        raise values.WrongValueError(
            f"the integral of {function_text(function)} has no value at t = 0 with the defaults of the parameters, "
            "which happens where a parameter that it divides by is zero; write the `motion` in place of the speed"
        ) from None
    except NoClosedForm as error:
        part = "this speed" if error.part is None else function_text(error.part)
        raise values.WrongValueError(
            f"the integral of {part}, which the motion would be, has no closed form that is known here; write the "
            "`motion` in place of the speed, or the speed as a table of values, see [tables.NAME]"
        ) from None
    return function


def _no_input(value: object) -> object:
    if isinstance(value, Mapping) and "input" in value:
        raise values.WrongValueError(
            'a run-time input prescribes the motion, not the speed: write motion = { input = "motor" }, with whose '
            "values the generated code takes their first and second time derivatives"
        )
    return value


_SCHEMA = {"anyOf": [{"type": "number"}, {"type": "string", "minLength": 1, "maxLength": MAX_LENGTH}]}
_plain: Any = Annotated[Fraction | TimeFunction, PlainValidator(_speed), WithJsonSchema(_SCHEMA)]
_speed_or_parameter: Any = plain_or_table(_plain, SIGNED)
Speed = Annotated[_speed_or_parameter, BeforeValidator(_no_input), AfterValidator(partial(quantity, unit=""))]
"""The type of a speed; the unit of a parameter is that of the joint, which the table of the drive does not know."""
