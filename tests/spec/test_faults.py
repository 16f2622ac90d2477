"""Specifications that are wrong: every fault has its file, its line, its key, and a sentence that helps."""

import pytest

from derive.errors import SpecError
from derive.spec.construction.bodies import planar_beam
from derive.spec.toml.read import parse


def errors(text):
    with pytest.raises(SpecError) as caught:
        parse(text, "b.toml")
    return str(caught.value).split("\n")


def beam(lines):
    return f'name = "b"\n[beam]\n{lines}\n'


NUMBER = 'a number is needed, such as 2, 0.5 or "1/3"'
UNIT = (
    "cannot be a unit: write at most 24 letters, digits, spaces and . ^ * / ( ) -, "
    'such as "N m^2", and leave `unit` out for SI'
)
NOTHING = "b.toml: beam: this key is missing; write [beam], [body] for a body in space, or [bodies.rod] for a scene"
KINDS = 'the frame is one of "mean", "point", "chord", "tangent", "given"'
END = 'a tangent frame needs the end it is at: { kind = "tangent", at = -1 } or at = 1'
KEYS = (
    "ansatz, frame, orthogonal, ends, mass, length, bending_stiffness, axial, damping, masses, markers, order, terms, "
    "gravity, start"
)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("mas = 1", '3: beam.mas: unknown key; did you mean "mass"?'),
        ("masss = 1", '3: beam.masss: unknown key; did you mean "masses" or "mass"?'),
        ("colour = 1", f"3: beam.colour: unknown key; the keys here are {KEYS}"),
        ('"a b" = 1', f'3: beam."a b": unknown key; the keys here are {KEYS}'),
        ("mass = true", f"3: beam.mass: {NUMBER}, not true"),
        ("mass = [1]", f"3: beam.mass: {NUMBER}, not a list"),
        ("mass = 2020-01-01", f"3: beam.mass: {NUMBER}, not a value of type date"),
        ("mass = -1", "3: beam.mass: a positive number is needed, not -1"),
        ("mass = 0.0", "3: beam.mass: a positive number is needed, not 0"),
        ("mass = -inf", "3: beam.mass: a finite number is needed, not -inf"),
        ("mass = nan", "3: beam.mass: a finite number is needed, not nan"),
        (
            "mass = 1e400",
            '3: beam.mass: column 1 of "1e400": a number is too large, too small or too long: '
            "exact numbers have at most 60 digits above and below the fraction bar",
        ),
        (
            f"mass = {10**60}",
            "3: beam.mass: the number has too many digits; at most 60 above and below the fraction bar are kept",
        ),
        (
            'mass = "2 kg"',
            '3: beam.mass: column 3 of "2 kg": an operator is missing before "kg"; for a product write *',
        ),
        ("mass = {}", '3: beam.mass.symbol: this key is missing; write symbol = "m"'),
        ("length = {}", '3: beam.length.symbol: this key is missing; write symbol = "l"'),
        (
            'mass = { symbol = "for" }',
            '3: beam.mass.symbol: "for" cannot be a name: it is a word of C; try "for_0"',
        ),
        (
            "mass = { symbol = 1 }",
            '3: beam.mass.symbol: a name in quotation marks is needed, such as "beam_1", not a number',
        ),
        ('mass = { symbol = "m", units = "g" }', '3: beam.mass.units: unknown key; did you mean "unit"?'),
        (
            'mass = { symbol = "m", x = 1 }',
            "3: beam.mass.x: unknown key; the keys here are symbol, unit, default",
        ),
        (
            'mass = { symbol = "m", unit = 1 }',
            '3: beam.mass.unit: a unit in quotation marks is needed, such as "N m^2", not a number',
        ),
        ('mass = { symbol = "m", unit = "" }', f'3: beam.mass.unit: "" {UNIT}'),
        ('mass = { symbol = "m", unit = "kg */ x" }', f'3: beam.mass.unit: "kg */ x" {UNIT}'),
        ('mass = { symbol = "m", unit = "kg /* x" }', f'3: beam.mass.unit: "kg /* x" {UNIT}'),
        ('mass = { symbol = "m", unit = "/" }', f'3: beam.mass.unit: "/" {UNIT}'),
        ('mass = { symbol = "m", unit = "kg\\n" }', f'3: beam.mass.unit: "kg\\n" {UNIT}'),
        ('mass = { symbol = "m", unit = "kg\\\\" }', f'3: beam.mass.unit: "kg\\" {UNIT}'),
        (
            'mass = { symbol = "m", unit = "1234567890123456789012345" }',
            f'3: beam.mass.unit: "1234567890123456789012345" {UNIT}',
        ),
        (
            'mass = { symbol = "m", default = 0 }',
            "3: beam.mass.default: a positive number is needed, not 0",
        ),
        ('mass = { symbol = "m", default = true }', f"3: beam.mass.default: {NUMBER}, not true"),
        ('frame = "men"', f'3: beam.frame: {KINDS}, not "men"; did you mean "mean"?'),
        ("frame = 1", f"3: beam.frame: {KINDS}, not a number"),
        ('frame = "tangent"', f"3: beam.frame: {END}"),
        ('frame = { kind = "tangent" }', f"3: beam.frame: {END}"),
        ('frame = { kind = "tangent", at = 0 }', f"3: beam.frame: {END}"),
        (
            'frame = { kind = "mean", at = 0 }',
            '3: beam.frame: the frame "mean" has no place; leave `at` out, or choose "point"',
        ),
        ("frame = { at = 0 }", '3: beam.frame.kind: this key is missing; write kind = "point"'),
        ('frame = { kind = "x" }', f'3: beam.frame.kind: {KINDS}, not "x"'),
        ('frame = { kind = "point", to = 0 }', "3: beam.frame.to: unknown key; the keys here are kind, at"),
        (
            'frame = { kind = "point", at = 1.5 }',
            "3: beam.frame.at: xi = 3/2 is not on the beam: it goes from -1, the left end, to 1, the right end",
        ),
        (
            'orthogonal = "true"',
            "3: beam.orthogonal: true or false is needed, without quotation marks, not text",
        ),
        ("orthogonal = 1", "3: beam.orthogonal: true or false is needed, without quotation marks, not a number"),
        (
            'ansatz = "xi^2"',
            '3: beam.ansatz: a list of polynomials is needed, such as ["1", "xi", "xi^2"], or a family, such as '
            '{ kind = "pinned", count = 3 }, not text',
        ),
        ("ansatz = []", "3: beam.ansatz: there are 0 polynomials, and 1 to 20 are allowed"),
        (
            f"ansatz = {[f'xi^{n}' for n in range(21)]}",
            "3: beam.ansatz: there are 21 polynomials, and 1 to 20 are allowed",
        ),
        (
            'ansatz = [\n  "xi^2",\n  "xi^2 + y",\n]',
            '5: beam.ansatz[1]: column 8 of "xi^2 + y": the name "y" is unknown; did you mean "xi"?',
        ),
        (
            'ansatz = ["xi^2",\n 3]',
            '4: beam.ansatz[1]: a polynomial in quotation marks is needed, such as "xi^2", not a number',
        ),
        (
            'ansatz = ["xi^2", ["1"]]',
            '3: beam.ansatz[1]: a polynomial in quotation marks is needed, such as "xi^2", not a list',
        ),
        (
            'ansatz = ["xi^2", "xi - xi"]',
            "3: beam.ansatz[1]: the polynomial is zero everywhere, so that it describes no displacement; leave it out",
        ),
        ("markers = [0]", "3: beam.markers: a table of names and places is needed, not a list"),
        (
            "[beam.markers]\n" + "\n".join(f"m{n} = 0" for n in range(65)),
            "3: beam.markers: there are 65 markers, and 0 to 64 are allowed",
        ),
        (
            "[beam.markers]\nend = 1\nout = 2",
            "5: beam.markers.out: xi = 2 is not on the beam: it goes from -1, the left end, to 1, the right end",
        ),
        (
            '[beam.markers]\n"the end" = 1',
            '4: beam.markers."the end": "the end" cannot be a name: only the letters a to z and A to Z, digits and _ '
            'are allowed; try "the_end"',
        ),
        (
            "[beam.markers]\nend = 1\nEnd = 1",
            '5: beam.markers.End: "End" is taken: there is a marker "end"; names must differ in more than case',
        ),
        (
            'mass = { symbol = "a" }\nlength = { symbol = "A" }',
            '4: beam.length.symbol: "A" is taken: it is the symbol of mass; names must differ in more than case',
        ),
        (
            'mass = { symbol = "ei" }',
            '3: beam.mass.symbol: "ei" is taken: it is the symbol of bending_stiffness if none is given; '
            "names must differ in more than case",
        ),
        (
            'mass = { symbol = "B" }',
            '3: beam.mass.symbol: "B" is taken: it is the name of the model; names must differ in more than case',
        ),
    ],
)
def test_a_fault_of_the_beam(lines, message):
    assert errors(beam(lines)) == [f"b.toml:{message}"]


@pytest.mark.parametrize(
    ("text", "messages"),
    [
        (
            "",
            [
                'b.toml: name: this key is missing; write name = "free_beam"',
                NOTHING,
            ],
        ),
        (
            '[beam]\nname = "b"',
            [
                'b.toml: name: this key is missing; write name = "free_beam"',
                "b.toml:2: beam.name: this key belongs above the table [beam]",
            ],
        ),
        ('name = "b"\nbeam = 3', ["b.toml:2: beam: a table is needed here, not a number"]),
        ('name = "b"\n[[beam]]', ["b.toml:2: beam: a table is needed here, not a list"]),
        (
            "name = 0.5\n[beam]",
            ['b.toml:1: name: a name in quotation marks is needed, such as "beam_1", not a number'],
        ),
        (
            'name = "my beam"\n[beam]',
            [
                'b.toml:1: name: "my beam" cannot be a name: only the letters a to z and A to Z, digits and _ are '
                'allowed; try "my_beam"'
            ],
        ),
        ('name = "b"\nframe = "mean"\n[beam]', ["b.toml:2: frame: this key belongs in the table [beam]"]),
        ('name = "b"\nmass = 1\n[beam]', ["b.toml:2: mass: this key belongs in the table [beam]"]),
        ('name = "b"\n[beam]\n[beem]', ['b.toml:3: beem: unknown key; did you mean "beam"?']),
    ],
)
def test_a_fault_of_the_whole(text, messages):
    assert errors(text) == messages


def test_all_faults_of_a_file_are_reported_at_once_in_the_order_of_the_file():
    text = """\
title = "x"
name = "double"
[beam]
ansatz = [
  "1",
  "2xi",          # 2*xi
  "xi^99",
]
frame = { kind = "tangent", at = 0.5 }
mass = { symbol = "l", default = -1 }
bending_stiffness = "much"
[beam.markers]
left = -2
"""
    assert errors(text) == [
        "b.toml:1: title: unknown key; the keys here are name, beam, body, ground, scene, bodies, joints, drives, "
        "forces, torques, springs, inputs, outputs, parameters, tables, simulation, plots",
        'b.toml:2: name: "double" cannot be a name: it is a word of C; try "double_0"',
        'b.toml:6: beam.ansatz[1]: column 2 of "2xi": an operator is missing before "xi"; for a product write *',
        'b.toml:7: beam.ansatz[2]: column 4 of "xi^99": the power is too high; the highest is 40',
        f"b.toml:9: beam.frame: {END}",
        "b.toml:10: beam.mass.default: a positive number is needed, not -1",
        'b.toml:10: beam.mass.symbol: "l" is taken: it is the symbol of length if none is given; '
        "names must differ in more than case",
        'b.toml:11: beam.bending_stiffness: column 1 of "much": "much" is no number; '
        "a number is written like 2, 0.5 or 1/3",
        "b.toml:13: beam.markers.left: xi = -2 is not on the beam: it goes from -1, the left end, to 1, the right end",
    ]


@pytest.mark.parametrize(
    ("lines", "start", "word"),
    [
        ('ansatz = ["1", "xi"]', "b.toml:3: beam.ansatz: ", "empty"),
        ('ansatz = ["xi^2", "2*xi^2"]', "b.toml:3: beam.ansatz: ", "dependent"),
        ('frame = "given"\nansatz = [\n"1", "xi^2"]', "b.toml:4: beam.ansatz: ", "rigid"),
        ('frame = "given"', "b.toml:2: beam.ansatz: ", "rigid"),
    ],
)
def test_the_algebra_speaks_even_if_another_key_is_at_fault(lines, start, word):
    alone = errors(beam(lines))
    assert alone
    assert all(line.startswith(start) and word in line for line in alone)
    other = f"b.toml:{lines.count(chr(10)) + 4}: beam.mass: {NUMBER}, not true"
    assert errors(beam(f"{lines}\nmass = true")) == [*alone, other]


def test_a_bad_name_that_is_repeated_is_not_called_taken():
    symbols = [
        line.split(" ", 2)[:2] for line in errors(beam('mass = { symbol = "for" }\nlength = { symbol = "for" }'))
    ]
    assert symbols == [["b.toml:3:", "beam.mass.symbol:"], ["b.toml:4:", "beam.length.symbol:"]]


def test_the_algebra_is_silent_where_the_ansatz_or_the_frame_is_no_such_thing():
    assert len(errors(beam('ansatz = ["1", "xi", "y"]'))) == 1
    assert len(errors(beam('ansatz = ["1", "xi"]\nframe = "men"'))) == 1


def test_an_ansatz_whose_exact_shapes_would_be_endless_is_refused():
    rough = [tuple(f"1/{n + 10**20 + 7 * k}" for k in range(n + 1)) for n in range(8)]
    with pytest.raises(SpecError, match=r"^beam\.ansatz: over common denominators, .* at most 800 are allowed"):
        planar_beam("b", ansatz=rough)
