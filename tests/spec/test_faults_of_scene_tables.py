"""Tables of scenes other than bodies and joints that are wrong: every fault has its line and a sentence that helps."""

import pytest
from example_scenes import errors, small
from test_scene_faults import NUMBER, PLOT

from derive.spec.tables.shared import MAX_NAMED

WAYS = 'write either motion = "0.1*sin(2*pi*t)", a function of t, or speed = 150'
FUNCTION = (
    "a function of the time is made of numbers, t, pi, parameters, + - * / ^, parentheses, the functions sin, cos, "
    "sqrt, exp, log, tanh, abs, min, max, atan2, step, piecewise, and tables"
)
D = '[drives.d]\njoint = "pin"\n'
BOTH = '[springs.s1]\nbetween = ["ground.o", "bar.b"]\n'
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
