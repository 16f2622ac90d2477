"""Functions of the time: what they are worth, what is computed at once, and what is refused with a reason."""

import math
from fractions import Fraction

import pytest

from derive.spec.model.time_function import TimeFunction
from derive.spec.parsing.parser import MAX_DEPTH, MAX_LENGTH, ExpressionError
from derive.spec.parsing.time_expression import constant_value, time_function

T = TimeFunction("t")
SAMPLES = (-2.5, -0.3, 0.1, 0.7, 1.0, 3.25)


def number(value):
    return TimeFunction("number", value=Fraction(value))


def value(f, t):
    args = [value(arg, t) for arg in f.args]
    operations = {
        "number": lambda: float(f.value),
        "t": lambda: t,
        "add": lambda: args[0] + args[1],
        "sub": lambda: args[0] - args[1],
        "mul": lambda: args[0] * args[1],
        "div": lambda: args[0] / args[1],
        "pow": lambda: args[0] ** args[1],
        "neg": lambda: -args[0],
        "sin": lambda: math.sin(args[0]),
        "cos": lambda: math.cos(args[0]),
        "sqrt": lambda: math.sqrt(args[0]),
    }
    return operations[f.kind]()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("t", lambda t: t),
        ("-t^2 + 3*t - 1/2", lambda t: -(t**2) + 3 * t - 0.5),
        ("(-t)^2", lambda t: t**2),
        ("2 - 3 - t", lambda t: -1 - t),
        ("8/4/t", lambda t: 2 / t),
        ("2/t*t", lambda t: 2.0),
        ("--t", lambda t: t),
        ("2*-t", lambda t: -2 * t),
        ("t**3", lambda t: t**3),
        ("(t + 1)^0", lambda t: 1.0),
        ("sin(2*pi*t)/(2*pi)", lambda t: math.sin(2 * math.pi * t) / (2 * math.pi)),
        ("0.1*cos(3*t - 1)^2", lambda t: 0.1 * math.cos(3 * t - 1) ** 2),
        ("sqrt(1 + t^2)", lambda t: math.hypot(1, t)),
        ("1/(1 + t*t)", lambda t: 1 / (1 + t * t)),
        ("sin(cos(sqrt(t^2)))", lambda t: math.sin(math.cos(abs(t)))),
        (
            "(6/15)*(t^2/2 + (15/(2*pi))^2*(cos(2*pi*t/15) - 1))",
            lambda t: 0.4 * (t**2 / 2 + (15 / (2 * math.pi)) ** 2 * (math.cos(2 * math.pi * t / 15) - 1)),
        ),
    ],
)
def test_a_function_is_what_it_says(text, expected):
    function = time_function(text)
    for t in SAMPLES:
        assert value(function, t) == pytest.approx(expected(t), rel=1e-14, abs=1e-14)


@pytest.mark.parametrize(
    ("text", "function"),
    [
        ("t", T),
        ("0.1", number("0.1")),
        ("1/3 - 1/2", number("-1/6")),
        ("pi", number(math.pi)),
        ("2*pi*t", TimeFunction("mul", (number(Fraction(math.pi) * 2), T))),
        ("t + 1", TimeFunction("add", (T, number(1)))),
        ("-t", TimeFunction("neg", (T,))),
        ("t - 2^3", TimeFunction("sub", (T, number(8)))),
        ("t/4", TimeFunction("div", (T, number(4)))),
        ("t^3", TimeFunction("pow", (T, number(3)))),
        ("sin(t)", TimeFunction("sin", (T,))),
        ("sin(0) + cos(1 - 1) + sqrt(9/4)", number("5/2")),
        ("sqrt(2)", TimeFunction("sqrt", (number(2),))),
    ],
)
def test_what_is_made_of_numbers_is_computed_exactly(text, function):
    assert time_function(text) == function


def test_numbers_of_too_many_digits_are_left_to_the_code():
    third = TimeFunction("pow", (number("1/3"), number(40)))
    power = time_function("(1/3)^40")
    assert power == number(Fraction(1, 3**40))
    assert time_function("((1/3)^40)^40").kind == "pow"
    assert time_function("pi^8") == TimeFunction("pow", (number(math.pi), number(8)))
    assert constant_value(third) == pytest.approx(3.0**-40)


STEP = "write step(t, 1, 2) for a smooth step from 0 at t = 1 to 1 at t = 2"
PIECEWISE = "write piecewise(t < 1, 0, t < 2, t - 1, 1): conditions with their values, then the last value"
MADE_OF = (
    "a function of the time is made of numbers, t, pi, parameters, + - * / ^, parentheses, the functions sin, cos, "
    "sqrt, exp, log, tanh, abs, min, max, atan2, step, piecewise, and tables"
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", f"the text is empty: {MADE_OF}"),
        ("x", f'column 1 of "x": the name "x" is unknown: {MADE_OF}'),
        ("1 + floor(t)", 'column 5 of "1 + floor(t)": floor jumps, and is a function of numbers alone'),
        ("mod(7, -2)", 'column 1 of "mod(7, -2)": the remainder is that of a division by a positive number'),
        ("mod(7)", 'column 1 of "mod(7)": mod has 2 operands, not 1; write mod(7/2, 2)'),
        ("2*T", 'column 3 of "2*T": the name "T" is unknown; did you mean "t"?'),
        ("Pi", 'column 1 of "Pi": the name "Pi" is unknown; did you mean "pi"?'),
        ("sine(t)", 'column 1 of "sine(t)": the function "sine" is unknown; did you mean "sin"?'),
        ("1 + cosh(t)", 'column 5 of "1 + cosh(t)": the function "cosh" is unknown; did you mean "cos"?'),
        ("erfc(t)", f'column 1 of "erfc(t)": the function "erfc" is unknown: {MADE_OF}'),
        ("sin", 'column 1 of "sin": sin is a function; write sin(t)'),
        ("sin t", 'column 1 of "sin t": sin is a function; write sin(t)'),
        ("t(2)", 'column 2 of "t(2)": an operator is missing: for a product write t*('),
        ("2t", 'column 2 of "2t": an operator is missing before "t"; for a product write *'),
        ("sin(t", 'column 4 of "sin(t": this parenthesis is never closed'),
        ("sin()", 'column 5 of "sin()": a number, a name or ( is expected before )'),
        ("sin(t, 2)", 'column 1 of "sin(t, 2)": sin has 1 operand, not 2; write sin(t)'),
        ("atan2(t)", 'column 1 of "atan2(t)": atan2 has 2 operands, not 1; write atan2(t, 1)'),
        ("t, 2", f'column 2 of "t, 2": "," has no meaning here: {MADE_OF}'),
        ("t < 2", f'column 3 of "t < 2": "<" has no meaning here: {MADE_OF}'),
        ("1/exp(t < 2)", f'column 3 of "1/exp(t < 2)": only piecewise has conditions; {PIECEWISE}'),
        ("log(0)", 'column 1 of "log(0)": the logarithm of a number that is not positive is not real'),
        ("exp(1000)", 'column 1 of "exp(1000)": the number is too large for the code, which computes in doubles'),
        ("step(t, 1)", f'column 1 of "step(t, 1)": step has 3 operands, not 2; {STEP}'),
        ("step(t, 2, 1)", 'column 1 of "step(t, 2, 1)": a step ends behind its beginning, and 2 is not below 1'),
        ("step(t, 0, t)", f'column 1 of "step(t, 0, t)": both ends of a step are numbers or parameters; {STEP}'),
        (
            "piecewise(t < 1, 2)",
            'column 1 of "piecewise(t < 1, 2)": a piecewise function has conditions with values, and a last value; '
            + PIECEWISE,
        ),
        (
            "piecewise(2*t < 1, 2, 3)",
            'column 1 of "piecewise(2*t < 1, 2, 3)": the conditions are t < x, with a number or a parameter x; '
            + PIECEWISE,
        ),
        (
            "piecewise(t < 1, 2, t < 1, 3, 4)",
            'column 1 of "piecewise(t < 1, 2, t < 1, 3, 4)": the times of a piecewise function increase',
        ),
        ("t^t", 'column 3 of "t^t": a power is a whole number, zero or more, such as t^2'),
        ("t^2^3", 'column 4 of "t^2^3": a power of a power needs parentheses, such as (t^2)^3'),
        ("t^41", 'column 3 of "t^41": the power is too high; the highest is 40'),
        ("t/0", 'column 3 of "t/0": division by zero'),
        ("t/(1 - 1)", 'column 3 of "t/(1 - 1)": division by zero'),
        ("1/sin(0)", 'column 3 of "1/sin(0)": division by zero'),
        ("1/(sqrt(2) - sqrt(2))", 'column 3 of "1/(sqrt(2) - sqrt(2))": division by zero'),
        ("sqrt(-1)", 'column 1 of "sqrt(-1)": the square root of a negative number is not real'),
        ("t*sqrt(3 - pi)", 'column 3 of "t*sqrt(3 - pi)": the square root of a negative number is not real'),
        (
            "((10^30)^30)^30",
            'column 9 of "((10^30)^30)^30": the number is too large for the code, which computes in doubles',
        ),
        ("t +", 'column 4 of "t +": something is missing at the end'),
    ],
)
def test_what_is_no_function_is_refused_with_place_and_reason(text, message):
    with pytest.raises(ExpressionError) as caught:
        time_function(text)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('true')",
        "(lambda: t)()",
        "t.real",
        "t if t else 1",
        "[t][0]",
        "t;t",
        'sin("t")',
        "sin(t)(t)",
        "t\n/* */",
        "9^9^9^9",
        "((((9^40)^40)^40)^40)^40",
        "1e999999999*t",
        "t^" + "9" * 150,
        "9" * 61,
        "1+" * MAX_LENGTH + "t",
        "(" * (MAX_DEPTH + 1) + "t" + ")" * (MAX_DEPTH + 1),
        "sin(" * (MAX_DEPTH + 1) + "t" + ")" * (MAX_DEPTH + 1),
        "τ",
        "t\x00",
    ],
)
def test_hostile_text_is_refused_at_once(text):
    with pytest.raises(ExpressionError):
        time_function(text)


def test_sizes_up_to_the_limits_are_read():
    assert time_function("(" * MAX_DEPTH + "t" + ")" * MAX_DEPTH) == T
    assert value(time_function("+".join(["t"] * 100)), 0.5) == 50.0
    assert time_function("-" * 198 + "t") == T
    assert value(time_function("sin(" * MAX_DEPTH + "t" + ")" * MAX_DEPTH), 0.0) == 0.0
