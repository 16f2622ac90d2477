"""Names and symbols of a scene that are taken, or cannot be."""

import pytest
from example_scenes import errors, small

from derive.spec.toml.read import parse

CASE = "names must differ in more than case"
NO_NAME = "cannot be a name: only the letters a to z and A to Z, digits and _ are allowed; try"
D = '[drives.d]\njoint = "pin"\n'
BOTH = '[springs.s1]\nbetween = ["ground.o", "bar.b"]\n'
PLOT = '[plots.p]\ndeflection = "bar.b"\nchord = ["rod.left", "rod.right"]\ndivided_by = 1\n'


@pytest.mark.parametrize(
    ("replaced", "more", "message"),
    [
        (
            ("[bodies.rod]", "[bodies.'my rod']"),
            "",
            f'8: bodies."my rod": "my rod" {NO_NAME} "my_rod"',
        ),
        (
            ("[bodies.rod]", "[bodies.Bar]"),
            "",
            f'8: bodies.Bar: "Bar" is taken: there is a body "bar"; {CASE}',
        ),
        (
            ("[bodies.rod]", "[bodies.Ground]"),
            "",
            '8: bodies.Ground: "Ground" is the name of the inertial frame, whose markers are in [ground.markers]; '
            "choose another name",
        ),
        (
            ("b = [1, 0]", "A = [1, 0]"),
            "",
            f'7: bodies.bar.markers.A: "A" is taken: there is a marker "a"; {CASE}',
        ),
        (
            ("b = [1, 0]", "base = [1, 0]"),
            "",
            '7: bodies.bar.markers.base: "base" is taken: it is what a point of every body is called; choose another '
            "name",
        ),
        (
            ("b = [1, 0]", "b_c = [1, 0]"),
            "[bodies.bar_b]\nlength = 1\nmarkers = { c = 0 }",
            "16: bodies.bar_b.markers.c: bar_b_c would be this marker and the marker b_c of the body bar; choose "
            "another name",
        ),
        (
            ("length = 1", "length = 1\npieces = 2"),
            "[bodies.rod_2]\nlength = 1",
            '15: bodies.rod_2: "rod_2_c1", a coordinate of the body rod_2, is taken: it is a coordinate of piece 2 of '
            "the body rod; choose another name",
        ),
        (
            ("length = 1", "length = 1"),
            f"[bodies.rod_4]\nlength = 1\n{PLOT}cut = 'rod'\npieces = [1, 4]",
            '14: bodies.rod_4: "rod_4_c1", a coordinate of the body rod_4, is taken: it is a coordinate of piece 4 of '
            "the body rod; choose another name",
        ),
        (
            ("length = 1", "length = 1\npieces = 2"),
            "[joints.rod_cut_1]\nkind = 'revolute'\nbetween = ['bar.b', 'rod.left']",
            '15: joints.rod_cut_1: "rod_cut_1_1", a name of the joint rod_cut_1, is taken: it is a multiplier of cut 1 '
            "of the body rod; choose another name",
        ),
        (
            ("length = 1", "length = 1"),
            "[drives.rod_alpha4]\njoint = 'pin'\nspeed = 1",
            '14: drives.rod_alpha4: "rod_alpha4" is taken: it is a coordinate of the body rod; choose another name',
        ),
        (
            ("length = 1", "length = 1"),
            "[drives.pin_turn]\njoint = 'pin'\nspeed = 1",
            '14: drives.pin_turn: "pin_turn" is taken: it is a name of the joint pin; choose another name',
        ),
        (
            ("length = 1", "length = 1"),
            "[drives.T]\njoint = 'pin'\nspeed = 1",
            '14: drives.T: "T" is taken: it is the time; choose another name',
        ),
        (
            ("length = 1", "length = 1"),
            "[forces.pin]\nat = 'bar.a'\ncomponents = [0, 0]",
            '14: forces.pin: "pin_1", a name of the force pin, is taken: it is a name of the joint pin; choose another '
            "name",
        ),
        (
            ('name = "s"', 'name = "bar_phi"'),
            "",
            '4: bodies.bar: "bar_phi", a coordinate of the body bar, is taken: it is the name of the model; choose '
            "another name",
        ),
        (
            ("[joints.pin]", "[joints.'p.n']"),
            "",
            f'11: joints."p.n": "p.n" {NO_NAME} "p_n"',
        ),
        (
            ("length = 1", "length = 1"),
            f"[plots.P]\n{PLOT.split(chr(10), 1)[1]}{PLOT}",
            f'18: plots.p: "p" is taken: there is a plot "P"; {CASE}',
        ),
    ],
)
def test_a_name_that_is_taken_or_cannot_be_one(replaced, more, message):
    assert errors(small(replaced, more=more)) == [message]


ALIKE = "one symbol is one parameter: write both alike, or choose another symbol"


@pytest.mark.parametrize(
    ("replaced", "more", "message"),
    [
        (
            ("length = 1", 'length = { symbol = "r", default = 2 }'),
            f'{BOTH}stiffness = 1\nrest = {{ symbol = "r", default = 3 }}',
            f'17: springs.s1.rest.symbol: "r" is the symbol of length of the body rod, with the default 2.0, not 3.0; '
            f"{ALIKE}",
        ),
        (
            ("mass = 1", 'mass = { symbol = "r" }'),
            f'{D}speed = {{ symbol = "r", default = 1 }}',
            '16: drives.d.speed.symbol: "r" is the symbol of mass of the body bar, with the unit kg, not rad/s; '
            + ALIKE,
        ),
        (
            ("b = [1, 0]", 'b = [{ symbol = "r", default = 1 }, { symbol = "r", default = 1, unit = "mm" }]'),
            "",
            '7: bodies.bar.markers.b[1].symbol: "r" is the symbol of component 1 of the marker b of the body bar, with '
            f"the unit m, not mm; {ALIKE}",
        ),
        (
            ("mass = 1", 'mass = { symbol = "m", default = 2 }'),
            "",
            '5: bodies.bar.mass.symbol: "m" is the symbol of mass of the body rod if none is given, with the default '
            f"1.0, not 2.0; {ALIKE}",
        ),
        (
            ("o = [0, 0]", 'o = [0, { symbol = "ei", default = 0 }]'),
            "",
            '3: ground.markers.o[1].symbol: "ei" is taken: "EI" is the symbol of bending_stiffness of the body rod if '
            f"none is given; {CASE}",
        ),
        (
            ("mass = 1", 'mass = { symbol = "Bar_phi" }'),
            "",
            '5: bodies.bar.mass.symbol: "Bar_phi" is taken: it is a coordinate of the body bar; choose another symbol',
        ),
        (
            ("mass = 1", 'mass = { symbol = "pin_2" }'),
            "",
            '5: bodies.bar.mass.symbol: "pin_2" is taken: it is a name of the joint pin; choose another symbol',
        ),
        (
            ("mass = 1", 'mass = { symbol = "t" }'),
            "",
            '5: bodies.bar.mass.symbol: "t" is taken: it is the time; choose another symbol',
        ),
        (
            ("mass = 1", 'mass = { symbol = "S" }'),
            "",
            '5: bodies.bar.mass.symbol: "S" is taken: it is the name of the model; choose another symbol',
        ),
        (
            ("length = 1", "length = 1"),
            '[scene]\ngravity = [0, { symbol = "for", default = 1 }]',
            '15: scene.gravity[1].symbol: "for" cannot be a name: it is a word of C; try "for_0"',
        ),
        (
            ('name = "s"', 'name = "l"'),
            '[bodies.more]\nframe = "chord"',
            '14: bodies.more.length: "l" is taken: it is the name of the model; choose another symbol',
        ),
    ],
)
def test_a_symbol_that_is_taken(replaced, more, message):
    assert errors(small(replaced, more=more)) == [message]


def test_a_bad_name_that_is_repeated_is_not_called_taken():
    found = errors(small(("[joints.pin]", "[joints.for]"), more="[forces.for]\nat = 'bar.a'\ncomponents = [0, 0]"))
    assert [line.split(": ")[:2] for line in found] == [["11", "joints.for"], ["14", "forces.for"]]
    assert all("it is a word of C" in line for line in found)


def test_the_components_of_gravity_are_taken_where_there_is_gravity():
    """The multipliers of a joint g are g_1 and g_2, whose names nothing else has in a scene without gravity."""
    text = small().replace("joints.pin", "joints.g")
    assert "[joints.g]" in text
    assert parse(text).joints[0].name == "g"
    message = ': joints.g: "g_1", a name of the joint g, is taken: it is a component of gravity; choose another name'
    (error,) = errors(text + "\n[scene]\ngravity = [0, -9.81]\n")
    assert error.endswith(message)
