"""Scenes that are wrong: every fault has its line, its key, and a sentence that helps."""

import pytest
from example_scenes import EVERYTHING, SMALL, errors, small

import derive
from derive.cli.main import main
from derive.errors import SpecError
from derive.spec.tables.shared import MAX_NAMED
from derive.spec.toml.read import parse

NUMBER = 'a number is needed, such as 2, 0.5 or "1/3"'
WHOLE = "a whole number is needed, zero or more, such as 8"
COORDINATES = "a list of 2 coordinates is needed, such as [0.15, 0]"
BEAM = "length, bending_stiffness, ansatz, frame"
JOINTS = 'the joint is one of "revolute", "weld", "fixed", "translational"'
PLACE = 'write a body and one of its markers with a dot between, such as "rod.left" or "ground.bearing"'
WAYS = 'write either motion = "0.1*sin(2*pi*t)", a function of t, or speed = 150'
WHOLE_BEAM = (
    "`ends` and families of shape functions are for beams in one piece: with them the pieces could not bend at the "
    "cuts; leave `pieces` out, or take polynomials without `ends`"
)
FUNCTION = (
    "a function of the time is made of numbers, t, pi, parameters, + - * / ^, parentheses, the functions sin, cos, "
    "sqrt, exp, log, tanh, abs, min, max, atan2, step, piecewise, and tables"
)
NO_NAME = "cannot be a name: only the letters a to z and A to Z, digits and _ are allowed; try"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("mass = 1", "mas = 1", '5: bodies.bar.mas: unknown key; did you mean "mass"?'),
        (
            "mass = 1",
            "mass = 1\ncolour = 1",
            "6: bodies.bar.colour: unknown key; the keys of a rigid body are mass, inertia, centre, markers, start, "
            "keep_coordinates, count",
        ),
        ("mass = 1", "mass = 1\nlenght = 1", '6: bodies.bar.lenght: unknown key; did you mean "length"?'),
        (
            "mass = 1",
            "mass = 1\npieces = 2",
            "6: bodies.bar.pieces: a rigid body has no such key; leave it out, or make the body a beam by one of "
            f"{BEAM}",
        ),
        (
            "length = 1",
            "length = 1\ninertia = 1",
            "10: bodies.rod.inertia: a beam has no such key; leave it out, or make the body rigid: without " + BEAM,
        ),
        (
            "length = 1",
            "length = 1\ngravity = [0, 1]",
            "10: bodies.rod.gravity: gravity acts on all bodies; write it in the table [scene]",
        ),
        ("mass = 1", "mass = -1", "5: bodies.bar.mass: a positive number is needed, not -1"),
        ("inertia = 1", "inertia = {}", '6: bodies.bar.inertia.symbol: this key is missing; write symbol = "I"'),
        (
            "inertia = 1",
            "inertia = 1\ncentre = [0, { symbol = 'e' }]",
            "7: bodies.bar.centre[1].default: this key is missing; write default = 0.1",
        ),
        ("inertia = 1", "inertia = 1\ncentre = 0", f"7: bodies.bar.centre: {COORDINATES}, not a number"),
        ("a = [0, 0]", "a = [0, 0, 0]", f"7: bodies.bar.markers.a: {COORDINATES}, not 3"),
        ("a = [0, 0]", "a = [0, true]", f"7: bodies.bar.markers.a[1]: {NUMBER}, not true"),
        ("b = [1, 0]", "'b c' = [1, 0]", f'7: bodies.bar.markers."b c": "b c" {NO_NAME} "b_c"'),
        ("left = -1", "left = [0, 0]", f"10: bodies.rod.markers.left: {NUMBER}, not a list"),
        (
            "left = -1",
            "left = -2",
            "10: bodies.rod.markers.left: xi = -2 is not on the beam: it goes from -1, the left end, to 1, the right "
            "end",
        ),
        (
            "length = 1",
            "length = 1\nends = 'clamped'",
            '10: bodies.rod.ends: `ends` is one of "pinned", "free", not "clamped"',
        ),
        (
            "length = 1",
            "length = 1\nansatz = ['1', 'xi', 'xi^2', 'xi^3', 'xi^4']\nends = 'pinned'\npieces = 2",
            f"8: bodies.rod: {WHOLE_BEAM}",
        ),
        (
            "length = 1",
            "length = 1\nansatz = { kind = 'pinned', count = 2 }\npieces = 2",
            f"8: bodies.rod: {WHOLE_BEAM}",
        ),
        (
            "length = 1",
            "length = 1\nansatz = { kind = 'pined', count = 2 }",
            '10: bodies.rod.ansatz.kind: the family is one of "pinned", "free-free", "clamped-free", not "pined"; did '
            'you mean "pinned"?',
        ),
        (
            "length = 1",
            "length = 1\nansatz = { kind = 'pinned', count = 21 }",
            "10: bodies.rod.ansatz.count: 1 to 20 shapes of a family are allowed, not 21",
        ),
        (
            "length = 1",
            "length = 1\nansatz = { kind = 'pinned' }",
            "10: bodies.rod.ansatz.count: this key is missing; write count = 3",
        ),
        (
            "length = 1",
            "length = 1\nansatz = { kind = 'pinned', count = 2, order = 1 }",
            "10: bodies.rod.ansatz.order: unknown key; the keys here are kind, count",
        ),
        (
            "length = 1",
            "length = 1\nansatz = { kind = 'pinned', count = 2 }\nends = 'pinned'",
            "8: bodies.rod: `ends` is for polynomials; pinned shapes fulfil conditions of their own; leave it out",
        ),
        (
            "length = 1",
            "length = 1\nansatz = { kind = 'free-free', count = 2 }\nframe = 'chord'",
            "10: bodies.rod.ansatz: free-free shapes do not fulfil v(-1) = 0 and v(1) = 0 of the chord frame; they "
            "are for the frame mean, which they have if `frame` is left out",
        ),
        (
            "length = 1",
            "length = 1\nansatz = { kind = 'pinned', count = 2 }\nstart = { deflection = 'xi^2' }",
            "11: bodies.rod.start.deflection: the shape functions of rod cannot describe this curve; it must be a "
            "combination of 1 and xi, for families of shape functions hold no polynomials; or write `guess = true`, "
            "which takes the nearest curve that they have",
        ),
        ("length = 1", "length = 1\npieces = 0", "10: bodies.rod.pieces: a beam is cut into 1 to 64 pieces, not 0"),
        ("length = 1", "length = 1\npieces = 65", "10: bodies.rod.pieces: a beam is cut into 1 to 64 pieces, not 65"),
        ("length = 1", "length = 1\npieces = 2.0", f"10: bodies.rod.pieces: {WHOLE}, not a number in decimals"),
        (
            "length = 1",
            "length = 1\nframe = 'men'",
            '10: bodies.rod.frame: the frame is one of "mean", "point", "chord", "tangent", "given", not "men"; '
            'did you mean "mean"?',
        ),
        (
            "length = 1",
            'ansatz = ["1", "xi"]',
            "9: bodies.rod.ansatz: the ansatz is empty after the conditions of the mean frame (int v dxi = 0 and "
            "int xi v dxi = 0); add polynomials of higher degree",
        ),
        (
            "length = 1",
            'ansatz = ["xi^2", "xi^3"]',
            "9: bodies.rod.ansatz: the ansatz is empty after the conditions of the mean frame (int v dxi = 0 and "
            'int xi v dxi = 0); add "1" and "xi", which the conditions use up',
        ),
        ("length = 1", "length = 1\nstart = 3", "10: bodies.rod.start: a table is needed here, not a number"),
        (
            "length = 1",
            "length = 1\nstart = { pos = [0, 0] }",
            "10: bodies.rod.start.pos: unknown key; the keys here are position, angle, velocity, spin, guess, "
            "deflection, deflection_rate",
        ),
        (
            "length = 1",
            'length = 1\nstart = { deflection = "xi^4" }',
            "10: bodies.rod.start.deflection: the shape functions of rod cannot describe this curve; it must be a "
            "combination of 1, xi and the ansatz: add its powers to `ansatz`; or write `guess = true`, which takes the "
            "nearest curve that they have",
        ),
        (
            "length = 1",
            "length = 1\nstart = { guess = 1 }",
            "10: bodies.rod.start.guess: true or false is needed, without quotation marks, not a number",
        ),
        (
            "length = 1",
            "length = 1\nstart = { position = 0 }",
            "10: bodies.rod.start.position: a list of 2 numbers is needed, such as [0.1, 0], not a number",
        ),
        ("length = 1", "length = 1\nstart = { spin = true }", f"10: bodies.rod.start.spin: {NUMBER}, not true"),
        ("o = [0, 0]", "o = [0]", "3: ground.markers.o: a list of 2 coordinates is needed, such as [0.15, 0], not 1"),
        ('"bar.a"', '"baz.a"', '13: joints.pin.between[1]: there is no body "baz"; did you mean "bar"?'),
        ('"ground.o"', '"grond.o"', '13: joints.pin.between[0]: there is no body "grond"; did you mean "ground"?'),
        (
            '"bar.a"',
            '"tower.a"',
            '13: joints.pin.between[1]: there is no body "tower"; the bodies are bar, rod, and there is the ground',
        ),
        (
            '"ground.o"',
            '"rod.lef"',
            '13: joints.pin.between[0]: the body rod has no marker "lef"; did you mean "left"?',
        ),
        (
            '"ground.o"',
            '"rod.end"',
            '13: joints.pin.between[0]: the body rod has no marker "end"; it has the markers left, right',
        ),
        (
            '"ground.o"',
            '"ground.p"',
            '13: joints.pin.between[0]: the ground has no marker "p"; it has the marker o',
        ),
        (
            "[ground.markers]\no = [0, 0]",
            "\n",
            '13: joints.pin.between[0]: the ground has no marker "o", and no others; write [ground.markers] with '
            "o = [0, 0]",
        ),
        (
            '"ground.o"',
            '"bar.b"',
            "13: joints.pin.between: both markers are on the body bar; a joint is between two bodies, or ground and "
            "body",
        ),
        (
            '"bar.a"',
            '"ground.o"',
            "13: joints.pin.between: both markers are on the ground, which does not move; "
            "one of them must be on a body",
        ),
        ('"ground.o"', '"ground"', f'13: joints.pin.between[0]: "ground" is no marker: {PLACE}'),
        ('"ground.o"', '"a.b.c"', f'13: joints.pin.between[0]: "a.b.c" is no marker: {PLACE}'),
        (
            '"ground.o"',
            "3",
            '13: joints.pin.between[0]: a body and one of its markers is needed, such as "rod.left" or '
            '"ground.bearing", not a number',
        ),
        (
            '["ground.o", "bar.a"]',
            '"ground.o"',
            '13: joints.pin.between: a list of 2 markers is needed, such as ["ground.bearing", "crank.hub"], not text',
        ),
        ('kind = "revolute"', 'kind = "hinge"', f'12: joints.pin.kind: {JOINTS}, not "hinge"'),
        ('kind = "revolute"', "", '11: joints.pin.kind: this key is missing; write kind = "revolute"'),
        (
            'kind = "revolute"',
            'kind = "revolute"\nangle = 1',
            "11: joints.pin: a revolute joint has no angle; leave `angle` out, or choose "
            '"weld", "fixed" or "translational"',
        ),
        (
            'kind = "revolute"',
            'kind = "weld"\naxis = [1, 0]',
            '11: joints.pin: a weld joint has no axis; leave `axis` out, or choose "translational"',
        ),
        (
            'kind = "revolute"',
            'kind = "translational"\naxis = [0, 0]',
            "13: joints.pin.axis: [0, 0] is no direction; write one such as [1, 0]",
        ),
        (
            "mass = 1\ninertia = 1",
            "\n",
            "4: bodies.bar: no drive prescribes the motion of this body, so that it needs mass and inertia; write "
            "mass = 1.0 and inertia = 1.0",
        ),
        (
            "mass = 1\n",
            "\n",
            "4: bodies.bar: no drive prescribes the motion of this body, so that it needs mass; write mass = 1.0",
        ),
    ],
)
def test_a_fault_of_a_body_or_a_joint(old, new, message):
    assert errors(small((old, new))) == [message]


D = '[drives.d]\njoint = "pin"\n'
BOTH = '[springs.s1]\nbetween = ["ground.o", "bar.b"]\n'
PLOT = '[plots.p]\ndeflection = "bar.b"\nchord = ["rod.left", "rod.right"]\ndivided_by = 1\n'
SLIDE = "[joints.slide]\nkind = 'translational'\nbetween = ['rod.left', 'bar.b']\n"


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (D, f"14: drives.d: {WAYS}"),
        (D + "speed = 1\nmotion = 't'", f"14: drives.d: {WAYS}"),
        (D + "motion = 't'\noffset = 1", "14: drives.d: `offset` goes with `speed`; add it to `motion` instead"),
        (
            D + "motion = 'a*t'",
            f'16: drives.d.motion: column 1 of "a*t": the name "a" is unknown: {FUNCTION}',
        ),
        (D + "motion = true", f"16: drives.d.motion: {NUMBER}, not true"),
        ("[scene]\nunit = 1", "15: scene.unit: unknown key; the keys here are gravity, start, lowering, redundant"),
        (
            "[joints.ansatz]\nkind = 'weld'",
            '14: joints.ansatz.between: this key is missing; write between = ["ground.bearing", "crank.hub"]',
        ),
        (D + "sped = 1\nspeed = 1", '16: drives.d.sped: unknown key; did you mean "speed"?'),
        ("[drives.d]\njoint = 'pn'\nspeed = 1", '15: drives.d.joint: there is no joint "pn"; did you mean "pin"?'),
        (
            "[drives.d]\njoint = 'bearing'\nspeed = 1",
            '15: drives.d.joint: there is no joint "bearing"; the joints are pin',
        ),
        (
            "[drives.d]\njoint = 3\nspeed = 1",
            '15: drives.d.joint: a name in quotation marks is needed, such as "motor", not a number',
        ),
        ("[drives.d]\nspeed = 1", '14: drives.d.joint: this key is missing; write joint = "bearing"'),
        (
            f"{D}speed = 1\n[drives.e]\njoint = 'pin'\nspeed = 2",
            "18: drives.e.joint: the joint pin is driven by d already; leave one of the drives out",
        ),
        (
            "[joints.glue]\nkind = 'fixed'\nbetween = ['bar.b', 'rod.left']\n[drives.d]\njoint = 'glue'\nspeed = 1",
            "18: drives.d.joint: nothing moves in the fixed joint glue; drive a revolute or a translational one",
        ),
        (
            SLIDE,
            "16: joints.slide.between: the line must belong to the ground or to a rigid body, and rod is a beam; swap "
            "the two markers",
        ),
        (
            SLIDE.replace("bar.b", "bow.c") + "[bodies.bow]\nlength = 1\nmarkers = { c = 0 }",
            "16: joints.slide.between: the line must belong to the ground or to a rigid body, and rod is a beam, as "
            "bow is; weld a rigid body to rod, and let bow slide on it",
        ),
        (
            "[bodies.free]",
            "14: bodies.free: no joint holds this body, so that it needs mass and inertia; write mass = 1.0 and "
            "inertia = 1.0",
        ),
        (
            "[forces.f]\nat = 'ground.o'\ncomponents = [0, 1]",
            "15: forces.f.at: a force on the ground moves nothing; name a marker of a body",
        ),
        (
            "[forces.f]\nat = 'bar.a'\ncomponents = 1",
            '16: forces.f.components: a list of 2 components is needed, such as [0, "-10*sin(t)"], not a number',
        ),
        (
            "[forces.f]\nat = 'bar.a'\ncomponents = [1, 'sine(t)']",
            '16: forces.f.components[1]: column 1 of "sine(t)": the function "sine" is unknown; did you mean "sin"?',
        ),
        (
            "[torques.m]\nat = 'ground.o'\nvalue = 1",
            "15: torques.m.at: a torque on the ground moves nothing; name a marker of a body",
        ),
        (
            "[torques.m]\nat = 'bar.a'\nvalue = 1\nagainst = 'bar.q'",
            '17: torques.m.against: the body bar has no marker "q"; it has the markers a, b',
        ),
        ("[torques.m]\nat = 'bar.a'", "14: torques.m.value: this key is missing; write value = 1.5"),
        (
            "[springs.s1]\nbetween = ['bar.a', 'bar.a']\nstiffness = 1",
            "15: springs.s1.between: a spring is between two markers, and these are the same",
        ),
        (
            f"{BOTH}stiffness = 1\nkind = 'helix'",
            '17: springs.s1.kind: the spring is one of "linear", "rotational", "bushing", not "helix"',
        ),
        (f"{BOTH}stiffness = -1", "16: springs.s1.stiffness: zero or a positive number is needed, not -1"),
        (
            f"{BOTH}stiffness = {{ symbol = 'k', default = -1 }}",
            "16: springs.s1.stiffness.default: zero or a positive number is needed, not -1",
        ),
        (
            f"{BOTH}stiffness = 1\nrest = -1",
            "14: springs.s1: `rest` is a length, zero or more; only that of a rotational spring has a sign",
        ),
        (
            f"{BOTH}stiffness = 1\nrest = {{ symbol = 'r', default = -1 }}",
            "14: springs.s1: `rest` is a length, zero or more; only that of a rotational spring has a sign",
        ),
        (
            "[simulation]\nduration = 1\noutput = 2",
            "14: simulation: `output`, the time between rows, is longer than `duration`; make it shorter",
        ),
        (
            "[simulation]\nduration = 1\noutput = 1e-8",
            "14: simulation: the output would have more than 10000000 rows; make `duration` shorter or `output` longer",
        ),
        ("[simulation]\nduration = 0\noutput = 1", "15: simulation.duration: a positive number is needed, not 0"),
        ("[simulation]\nduration = 1", "14: simulation.output: this key is missing; write output = 1e-3"),
        (
            "[simulation]\nduration = 1\noutput = 1\ntolerance = 1",
            "17: simulation.tolerance: a tolerance is a small positive number, such as 1e-9, not 1",
        ),
        (
            f"{PLOT}over = 'motor'",
            '18: plots.p.over: there is no drive "motor"; leave `over` out, for a plot over the time',
        ),
        (
            f"{D}speed = 1\n{PLOT}over = 'e'",
            '21: plots.p.over: there is no drive "e"; the drives are d',
        ),
        (
            f"{PLOT}cut = 'bar'\npieces = [1]",
            "18: plots.p.cut: the body bar is no beam, and beams alone are cut into pieces; the beams are rod",
        ),
        (f"{PLOT}cut = 'rid'\npieces = [1]", '18: plots.p.cut: there is no body "rid"; did you mean "rod"?'),
        (
            f"{PLOT}cut = 'rod'",
            '14: plots.p: `cut` and `pieces` go together: write cut = "rod" and pieces = [1, 2, 3]',
        ),
        (
            f"{PLOT}cut = 'rod'\npieces = [1,\n65]",
            "20: plots.p.pieces[1]: a beam is cut into 1 to 64 pieces, not 65",
        ),
        (
            f"{PLOT}cut = 'rod'\npieces = 3",
            "19: plots.p.pieces: a list of whole numbers is needed, such as [1, 2, 3], not a number",
        ),
        (
            PLOT.replace("rod.right", "rod.left"),
            "16: plots.p.chord: a chord is between two markers, and these are the same",
        ),
        (PLOT.replace("= 1", "= 0"), "17: plots.p.divided_by: a positive number is needed, not 0"),
        (
            "[scene]\ngravity = 9.81",
            "15: scene.gravity: a list of 2 components is needed, such as [0, -9.81], not a number",
        ),
        (
            '[scene]\nstart = "rest"',
            '15: scene.start: the start of a scene is one of "equilibrium", "steady", not "rest"',
        ),
        (
            f"{D}speed = 1\nstart = {{ displacement = 1 }}",
            "17: drives.d.start.displacement: the revolute joint pin has no displacement; write `angle` instead",
        ),
        (
            "[joints.w]\nkind = 'weld'\nbetween = ['bar.a', 'rod.left']\nstart = { angle = 1 }",
            "17: joints.w.start: this joint has no relative coordinate that could have initial values",
        ),
        (
            "[joints.t]\nkind = 'translational'\nbetween = ['bar.a', 'rod.left']\nstart = { angle = 1 }",
            "17: joints.t.start.angle: the translational joint t has no angle; write `displacement` instead",
        ),
        ("[scene]\nwind = 1", "15: scene.wind: unknown key; the keys here are gravity, start, lowering, redundant"),
        ("[joint.x]", '14: joint: unknown key; did you mean "joints"?'),
        ("[drives]\nd = 3", "15: drives.d: a table is needed here, not a number"),
        (
            "[[forces]]",
            "14: forces: a table of forces by their names is needed, such as [forces.load], not a list",
        ),
        (
            "\n".join(f"[forces.f{n}]" for n in range(MAX_NAMED + 1)),
            f"14: forces: there are {MAX_NAMED + 1} forces, and 0 to {MAX_NAMED} are allowed",
        ),
        (
            "[beam]",
            "4: bodies: a file specifies a body alone or a scene, and here are [beam] and [bodies]; leave one "
            "of them out",
        ),
        (
            "[body]\nmodes = 3",
            "4: bodies: a file specifies a body alone or a scene, and here are [body] and [bodies]; "
            "leave one of them out",
        ),
        (
            "[simulation]\nname = 's'\nduration = 1\noutput = 1",
            "15: simulation.name: this key belongs above the table [simulation]",
        ),
    ],
)
def test_a_fault_of_the_other_tables(more, message):
    assert errors(small(more=more)) == [message]


EMPTY = "bodies: a scene needs bodies; write one, such as [bodies.rod]"


@pytest.mark.parametrize(
    ("text", "messages"),
    [
        ('name = "s"\n[scene]', [f" {EMPTY}"]),
        ('name = "s"\n[bodies]', [f"2: {EMPTY}"]),
        (
            'name = "s"\nbodies = 3',
            ["2: bodies: a table of bodies by their names is needed, such as [bodies.rod], not a number"],
        ),
        (
            'name = "s"\nsimulation = 3\n[bodies.a]\nframe = "mean"',
            ["2: simulation: a table is needed here, not a number"],
        ),
        (
            "[bodies.a]\nmass = 1",
            [
                ' name: this key is missing; write name = "mechanism"',
                "1: bodies.a: no joint holds this body, so that it needs inertia; write inertia = 1.0",
            ],
        ),
        (
            'name = "s"\ngravity = [0, 1]\n[bodies.a]\nframe = "mean"',
            ["2: gravity: this key belongs in the table [scene]"],
        ),
        (
            'name = "s"\n[beam]\n[joints.x]',
            [
                "3: joints: a file specifies a body alone or a scene, and here are [beam] and [joints]; leave one of "
                "them out"
            ],
        ),
    ],
)
def test_a_fault_of_the_whole(text, messages):
    assert errors(text) == messages


def test_all_faults_of_a_scene_are_reported_at_once_in_the_order_of_the_file(tmp_path):
    text = """\
name = "double"
[ground.markers]
bearing = [0]
[bodies.crank]
markers = { hub = [0, 0], pin = [0.15, 0] }
[bodies.rod]
ansatz = ["1", "xi"]
mass = -1
markers = { left = -1, right = 2 }
[bodies.slider]
mass = 1
[joints.bearing]
kind = "revolute"
between = ["ground.bearing", "crank.hib"]
[joints.pin]
kind = "weldd"
between = ["crank.pin", "rod.left", "rod.right"]
[drives.motor]
joint = "baring"
motion = "150*T"
[plots.p]
deflection = "rod.middle"
chord = ["rod.left", "rod.right"]
divided_by = 0.3
over = "moter"
reference = { file = "none.csv", x = "a", y = "b" }
"""
    found = errors(text, str(tmp_path / "s.toml"))
    assert [line.removeprefix(f"{tmp_path}/s.toml:").split(": ")[:2] for line in found] == [
        ["1", "name"],
        ["3", "ground.markers.bearing"],
        ["7", "bodies.rod.ansatz"],
        ["8", "bodies.rod.mass"],
        ["9", "bodies.rod.markers.right"],
        ["14", "joints.bearing.between[1]"],
        ["16", "joints.pin.kind"],
        ["17", "joints.pin.between"],
        ["19", "drives.motor.joint"],
        ["20", "drives.motor.motion"],
        ["22", "plots.p.deflection"],
        ["25", "plots.p.over"],
        ["26", "plots.p.reference.file"],
    ]


def test_a_wrong_scene_ends_the_command_with_2_and_its_lines(tmp_path, capsys):
    path = tmp_path / "s.toml"
    path.write_text(small(("mass = 1", "mas = 1")))
    assert main(["build", str(path), "--out", str(tmp_path)]) == 2
    assert f'{path}:5: bodies.bar.mas: unknown key; did you mean "mass"?' in capsys.readouterr().err


def test_what_is_taken_away_from_a_scene_never_crashes():
    """Every line of a scene left out, or its value exchanged for something else, is read or is a SpecError."""
    lines = EVERYTHING.split("\n")
    for i, line in enumerate(lines):
        changes = [None]
        if " = " in line:
            changes += [
                f"{line.split(' = ')[0]} = {value}" for value in ("3", '"x.y"', "[[1], {}]", "{ symbol = 1 }", "[]")
            ]
        for change in changes:
            text = "\n".join([*lines[:i], *([] if change is None else [change]), *lines[i + 1 :]])
            try:
                parse(text)
            except SpecError as error:
                assert all(problem.message for problem in error.problems)


def test_bodies_that_are_too_many_are_counted_and_not_called_unknown():
    assert errors(small(more="\n".join(f"[bodies.b{n}]\nlength = 1" for n in range(MAX_NAMED)))) == [
        f"4: bodies: there are {MAX_NAMED + 2} bodies, and 0 to {MAX_NAMED} are allowed"
    ]


def test_joints_that_are_too_many_are_counted_and_not_called_missing():
    weightless = ("mass = 1\ninertia = 1\n", "\n")
    pins = "\n".join(f"[joints.j{n}]\nkind = 'weld'\nbetween = ['rod.left', 'bar.b']" for n in range(MAX_NAMED))
    assert errors(small(weightless, more=pins)) == [
        f"10: joints: there are {MAX_NAMED + 1} joints, and 0 to {MAX_NAMED} are allowed"
    ]


def test_the_small_scene_is_right():
    assert parse(SMALL).name == "s"


def test_a_beam_with_conditions_at_its_ends_is_not_cut_by_a_plot():
    rod = ("length = 1", "length = 1\nansatz = ['1', 'xi', 'xi^2', 'xi^3', 'xi^4']\nends = 'pinned'")
    assert parse(small(rod, more=f"{PLOT}cut = 'rod'\npieces = [1]")).plots[0].pieces == (1,)
    assert errors(small(rod, more=f"{PLOT}cut = 'rod'\npieces = [1, 2]")) == [f"20: plots.p.cut: {WHOLE_BEAM}"]


def test_a_body_that_keeps_its_coordinates_needs_mass_even_if_a_drive_prescribes_its_motion():
    driven = small(
        ("mass = 1\ninertia = 1\n", "keep_coordinates = true\n"), more='[drives.d]\njoint = "pin"\nspeed = 1\n'
    )
    with pytest.raises(SpecError, match="needs mass and inertia; give them, or leave keep_coordinates out if a drive"):
        derive.derive(parse(driven))
