"""Bodies and joints of scenes that are wrong: every fault has its line, its key, and a sentence that helps."""

import pytest
from example_scenes import errors, small
from test_scene_faults import NUMBER, WHOLE_BEAM

WHOLE = "a whole number is needed, zero or more, such as 8"
COORDINATES = "a list of 2 coordinates is needed, such as [0.15, 0]"
BEAM = "length, bending_stiffness, ansatz, frame"
JOINTS = 'the joint is one of "revolute", "weld", "fixed", "translational"'
PLACE = 'write a body and one of its markers with a dot between, such as "rod.left" or "ground.bearing"'
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
