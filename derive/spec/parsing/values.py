"""The single values of a specification: each function converts a written value to its meaning.

What cannot be meant raises WrongValueError, with a sentence that states what to write.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from derive.errors import TisserandError, quoted
from derive.spec.model.beam_parts import Polynomial
from derive.spec.parsing.names import element_name_problem, name_problem
from derive.spec.parsing.parser import names_of
from derive.spec.parsing.polynomial import MAX_DEGREE, MAX_DIGITS, load_text, parse_number, polynomial
from derive.spec.parsing.time_expression import number_formula

UNIT_PATTERN = "[A-Za-z0-9(]([A-Za-z0-9 .^*/()-]{0,22}[A-Za-z0-9)])?"
MAX_MODES = 300


class WrongValueError(TisserandError, ValueError):
    """A value is not valid for its key; the message states what to write instead."""


@dataclass(frozen=True)
class TomlFloat:
    """A float of a TOML file as it was written: read as a binary float, 0.3 would not be 3/10."""

    text: str


def kind_of(value: object) -> str:
    """The description of a value by its type."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float, Fraction, TomlFloat)):
        return "a number"
    if isinstance(value, str):
        return "text"
    if isinstance(value, (list, tuple)):
        return "a list"
    if isinstance(value, Mapping):
        return "a table"
    return f"a value of type {type(value).__name__}"


def name(value: object) -> str:
    """A name that the generated code can use."""
    if not isinstance(value, str):
        raise WrongValueError(f'a name in quotation marks is needed, such as "beam_1", not {kind_of(value)}')
    problem = name_problem(value)
    if problem:
        raise WrongValueError(problem)
    return value


def element_name(value: str) -> str:
    """The name of an element of a scene, which may have an index behind it."""
    if problem := element_name_problem(value):
        raise WrongValueError(problem)
    return value


def number(value: object) -> Fraction:
    """An exact number; a float stands for the shortest decimal that reads as this float.

    Text is an exact number such as "1/3", or a formula of numbers, pi and functions such as "sqrt(2)/2".
    """
    if isinstance(value, bool) or not isinstance(value, (int, float, Fraction, TomlFloat, str)):
        raise WrongValueError(f'a number is needed, such as 2, 0.5 or "1/3", not {kind_of(value)}')
    if isinstance(value, str):
        if not names_of(value):
            return parse_number(value)
        value = number_formula(value)
    if isinstance(value, (float, TomlFloat)):
        text = value.text.replace("_", "") if isinstance(value, TomlFloat) else float.__repr__(value)
        if text.lstrip("+-") in ("inf", "nan"):
            raise WrongValueError(f"a finite number is needed, not {text}")
        return parse_number(text)
    exact = Fraction(value)
    if max(abs(exact.numerator), exact.denominator) >= 10**MAX_DIGITS:
        raise WrongValueError(
            f"the number has too many digits; at most {MAX_DIGITS} above and below the fraction bar are kept"
        )
    return exact


def positive(value: object) -> Fraction:
    """A physical constant that is folded into the code."""
    exact = number(value)
    if exact <= 0:
        raise WrongValueError(f"a positive number is needed, not {exact}")
    return exact


def positive_float(value: object) -> float:
    """The default of a parameter."""
    return float(positive(value))


def any_float(value: object) -> float:
    """The default of a parameter that may have any sign."""
    return float(number(value))


def not_negative(value: object) -> Fraction:
    """An exact number that is not negative."""
    exact = number(value)
    if exact < 0:
        raise WrongValueError(f"zero or a positive number is needed, not {exact}")
    return exact


def nonzero(value: object) -> Fraction:
    """An exact number that is not zero."""
    exact = number(value)
    if exact == 0:
        raise WrongValueError("a number is needed that is not zero")
    return exact


def whole(value: object) -> int:
    """A whole number, zero or more."""
    try:
        count = None if isinstance(value, bool) else operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        count = None
    if count is None or count < 0:
        given = kind_of(value) if count is None else shown(count)
        given = f"{given} in decimals" if isinstance(value, (float, Fraction, TomlFloat)) else given
        raise WrongValueError(f"a whole number is needed, zero or more, such as 8, not {given}")
    return count


def shown(count: int) -> str:
    """A whole number as text in messages."""
    return str(count) if abs(count) < 10**18 else "a very large one"


def mode_count(value: object) -> int:
    """The number of modes of a body."""
    count = whole(value)
    if count > MAX_MODES:
        raise WrongValueError(f"at most {MAX_MODES} modes are allowed, not {shown(count)}")
    return count


def beam_position(value: object) -> Fraction:
    """The dimensionless distance xi of a point of the beam."""
    exact = number(value)
    if not -1 <= exact <= 1:
        raise WrongValueError(f"xi = {exact} is not on the beam: it goes from -1, the left end, to 1, the right end")
    return exact


def truth(value: object) -> bool:
    """A truth value: true or false, and no other value."""
    if not isinstance(value, bool):
        raise WrongValueError(f"true or false is needed, without quotation marks, not {kind_of(value)}")
    return value


def unit(value: object) -> str:
    """A unit as text for comments and reports."""
    if not isinstance(value, str):
        raise WrongValueError(f'a unit in quotation marks is needed, such as "N m^2", not {kind_of(value)}')
    # A unit ends up in a comment of the generated C, which it must neither end nor open anew.
    if not re.fullmatch(UNIT_PATTERN, value) or "*/" in value or "/*" in value:
        raise WrongValueError(
            f"{quoted(value)} cannot be a unit: write at most 24 letters, digits, spaces and . ^ * / ( ) -, "
            'such as "N m^2", and leave `unit` out for SI'
        )
    return value


def shape(value: object) -> Polynomial:
    """A polynomial of the ansatz: text such as "xi^2 - 1/3", or the tuple of its coefficients."""
    if isinstance(value, tuple):
        result = [number(coefficient) for coefficient in value]
        while result and result[-1] == 0:
            result.pop()
        if len(result) > MAX_DEGREE + 1:
            raise WrongValueError(f"the degree is {len(result) - 1}; the highest is {MAX_DEGREE}")
    elif isinstance(value, str):
        result = list(polynomial(value))
    else:
        raise WrongValueError(f'a polynomial in quotation marks is needed, such as "xi^2", not {kind_of(value)}')
    if not result:
        raise WrongValueError("the polynomial is zero everywhere, so that it describes no displacement; leave it out")
    return tuple(result)


def deflection(value: object) -> Polynomial:
    """A polynomial in xi, or zero for a straight beam: text such as "0.01*xi^2", or the tuple of its coefficients."""
    if isinstance(value, str):
        return polynomial(value)
    return () if isinstance(value, tuple) and not any(value) else shape(value)


def load_polynomial(value: object) -> Polynomial:
    """A polynomial in xi that may be zero: text such as "1 - xi^2", a number, or the tuple of its coefficients."""
    if isinstance(value, (str, tuple)) and value not in ("0", (), (0,)):
        return load_text(value) if isinstance(value, str) else shape(value)
    exact = number(0 if isinstance(value, tuple) else value)
    return (exact,) if exact else ()


def digits(p: Polynomial) -> int:
    """The number of digits of the common denominator of a polynomial and of its largest numerator over it."""
    denominator = math.lcm(*(c.denominator for c in p))
    return len(str(denominator)) + len(str(max(abs(int(c * denominator)) for c in p)))


def order(value: object) -> int:
    """The order of the displacements of a beam in its amplitudes: 1 or 2."""
    if isinstance(value, bool) or value not in (1, 2):
        given = value if isinstance(value, (int, float)) and not isinstance(value, bool) else kind_of(value)
        raise WrongValueError(f"the order is 1 or 2, not {given}")
    return int(value)
