"""The parser of polynomials: what it reads exactly, and what it refuses with a reason."""

import math
from fractions import Fraction

import pytest

from derive.spec.parsing.polynomial import MAX_DEGREE, MAX_DIGITS, MAX_LENGTH, ExpressionError, parse_number, polynomial
from derive.spec.parsing.values import load_polynomial


@pytest.mark.parametrize(
    ("text", "coefficients"),
    [
        ("1", (1,)),
        ("xi", (0, 1)),
        (" xi ^ 2 ", (0, 0, 1)),
        ("xi**3", (0, 0, 0, 1)),
        ("xi^2 - 1/3", (Fraction(-1, 3), 0, 1)),
        ("0.1*xi", (0, Fraction(1, 10))),
        (".5 + 2.", (Fraction(5, 2),)),
        ("1e-3 + 2.5E2", (Fraction(250001, 1000),)),
        ("1/2*xi", (0, Fraction(1, 2))),
        ("1/(2*3)*xi/4", (0, Fraction(1, 24))),
        ("-xi^2", (0, 0, -1)),
        ("(-xi)^2", (0, 0, 1)),
        ("2*-xi", (0, -2)),
        ("--1", (1,)),
        ("1 - 2 - 3", (-4,)),
        ("8/4/2", (1,)),
        ("(1 + xi)^3", (1, 3, 3, 1)),
        ("(1 - xi)*(1 + xi)", (1, 0, -1)),
        ("xi^0", (1,)),
        ("xi - xi", ()),
        ("xi^40 - xi^40 + 1", (1,)),
        ("0*xi", ()),
        ("(5*xi^3 - 3*xi)/2", (0, Fraction(-3, 2), 0, Fraction(5, 2))),
        ("xi\n+ 1", (1, 1)),
        ("1 - pi*xi^2/4", (1, 0, -Fraction(math.pi) / 4)),
    ],
)
def test_a_polynomial_is_read_exactly(text, coefficients):
    read = polynomial(text)
    assert read == coefficients
    assert all(isinstance(c, Fraction) for c in read)


POLYNOMIAL = "a polynomial is made of numbers, xi, pi, + - * / ^ and parentheses"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", f"the text is empty: {POLYNOMIAL}"),
        (" \n", f"the text is empty: {POLYNOMIAL}"),
        ("1 + x", 'column 5 of "1 + x": the name "x" is unknown; did you mean "xi"?'),
        ("Xi", 'column 1 of "Xi": the name "Xi" is unknown; did you mean "xi"?'),
        ("ξ^2", 'column 1 of "ξ^2": the name "ξ" is unknown; did you mean "xi"?'),
        ("length", f'column 1 of "length": the name "length" is unknown: {POLYNOMIAL}'),
        ("sin(xi)", f'column 1 of "sin(xi)": "sin" is called here, and there are no functions: {POLYNOMIAL}'),
        ("xi(2)", 'column 3 of "xi(2)": an operator is missing: for a product write xi*('),
        ("2xi", 'column 2 of "2xi": an operator is missing before "xi"; for a product write *'),
        ("2(xi)", 'column 2 of "2(xi)": an operator is missing before "("; for a product write *'),
        ("xi.real", f'column 3 of "xi.real": "." has no meaning here: {POLYNOMIAL}'),
        ("'1'", f'column 1 of "\'1\'": "\'" has no meaning here: {POLYNOMIAL}'),
        ("xi\x00", f'column 3 of "xi\\x00": "\\x00" has no meaning here: {POLYNOMIAL}'),
        ("xi^-1", 'column 4 of "xi^-1": a power is a whole number, zero or more, such as xi^2'),
        ("xi^0.5", 'column 4 of "xi^0.5": a power is a whole number, zero or more, such as xi^2'),
        ("xi^1e1", 'column 4 of "xi^1e1": a power is a whole number, zero or more, such as xi^2'),
        ("2^xi", 'column 3 of "2^xi": a power is a whole number, zero or more, such as xi^2'),
        ("xi^2^3", 'column 5 of "xi^2^3": a power of a power needs parentheses, such as (xi^2)^3'),
        ("1/0", 'column 3 of "1/0": division by zero'),
        ("xi/(1 - 1)", 'column 4 of "xi/(1 - 1)": division by zero'),
        ("1/xi", 'column 3 of "1/xi": division by xi makes no polynomial; only a number may stand after /'),
        ("xi/xi", 'column 4 of "xi/xi": division by xi makes no polynomial; only a number may stand after /'),
        ("xi +", 'column 5 of "xi +": something is missing at the end'),
        ("+*xi", 'column 2 of "+*xi": a number, xi or ( is expected before *'),
        ("(xi", 'column 1 of "(xi": this parenthesis is never closed'),
        ("xi)", 'column 3 of "xi)": this parenthesis was never opened'),
        ("(1 xi)", 'column 4 of "(1 xi)": an operator is missing before "xi"; for a product write *'),
        ("xi^41", 'column 4 of "xi^41": the power is too high; the highest is 40'),
        ("xi^20*xi^21", 'column 6 of "xi^20*xi^21": the degree is too high; the highest is 40'),
        ("(xi^9)^9", 'column 7 of "(xi^9)^9": the degree is too high; the highest is 40'),
    ],
)
def test_what_is_no_polynomial_is_refused_with_place_and_reason(text, message):
    with pytest.raises(ExpressionError) as caught:
        polynomial(text)
    assert str(caught.value) == message


@pytest.mark.parametrize("text", ["-t", "(1 - xi^2)*sin(t)", "xi*step(t, 0, 1)"])
def test_a_function_of_the_time_in_a_load_is_refused_with_the_key_where_it_belongs(text):
    with pytest.raises(ExpressionError, match=r"a function of t, .* belongs in `time`$"):
        load_polynomial(text)


@pytest.mark.parametrize(
    "text",
    [
        "9^9^9^9",
        "(((9^9)^9)^9)^9",
        "(xi^9)^9^9",
        "((((xi^40)^40)^40)^40)^40",
        "xi^" + "9" * 150,
        "((1+xi)^20)^20*((1+xi)^20)^20",
        "1e999999999",
        "1e-999999999",
        "(1/7 + xi/3)^40*((10^30)^30)^30",
        "(" * 99 + "xi" + ")" * 99,
        "(" * 199,
        "9" * (MAX_DIGITS + 1),
        "1/" + "9" * (MAX_DIGITS + 1),
        "+".join(f"1/{p}^30" for p in (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31)),
        "1+" * MAX_LENGTH + "1",
        "__import__('os').system('true')",
        "(lambda: 1)()",
        "xi if xi else 1",
        "[xi][0]",
        "xi;xi",
        "1_000",
        "0x10",
        "1j",
        "١٢",
        "\ud800",
    ],
)
def test_hostile_text_is_refused_at_once(text):
    with pytest.raises(ExpressionError):
        polynomial(text)


def test_a_long_text_is_counted_and_not_shown():
    with pytest.raises(ExpressionError, match=r"^the text has 401 characters; at most 200 are read$"):
        polynomial("1+" * 200 + "1")


def test_sizes_up_to_the_limits_are_read():
    assert len(polynomial("(xi + 1)^40")) == MAX_DEGREE + 1
    assert parse_number("9" * MAX_DIGITS) == 10**MAX_DIGITS - 1
    assert polynomial("(" * 20 + "xi" + ")" * 20) == (0, 1)
    assert polynomial("+".join(["(xi)"] * 40)) == (0, 40)
    assert polynomial("-" * 150 + "xi") == (0, 1)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1/3", Fraction(1, 3)),
        ("-0.5", Fraction(-1, 2)),
        ("0", Fraction(0)),
        ("2*3/7", Fraction(6, 7)),
        ("1e3", Fraction(1000)),
    ],
)
def test_a_number_is_read_exactly(text, value):
    read = parse_number(text)
    assert read == value
    assert isinstance(read, Fraction)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("xi", 'column 1 of "xi": "xi" is no number; a number is written like 2, 0.5 or 1/3'),
        ("inf", 'column 1 of "inf": "inf" is no number; a number is written like 2, 0.5 or 1/3'),
        ("", "the text is empty: a number is written like 2, 0.5 or 1/3"),
        ("*2", 'column 1 of "*2": a number or ( is expected before *'),
    ],
)
def test_what_is_no_number_is_refused(text, message):
    with pytest.raises(ExpressionError) as caught:
        parse_number(text)
    assert str(caught.value) == message
