"""Bodies in space whose keys are wrong: every fault has its line, its key, and a sentence that helps."""

import numpy as np
import pytest
from bodies import MODAL_BODY, POSITIONS, N, save, toml

from derive.errors import SpecError
from derive.spec.construction.bodies import nodal_body, planar_beam, symbolic_body
from derive.spec.model.body import BodyFrame
from derive.spec.toml.read import parse


@pytest.fixture
def folder(tmp_path):
    save(tmp_path, **MODAL_BODY)
    return tmp_path


def errors(text, folder):
    with pytest.raises(SpecError) as caught:
        parse(text, str(folder / "b.toml"))
    return [line.removeprefix(f"{folder}/") for line in str(caught.value).split("\n")]


def problems(call, *arguments, **keywords):
    with pytest.raises(SpecError) as caught:
        call(*arguments, **keywords)
    return [(problem.path, problem.message) for problem in caught.value.problems]


NOTHING = "b.toml: beam: this key is missing; write [beam], [body] for a body in space, or [bodies.rod] for a scene"
WHOLE = "a whole number is needed, zero or more, such as 8"
OR_AN_ERROR = "; or a table with the error that chooses it: modes = { error = 0.01, up_to = 500 }"
NUMBER = 'a number is needed, such as 2, 0.5 or "1/3"'
TWICE = "a node is named twice; `node` and those in `around` have to differ"
POINT = (
    "a point frame needs the node it is at, and turns with those in `around`, or with its nearest neighbours: "
    '{ kind = "point", node = 12, around = [3, 4, 5] }'
)
DAMPING = "write either { ratio = 0.01 }, of critical damping, or { mass = 0.1, stiffness = 1e-5 }, in 1/s and s"
KEYS = (
    "nodes, units, modes, component_modes, interface, frame, orthonormal, order, damping, gravity, lowering, stress, "
    "markers, start"
)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("colour = 1", f"5: body.colour: unknown key; the keys here are {KEYS}"),
        ("dampin = 1", '5: body.dampin: unknown key; did you mean "damping"?'),
        ('name = "c"', "5: body.name: this key belongs above the table [body]"),
        ("modes = -1", f"5: body.modes: {WHOLE}, not -1"),
        ("modes = 1.0", f"5: body.modes: {WHOLE}, not a number in decimals{OR_AN_ERROR}"),
        ("modes = true", f"5: body.modes: {WHOLE}, not true{OR_AN_ERROR}"),
        ('modes = "2"', f"5: body.modes: {WHOLE}, not text{OR_AN_ERROR}"),
        ("modes = 301", "5: body.modes: at most 300 modes are allowed, not 301"),
        (f"modes = {10**99}", "5: body.modes: at most 300 modes are allowed, not a very large one"),
        ("modes = 3", "5: body.modes: 3 modes are asked for, and there are 2 in the files"),
        (
            'frame = "men"',
            '5: body.frame: the frame is one of "mean", "point", "given", not "men"; did you mean "mean"?',
        ),
        ("frame = 1", '5: body.frame: the frame is one of "mean", "point", "given", not a number'),
        ('frame = "point"', f"5: body.frame: {POINT}"),
        ('frame = { kind = "point" }', f"5: body.frame: {POINT}"),
        ("frame = { node = 1 }", '5: body.frame.kind: this key is missing; write kind = "point"'),
        (
            'frame = { kind = "mean", node = 1 }',
            '5: body.frame: the frame "mean" is at no node; leave `node` and `around` out',
        ),
        (
            'frame = { kind = "given", around = [1] }',
            '5: body.frame: the frame "given" is at no node; leave `node` and `around` out',
        ),
        (
            'frame = { kind = "point", at = 1 }',
            "5: body.frame.at: unknown key; the keys here are kind, node, around",
        ),
        ('frame = { kind = "point", node = 4 }', "5: body.frame.node: there is no node 4: the nodes are 0 to 3"),
        (
            'frame = { kind = "point", node = 0, around = [1,\n2,\n9] }',
            "7: body.frame.around[2]: there is no node 9: the nodes are 0 to 3",
        ),
        ('frame = { kind = "point", node = 0.5 }', f"5: body.frame.node: {WHOLE}, not a number in decimals"),
        ('frame = { kind = "point", node = 0, around = [1, -2] }', f"5: body.frame.around[1]: {WHOLE}, not -2"),
        (
            'frame = { kind = "point", node = 0, around = 1 }',
            "5: body.frame.around: a list of nodes is needed, such as [3, 4, 5], not a number",
        ),
        (
            f'frame = {{ kind = "point", node = 0, around = {[1] * 1001} }}',
            "5: body.frame.around: there are 1001 nodes, and 0 to 1000 are allowed",
        ),
        ('frame = { kind = "point", node = 0, around = [1, 1] }', f"5: body.frame: {TWICE}"),
        ('frame = { kind = "point", node = 0, around = [1, 0] }', f"5: body.frame: {TWICE}"),
        (
            'orthonormal = "no"',
            "5: body.orthonormal: true or false is needed, without quotation marks, not text",
        ),
        ("damping = 0.01", "5: body.damping: a table is needed here, such as { ratio = 0.01 }, not a number"),
        ("damping = {}", f"5: body.damping: {DAMPING}"),
        ("damping = { ratio = 0.1, mass = 0 }", f"5: body.damping: {DAMPING}"),
        ("damping = { ratio = -0.1 }", "5: body.damping.ratio: zero or a positive number is needed, not -1/10"),
        ("damping = { mas = 1 }", '5: body.damping.mas: unknown key; did you mean "mass"?'),
        ("damping = { mass = true }", f"5: body.damping.mass: {NUMBER}, not true"),
        ("gravity = 9.81", "5: body.gravity: a list of 3 components is needed, such as [0, 0, -9.81], not a number"),
        ("gravity = [0, 0]", "5: body.gravity: a list of 3 components is needed, such as [0, 0, -9.81], not 2"),
        ("gravity = [0,\n0,\ntrue]", f"7: body.gravity[2]: {NUMBER}, not true"),
        (
            "gravity = [0, 0, { default = 1 }]",
            '5: body.gravity[2].symbol: this key is missing; write symbol = "g3"',
        ),
        (
            'gravity = [0, { symbol = "g" }, 0]',
            "5: body.gravity[1].default: this key is missing; write default = -9.81",
        ),
        (
            'gravity = [0, { symbol = "g", default = 0, x = 1 }, 0]',
            "5: body.gravity[1].x: unknown key; the keys here are symbol, unit, default",
        ),
        (
            'gravity = [{ symbol = "g", default = 0 }, 0, { symbol = "G", default = 0 }]',
            '5: body.gravity[2].symbol: "G" is taken: it is the symbol of component 1 of gravity; '
            "names must differ in more than case",
        ),
        (
            'lowering = "fast"',
            '5: body.lowering: the lowering is one of "auto", "flat", "loops", not "fast"; did you mean "flat"?',
        ),
        (
            'lowering = "table"',
            '5: body.lowering: the lowering is one of "auto", "flat", "loops", not "table"; did you mean "loops"?',
        ),
        ("markers = [0]", "5: body.markers: a table of names and nodes is needed, not a list"),
        ("markers = { tip = 4 }", "5: body.markers.tip: there is no node 4: the nodes are 0 to 3"),
        (f"markers = {{ tip = {10**99} }}", "5: body.markers.tip: there is no such node: the nodes are 0 to 3"),
        ("markers = { tip = 0.5 }", f"5: body.markers.tip: {WHOLE}, not a number in decimals"),
        (
            "[body.markers]\ntip = 0\nTip = 0",
            '7: body.markers.Tip: "Tip" is taken: there is a marker "tip"; names must differ in more than case',
        ),
        (
            '[body.markers]\n"the tip" = 0',
            '6: body.markers."the tip": "the tip" cannot be a name: only the letters a to z and A to Z, digits and _ '
            'are allowed; try "the_tip"',
        ),
        (
            "[body.markers]\n" + "\n".join(f"m{n} = 0" for n in range(65)),
            "5: body.markers: there are 65 markers, and 0 to 64 are allowed",
        ),
    ],
)
def test_a_fault_of_a_body_of_nodes(folder, lines, message):
    assert errors(toml(lines), folder) == [f"b.toml:{message}"]


MISSING = 'or those of the files, such as { length = "mm", mass = "t", time = "s" }'
UNITS = 'units are "SI", or a table of all three such as { length = "mm", mass = "t", time = "s" }'


@pytest.mark.parametrize(
    ("units", "messages"),
    [
        ('"mm"', [f"body.units: {UNITS}"]),
        ("1", [f"body.units: {UNITS}"]),
        ('{ length = "mm", mass = "t" }', ['body.units.time: this key is missing; write time = "s"']),
        (
            "{}",
            [
                'body.units.length: this key is missing; write length = "mm"',
                'body.units.mass: this key is missing; write mass = "t"',
                'body.units.time: this key is missing; write time = "s"',
            ],
        ),
        (
            '{ length = "mile", mass = 1, time = "S", force = "N" }',
            [
                'body.units.length: the unit of length is one of "m", "cm", "mm", "in", not "mile"',
                'body.units.mass: the unit of mass is one of "kg", "g", "t", "lbf s^2/in", not a number',
                'body.units.time: the unit of time is one of "s", "ms", not "S"; did you mean "s"?',
                "body.units.force: unknown key; the keys here are length, mass, time",
            ],
        ),
    ],
)
def test_a_fault_of_the_units(folder, units, messages):
    assert errors(toml("", units=units), folder) == [f"b.toml:4: {message}" for message in messages]


def test_a_body_says_that_it_needs_nodes_and_units(folder):
    assert errors('name = "b"\n[body]', folder) == [
        'b.toml:2: body.nodes: this key is missing; write nodes = "block.npz"',
        f'b.toml:2: body.units: this key is missing; write units = "SI", {MISSING}',
    ]


@pytest.mark.parametrize(
    ("text", "messages"),
    [
        (
            'name = "b"\n[beam]\n[body]\nintegrals = "symbolic"\nmodes = 1',
            ["b.toml:3: body: a file specifies one body, and here are [beam] and [body]; leave one of them out"],
        ),
        (
            'name = "b"',
            [NOTHING],
        ),
        ('name = "b"\nbody = 3', ["b.toml:2: body: a table is needed here, not a number"]),
        ('name = "b"\n[[body]]', ["b.toml:2: body: a table is needed here, not a list"]),
        (
            'name = "b"\nnodes = "b.npz"\nmodes = 1\nframe = "mean"\n[body]\nintegrals = "symbolic"\nmodes = 1',
            [
                "b.toml:2: nodes: this key belongs in the table [body]",
                "b.toml:3: modes: this key belongs in the table [body]",
                "b.toml:4: frame: this key belongs in the table [body]",
            ],
        ),
        (
            'name = "b"\nunits = "SI"\nframe = "mean"\n[beam]',
            [
                "b.toml:2: units: this key belongs in the table [body]",
                "b.toml:3: frame: this key belongs in the table [beam]",
            ],
        ),
        (
            'name = "b"\n[beam]\nunits = "SI"\ngravity = [0, 0, 1]',
            [
                "b.toml:3: beam.units: unknown key; the keys here are ansatz, frame, orthogonal, ends, mass, length, "
                "bending_stiffness, axial, damping, masses, markers, order, terms, gravity, start",
                "b.toml:4: beam.gravity: a list of 2 components is needed, such as [0, -9.81], not 3",
            ],
        ),
        (
            'name = "b"\n[beam]\ngravity = [{}, { symbol = "g", default = true }]',
            [
                'b.toml:3: beam.gravity[0].symbol: this key is missing; write symbol = "g1"',
                "b.toml:3: beam.gravity[0].default: this key is missing; write default = -9.81",
                f"b.toml:3: beam.gravity[1].default: {NUMBER}, not true",
            ],
        ),
        (
            'name = "b"\n[beam]\ngravity = [0, { symbol = "L", default = 1 }]',
            [
                'b.toml:3: beam.gravity[1].symbol: "L" is taken: it is the symbol of length if none is given; '
                "names must differ in more than case"
            ],
        ),
    ],
)
def test_a_fault_of_the_whole(tmp_path, text, messages):
    assert errors(text, tmp_path) == messages


def test_all_faults_of_a_file_are_reported_at_once_in_the_order_of_the_file(tmp_path):
    positions = POSITIONS.copy()
    save(tmp_path, positions=positions, mass=-np.ones(N), stiffness=np.ones((3, 3)), mas=np.ones(N))
    text = """\
name = "double"
[body]
nodes = "b.npz"
modes = 30
frame = { kind = "point", node = 4 }
damping = { ratio = -1 }
gravity = [0, 1]
[body.markers]
tip = -1
top = 4
"""
    assert errors(text, tmp_path) == [
        'b.toml:1: name: "double" cannot be a name: it is a word of C; try "double_0"',
        f'b.toml:2: body.units: this key is missing; write units = "SI", {MISSING}',
        'b.toml:3: body.nodes.mas: unknown key; did you mean "mass"?',
        "b.toml:3: body.nodes.mass: 4 of 4 nodes have a negative mass, the first of them node 0 with -1",
        "b.toml:3: body.nodes.stiffness: the shape is (3, 3), and that of `positions` (4, 3): (12, 12) is needed",
        "b.toml:4: body.modes: 30 modes are too many: 4 nodes have 12 displacements, of which 6 are rigid motion, so "
        "that there are 6 at most",
        "b.toml:5: body.frame.node: there is no node 4: the nodes are 0 to 3",
        "b.toml:6: body.damping.ratio: zero or a positive number is needed, not -1",
        "b.toml:7: body.gravity: a list of 3 components is needed, such as [0, 0, -9.81], not 2",
        f"b.toml:9: body.markers.tip: {WHOLE}, not -1",
        "b.toml:10: body.markers.top: there is no node 4: the nodes are 0 to 3",
    ]


@pytest.mark.parametrize(
    ("call", "arguments", "keywords", "path"),
    [
        (nodal_body, (MODAL_BODY,), {}, "body.units"),
        (nodal_body, (MODAL_BODY,), {"units": 1}, "body.units"),
        (nodal_body, (MODAL_BODY,), {"units": "SI", "frame": None}, "body.frame"),
        (nodal_body, (MODAL_BODY,), {"units": "SI", "frame": BodyFrame("point", 9)}, "body.frame.node"),
        (nodal_body, (MODAL_BODY,), {"units": "SI", "modes": 10**5000}, "body.modes"),
        (nodal_body, (MODAL_BODY,), {"units": "SI", "modes": np.True_}, "body.modes"),
        (nodal_body, (MODAL_BODY,), {"units": "SI", "markers": {3: 0}}, "body.markers[3]"),
        (nodal_body, (MODAL_BODY,), {"units": "SI", "markers": {"a": 10**5000}}, "body.markers.a"),
        (nodal_body, (MODAL_BODY,), {"units": "SI", "gravity": "down"}, "body.gravity"),
        (nodal_body, (MODAL_BODY,), {"units": "SI", "damping": 0.1}, "body.damping"),
        (nodal_body, (MODAL_BODY,), {"units": "SI", "lowering": None}, "body.lowering"),
        (nodal_body, (None,), {"units": "SI"}, "body.nodes"),
        (symbolic_body, (None,), {}, "body.modes"),
        (symbolic_body, (3,), {"damping": None}, "body.damping"),
        (symbolic_body, (3,), {"gravity": [0, 0, float("nan")]}, "body.gravity[2]"),
        (planar_beam, (), {"gravity": [0]}, "beam.gravity"),
    ],
)
def test_python_values_of_the_wrong_kind_are_spec_errors_too(call, arguments, keywords, path):
    assert [found for found, _ in problems(call, "b", *arguments, **keywords)] == [path]


def test_a_body_of_nodes_without_a_name(folder):
    assert 'b.toml: name: this key is missing; write name = "block"' in errors("[body]\nunits = 'SI'\n", folder)
