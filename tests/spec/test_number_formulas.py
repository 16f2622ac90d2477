"""Numbers in quotation marks: formulas of numbers, pi and functions, and powers that are computed."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest

import derive
from derive.errors import SpecError
from derive.spec.as_tables import specification_tables
from derive.spec.parsing.parser import ExpressionError
from derive.spec.parsing.polynomial import parse_number, polynomial
from derive.spec.parsing.time_expression import time_function
from derive.spec.parsing.values import number
from derive.spec.toml.read import parse
from explicit_motion import moved

RING = """\
name = "ring"
[bodies.link]
count = 3
mass = "10^(i - 1)"
inertia = "1/12"
markers = { left = ["-sin(pi/3)", 0], right = ["sin(pi/3)", 0] }
start = { position = ["cos(2*pi*i/3)", "sin(2*pi*i/3)"], angle = "pi/2" }
[forces.push]
count = 2
at = "link[i].right"
components = ["(-1)^(i + 1)*(1 + t)^-2", 0]
"""


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("pi/2", math.pi / 2),
        ("-sqrt(2)/4", -math.sqrt(2) / 4),
        ("2*sin(pi/24)", 2 * math.sin(math.pi / 24)),
        ("sqrt(1/4)", Fraction(1, 2)),
        ("cos(0)/3", Fraction(1, 3)),
    ],
)
def test_a_number_may_be_a_formula_of_numbers(text, value):
    assert number(text) == pytest.approx(value, rel=1e-15)
    assert not isinstance(value, Fraction) or number(text) == value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("10^-2", Fraction(1, 100)),
        ("(2/3)^-2", Fraction(9, 4)),
        ("2^(5 - 3)", Fraction(4)),
        ("2^(1 - 3)", Fraction(1, 4)),
        ("2^-(1 + 1)", Fraction(1, 4)),
        ("2^+3", Fraction(8)),
    ],
)
def test_powers_are_whole_numbers_of_any_sign(text, value):
    assert parse_number(text) == value
    assert time_function(text).value == value
    assert polynomial(f"{text}*xi") == (0, value)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("2^(1/2)", 'column 3 of "2^(1/2)": a power is a whole number, zero or more, such as 2^3'),
        ("2^-(1/2)", 'column 3 of "2^-(1/2)": a power is a whole number, zero or more, such as 2^3'),
        ("0^-1", 'column 3 of "0^-1": division by zero'),
        ("2^-41", 'column 3 of "2^-41": the power is too high; the highest is 40'),
        ("2^(1 + 1)^2", 'column 10 of "2^(1 + 1)^2": a power of a power needs parentheses, such as (2^2)^3'),
    ],
)
def test_what_is_no_power_is_refused(text, fault):
    with pytest.raises(ExpressionError) as caught:
        parse_number(text)
    assert str(caught.value) == fault


def test_instances_have_formulas_with_and_without_the_index():
    scene = parse(RING)
    assert [body.mass for body in scene.bodies] == [Fraction(1, 10), 1, 10]
    assert [body.start.angle for body in scene.bodies] == [math.pi / 2] * 3
    assert float(scene.bodies[2].markers[1].x) == math.sin(math.pi / 3)
    first, second = (force.components[0] for force in scene.forces)
    assert first != second


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ('"pi/2"', '"i/2 + q"', '"q" is no number'),
        ('"1/12"', '"gamma(2.5)"', 'the function "gamma" is unknown'),
        ('"1/12"', '"sinus(2)"', 'the function "sinus" is unknown; did you mean "sin"?'),
    ],
)
def test_faults_of_formulas(old, new, fault):
    with pytest.raises(SpecError) as caught:
        parse(RING.replace(old, new))
    assert fault in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ("name = ", 'ground = { markers = { o = ["i", 0] } }\nname = ', "ground.markers.o[0]: "),
        ("name = ", 'scene = { gravity = [0, "-i"] }\nname = ', "scene.gravity[1]: "),
    ],
)
def test_the_index_is_known_in_tables_with_a_count_alone(old, new, fault):
    with pytest.raises(SpecError) as caught:
        parse(RING.replace(old, new))
    assert fault in str(caught.value)
    assert '"i" is no number; it is the index in tables with `count`, and this table has none' in str(caught.value)


def test_the_index_is_unknown_in_functions_of_time_of_tables_without_a_count():
    push = '[forces.pull]\nat = "link[0].left"\ncomponents = [0, "i*t"]\n'
    with pytest.raises(SpecError) as caught:
        parse(RING + push)
    text = 'components[1]: column 1 of "i*t": the name "i" is unknown; it is the index in tables with `count`'
    assert text in str(caught.value)


DEFLECTED = """\
name = "deflected"
[bodies.rod]
count = 3
length = 1
mass = 1
bending_stiffness = 10
start = { deflection = "0.01*i*xi^2", deflection_rate = "0" }
"""


def test_a_row_of_deflections_may_begin_with_a_straight_beam():
    scene = parse(DEFLECTED)
    assert [body.start.deflection for body in scene.bodies] == [(), (0, 0, Fraction(1, 100)), (0, 0, Fraction(1, 50))]
    assert derive.scene(specification_tables(scene)) == scene
    values = moved(scene, duration=0.01, output=0.01).initial.values
    assert {value.specified for value in values if value.name.startswith("bodies.rod[0].start.deflection ")} == {0.0}
    assert all(value.value == pytest.approx(value.specified, abs=1e-15) for value in values)
