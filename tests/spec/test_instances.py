"""Tables with `count`: their instances, formulas and references, their names, and one line for each fault."""

from __future__ import annotations

import os
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import QUICK
from derive.backends.model_files import emit
from derive.cli.main import main
from derive.cli.specifications import read_changed
from derive.errors import SpecError
from derive.spec.as_tables import specification_tables
from derive.spec.model.instances import identifier, instance_name
from derive.spec.parsing.instance_text import InstanceReference, at_index, contains_index, reference
from derive.spec.parsing.parser import ExpressionError
from derive.spec.set_values import with_values
from derive.spec.toml.read import parse, warnings, with_lines
from explicit_motion import moved

EXAMPLES = Path(__file__).parents[2] / "examples"
CHAIN = """\
name = "chain"
[scene]
gravity = [0, -9.81]
[ground.markers]
hook = [0, 0]
[bodies.link]
count = 4
ansatz = ["1", "xi", "xi^2", "xi^3"]
mass = "1/20*0.9^i"
length = 0.1
bending_stiffness = 0.2
markers = { left = -1, right = 1 }
start = { position = ["0.05 + 0.1*i", 0] }
[joints.hinge]
kind = "revolute"
between = ["ground.hook", "link[0].left"]
[joints.weld]
count = 3
kind = "weld"
between = ["link[i].right", "link[i+1].left"]
[forces.push]
count = 2
at = "link[i + 2].right"
components = [0, "-0.01*(i + 1)*sin(t)"]
[springs.coil]
kind = "rotational"
count = 2
between = ["link[i].right", "link[3].left"]
stiffness = "2^i"
[outputs.tip]
count = 4
kind = "position"
marker = "link[i].right"
[outputs.reaction]
count = 3
kind = "reaction"
joint = "weld[i]"
[plots.last]
deflection = "link[3].right"
chord = ["link[0].left", "link[2].right"]
[simulation]
duration = 0.05
output = 0.01
"""


def chain(*changes: tuple[str, str], more: str = "") -> str:
    text = CHAIN
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return text + more


def errors(*changes: tuple[str, str], more: str = "") -> list[str]:
    with pytest.raises(SpecError) as caught:
        parse(chain(*changes, more=more))
    return [f"{p.line}: {p.path}: {p.message}" for p in caught.value.problems]


def by_loops() -> derive.Scene:
    """The scene of CHAIN from ordinary loops."""

    def marker(name: str) -> derive.MarkerRef:
        return derive.MarkerRef(*name.split("."))

    links = [
        derive.BeamBody(
            f"link[{i}]",
            derive.planar_beam(
                f"link[{i}]",
                ansatz=["1", "xi", "xi^2", "xi^3"],
                mass=Fraction(1, 20) * Fraction(9, 10) ** i,
                length=0.1,
                bending_stiffness=0.2,
                markers={"left": -1, "right": 1},
            ),
            start=derive.InitialValues(position=(Fraction(1, 20) + Fraction(i, 10), 0)),
        )
        for i in range(4)
    ]
    welds = [
        derive.Joint(f"weld[{i}]", "weld", marker(f"link[{i}].right"), marker(f"link[{i + 1}].left")) for i in range(3)
    ]
    return derive.scene(
        "chain",
        gravity=(0, -9.81),
        ground={"hook": (0, 0)},
        bodies=links,
        joints=[derive.Joint("hinge", "revolute", marker("ground.hook"), marker("link[0].left")), *welds],
        forces={
            f"push[{i}]": {"at": f"link[{i + 2}].right", "components": [0, f"-0.01*({i} + 1)*sin(t)"]} for i in range(2)
        },
        springs={
            f"coil[{i}]": {"kind": "rotational", "between": [f"link[{i}].right", "link[3].left"], "stiffness": 2**i}
            for i in range(2)
        },
        outputs={f"tip[{i}]": {"kind": "position", "marker": f"link[{i}].right"} for i in range(4)}
        | {f"reaction[{i}]": {"kind": "reaction", "joint": f"weld[{i}]"} for i in range(3)},
        plots={"last": {"deflection": "link[3].right", "chord": ["link[0].left", "link[2].right"]}},
        simulation=derive.Simulation(0.05, 0.01),
    )


# ---- texts ----


@pytest.mark.parametrize(
    ("text", "i", "value"),
    [
        ("i", 3, 3),
        ("0.05 + 0.1*i", 2, Fraction(1, 4)),
        ("i/2", 4, 2),
        ("0.2*0.9^i", 3, Fraction(729, 5000)),
        ("0.2*0.9^i", 100, Fraction(repr(0.2 * 0.9**100))),  # more digits than are kept
        ("-i^2", 3, -9),
        ("sqrt(i)", 9, 3),
        ("cos(pi*i/6)", 2, Fraction("0.5000000000000001")),
        ("floor(i/7)", 20, 2),
        ("-floor(-i/7)", 20, 3),
        ("0.5*mod(i, 7)", 20, 3),
        ("mod(i - 3, 0.75)", 1, Fraction(1, 4)),
        ("i*xi - 1/i", 3, "3*xi - 1/3"),
        ("-(i+1)*sin(t)", 0, "-(0+1)*sin(t)"),
    ],
)
def test_an_expression_has_a_value_for_each_instance(text, i, value):
    assert at_index(text, i) == value
    assert type(at_index(text, i)) is type(value)


@pytest.mark.parametrize("text", ["xi^2", "1/3", "sin(t)", "link.left", "i.left", "a.b", "revolute"])
def test_other_texts_have_no_index(text):
    assert not contains_index(text)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("link[3].left", InstanceReference("link", ".left", 3, relative=False)),
        ("link[i].left", InstanceReference("link", ".left", 0, relative=True)),
        ("pin[i+12]", InstanceReference("pin", "", 12, relative=True)),
        ("pin[ i - 1 ]", InstanceReference("pin", "", -1, relative=True)),
        ("link.left", None),
        ("0.1*i", None),
    ],
)
def test_references_are_read(text, found):
    assert reference(text) == found


@pytest.mark.parametrize("text", ["a[2*i].b", "a[].b", "a[j].b", "a[i-i].b", "a[-1].b", "a[1.5].b"])
def test_other_indices_are_refused(text):
    with pytest.raises(ExpressionError, match=r"is no index of an instance; write a\[i\], a\[i\+1\], a\[i-1\] or"):
        reference(text)


# ---- instances ----


def test_loops_in_python_make_the_same_scene():
    assert parse(CHAIN) == by_loops()


@pytest.mark.parametrize("count", [100, 1000])
def test_the_long_chains_are_derived(count):
    """They are not simulated: straight-line code of so many bodies takes minutes."""
    scene = derive.read(EXAMPLES / f"chain_{count}.toml")
    assert len(scene.bodies) == len(scene.joints) == count
    assert scene.bodies[-1].start.position == (pytest.approx(0.1 * count - 0.05), 0)
    assert str(scene.joints[-1].second) == f"link[{count - 1}].left"
    mechanism = derive.derive(scene)
    assert len(mechanism.kinds) == 1
    assert len(mechanism.rows) == 5 * count


def test_tables_in_python_may_have_a_count():
    link = {"count": 2, "mass": "i + 1", "inertia": 1, "markers": {"a": [0, "i"]}}
    scene = derive.scene("two", bodies={"link": link})
    assert [body.name for body in scene.bodies] == ["link[0]", "link[1]"]
    assert [body.mass for body in scene.bodies] == [1, 2]
    assert [body.markers[0].y for body in scene.bodies] == [0, 1]


def test_instances_stand_where_their_table_does():
    names = [body.name for body in parse(chain(more="[bodies.last]\nmass = 1\ninertia = 1\n")).bodies]
    assert names == ["link[0]", "link[1]", "link[2]", "link[3]", "last"]


def test_one_instance_has_an_index_too():
    scene = parse('name = "one"\n[bodies.rod]\ncount = 1\nmass = 1\ninertia = 1\n')
    assert [body.name for body in scene.bodies] == ["rod[0]"]


def test_a_scene_is_written_and_read_again():
    scene = parse(CHAIN)
    tables = specification_tables(scene)
    assert [*tables["bodies"]] == ["link[0]", "link[1]", "link[2]", "link[3]"]
    assert derive.scene(tables) == scene


def test_values_of_an_instance_are_replaced():
    scene, (change, other) = with_values(
        parse(CHAIN), {"bodies.link[1].bending_stiffness": "0.3", "outputs.tip[3].marker": "link[3].left"}
    )
    assert str(change) == "bodies.link[1].bending_stiffness: 0.2 -> 0.3, the parameter link_1_bending_stiffness"
    assert str(other) == "outputs.tip[3].marker: link[3].right -> link[3].left"
    assert scene.bodies[1].beam.bending_stiffness == derive.Parameter("link_1_bending_stiffness", "N m^2", 0.3)


# ---- names ----


def test_identifiers_are_names_without_brackets():
    assert identifier(instance_name("link", 3)) == "link_3"
    assert identifier(instance_name("link", 3), "left") == "link_3_left"
    assert identifier("tip", "") == "tip"


def test_code_and_columns_have_identifiers_and_texts_have_names():
    equations = derive.derive(parse(CHAIN)).expanded()
    assert equations.coordinates[5].q.name == "link_1_c1"
    assert equations.coordinates[5].doc.startswith("link[1]: ")
    assert [c.name for c in equations.constraints][2] == "weld_0_1"
    assert equations.constraints[2].doc == "link[0].right and link[1].left coincide along e1"
    assert [o.name for o in equations.outputs][:2] == ["tip_0_1", "tip_0_2"]
    assert [marker.name for marker in equations.markers][:2] == ["link_0_left", "link_0_right"]
    assert [pose.name for pose in equations.poses][1] == "link[1]"


@pytest.mark.long
def test_a_scene_moves_like_the_one_with_other_names():
    """The same scene with the names of the identifiers: the code is the same, and so is every digit."""

    def renamed(value):
        if isinstance(value, dict):
            return {identifier(key): renamed(item) for key, item in value.items()}
        if isinstance(value, list):
            return [renamed(item) for item in value]
        return identifier(value) if isinstance(value, str) else value

    tables = specification_tables(parse(CHAIN))
    plain = {section: renamed(table) if section != "simulation" else table for section, table in tables.items()}
    one, other = moved(parse(CHAIN)), moved(derive.scene(plain))
    assert one.q.tobytes() == other.q.tobytes()
    assert one.model.coordinates[3].name == other.model.coordinates[3].name == "link_0_alpha1"
    assert [*map(identifier, one.columns)] == [*other.columns]


# ---- columns ----


def test_columns_have_the_names_of_instances() -> None:
    """Coordinates, rates, multipliers and outputs, in plots and conditions as well."""
    text = CHAIN.replace("[simulation]", '[plots.turn]\ny = ["link[2]_phi", "tip[3]_1"]\n[simulation]')
    motion = moved(parse(text), until="link[1]_phi < -0.001", duration=0.05)
    names = ["link[3]_alpha2", "link[0]_phidot", "lambda_weld[2]_turn", "lambda_hinge_1", "tip[1]_2", "reaction[0]_1"]
    assert set(names) <= set(motion.columns)
    assert not any("link_" in name for name in motion.columns)
    assert motion["link[1]_phi"][-1] == pytest.approx(-0.001) and motion.t[-1] < 0.05


def test_a_column_has_one_name() -> None:
    with pytest.raises(SpecError, match=r'there is no column "link_2_phi"; did you mean "link\[2\]_phi"'):
        parse(CHAIN.replace("[simulation]", '[plots.turn]\ny = ["link_2_phi"]\n[simulation]'))


# ---- numbers of instances ----


def test_the_number_of_instances_may_be_set(tmp_path: Path) -> None:
    file = tmp_path / "chain.toml"
    file.write_text((EXAMPLES / "chain_100.toml").read_text())
    scene, changes = read_changed(
        file, [("bodies.link.count", "12"), ("joints.weld.count", "11"), ("bodies.link[3].mass", "2")]
    )
    assert [body.name for body in scene.bodies] == [f"link[{i}]" for i in range(12)] and len(scene.joints) == 12
    assert [str(change) for change in changes][:2] == ["bodies.link.count: 100 -> 12", "joints.weld.count: 99 -> 11"]
    with pytest.raises(SpecError, match=r"29: joints\.weld\.between.*the count of link is 12"):
        read_changed(file, [("bodies.link.count", "12")])
    with pytest.raises(SpecError, match=r"bodies\.link\.count: there are 4, and another number makes another model"):
        with_values(parse(CHAIN), {"bodies.link.count": "5"})


DRIVEN = """\
name = "driven"
[ground.markers]
hook = [0, 0]
[bodies.hub]
count = 3
mass = 1
inertia = 0.1
markers = { a = [0, 0], b = [1, 0] }
start = { position = ["i", 0] }
[joints.first]
kind = "revolute"
between = ["ground.hook", "hub[0].a"]
[joints.pin]
count = 2
kind = "revolute"
between = ["hub[i].b", "hub[i+1].a"]
[drives.motor]
count = 2
joint = "pin[i]"
motion = "0.1*(i + 1)*sin(t)"
[simulation]
duration = 0.1
output = 0.05
"""


def test_drives_may_have_a_count() -> None:
    motion = moved(parse(DRIVEN))
    assert motion["motor[1]"] == pytest.approx(0.2 * np.sin(motion.t))
    assert motion["hub[2]_phi"] - motion["hub[1]_phi"] == pytest.approx(0.2 * np.sin(motion.t), abs=1e-9)
    assert {"motor[0]", "lambda_motor[0]", "lambda_motor[1]"} <= set(motion.columns)


PUSHED = (
    DRIVEN.replace('motion = "0.1*(i + 1)*sin(t)"', 'motion = { input = "turn[i]" }')
    + """
[inputs.turn]
count = 2
unit = "rad"
value = "0.1*(i + 1)*sin(t)"
[inputs.push]
count = 3
unit = "N"
value = "0.3*i"
[forces.push]
count = 3
at = "hub[i].b"
components = [0, { input = "push[i]" }]
"""
)


def test_symbols_may_have_the_index() -> None:
    spec = parse(chain(("length = 0.1\n", 'length = { symbol = "L[i]", default = "0.1 + i/100" }\n')))
    lengths = [body.beam.length for body in spec.bodies]
    assert [length.symbol for length in lengths] == [f"L_{i}" for i in range(4)]
    assert lengths[1].default == 0.11


def test_inputs_may_have_a_count() -> None:
    """They give the motion of the scene in which their values are written, and have names and columns of instances."""
    by_hand = DRIVEN + '[forces.push]\ncount = 3\nat = "hub[i].b"\ncomponents = [0, "0.3*i"]\n'
    np.testing.assert_array_equal(moved(parse(PUSHED)).q, moved(parse(by_hand)).q)
    given = {f"turn[{i}]": lambda t, i=i: 0.1 * (i + 1) * np.array([np.sin(t), np.cos(t), -np.sin(t)]) for i in (0, 1)}
    motion = moved(parse(PUSHED), inputs=given)
    np.testing.assert_allclose(motion["u_turn[1]_dot"], 0.2 * np.cos(motion.t), rtol=1e-14)
    assert [given.name for given in motion.model.inputs][:3] == ["turn_0", "turn_0_dot", "turn_0_ddot"]
    with pytest.raises(SpecError, match=r'components\[1\]: for i = 2: there is no input "push\[2\]"'):
        parse(PUSHED.replace('count = 3\nunit = "N"', 'count = 2\nunit = "N"'))


@pytest.mark.parametrize("lowering", ["flat", "instances"])
def test_loaded_inputs_have_names_of_instances(lowering: str) -> None:
    spec = parse(PUSHED.replace("[ground", f'[scene]\nlowering = "{lowering}"\n[ground'))
    native = derive.load(emit(derive.lower(derive.derive(spec)), spec), QUICK)
    assert native.inputs[2:5] == ("turn[0]_ddot", "turn[1]", "turn[1]_dot") and native.inputs[-1] == "push[2]"


# ---- faults ----


@pytest.mark.parametrize(
    ("changes", "lines"),
    [
        (
            [("count = 4\nansatz", "count = 3\nansatz")],
            [
                "20: joints.weld.between[1]: for i = 2: there is no link[3]: the count of link is 3, and its index is "
                "from 0 to 2",
                "23: forces.push.at: for i = 1: there is no link[3]: the count of link is 3, and its index is from 0 "
                "to 2",
                "28: springs.coil.between[1]: there is no link[3]: the count of link is 3, and its index is from 0 to "
                "2",
                "33: outputs.tip.marker: for i = 3: there is no link[3]: the count of link is 3, and its index is from "
                "0 to 2",
                '39: plots.last.deflection: there is no body "link[3]"; did you mean "link[2]" or "link[1]"?',
            ],
        ),
        (
            [("count = 4\nansatz", "count = 0\nansatz")],
            ["7: bodies.link.count: a count is a whole number from 1 to 10000, not 0"],
        ),
    ],
)
def test_faults_of_counts(changes, lines):
    assert errors(*changes) == lines


@pytest.mark.parametrize("count", ["-1", "10001", "1.0", '"4"', "true", "[4]"])
def test_a_count_is_a_whole_number(count):
    (line,) = errors(("count = 4\nansatz", f"count = {count}\nansatz"))
    assert line.startswith("7: bodies.link.count: a count is a whole number from 1 to 10000, not ")


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("0.05 + 0.1*i", "0.05/(i - 2)", '13: bodies.link.start.position[0]: for i = 2: column 6 of "0.05/(2 - 2)": '),
        ("1/20*0.9^i", "sqrt(2 - i)", "9: bodies.link.mass: "),
        ("1/20*0.9^i", "10^i^2", '9: bodies.link.mass: for i = 0 to 3: column 5 of "10^0^2": a power of a power '),
        ("1/20*0.9^i", "9^9999*i", '9: bodies.link.mass: for i = 0 to 3: column 2 of "9^9999*0": the number is too '),
        ("1/20*0.9^i", "i*t", '9: bodies.link.mass: for i = 0 to 3: column 3 of "0*t": "t" is no number; '),
        ("1/20*0.9^i", "2 - i", "9: bodies.link.mass: for i = 2 and 3: a positive number is needed, not 0"),
        ("1/20*0.9^i", "-1", "9: bodies.link.mass: a positive number is needed, not -1"),
        ("mass = ", "masss = ", '9: bodies.link.masss: unknown key; did you mean "masses" or "mass"?'),
        ('kind = "weld"', 'kind = "wld"', "19: joints.weld.kind: the joint is one of "),
        (
            'link[i].right", "link[i+1]',
            'lnk[i].right", "link[i+1]',
            '20: joints.weld.between[0]: there is no table "lnk" with a count; did you mean "link"?',
        ),
        ('link[i].right", "link[i+1]', 'hinge[i].right", "link[i+1]', "20: joints.weld.between[0]: there is no table"),
        (
            'link[i].right", "link[i+1]',
            'link.right", "link[i+1]',
            '20: joints.weld.between[0]: there is no body "link"',
        ),
        (
            'link[i].right", "link[i+1]',
            'link[i-1].right", "link[i+1]',
            "20: joints.weld.between[0]: for i = 0: there "
            "is no link[-1]: the count of link is 4, and its index is from 0 to 3",
        ),
        (
            'link[i].right", "link[i+1]',
            'link[i].rigt", "link[i+1]',
            '20: joints.weld.between[0]: for i = 0 to 2: the body link[0] has no marker "rigt"; did you mean "right"?',
        ),
        (
            '"weld[i]"',
            '"hinge[i]"',
            '37: outputs.reaction.joint: hinge has no count, and is referred to without an index; write "hinge"',
        ),
        ('"weld[i]"', '"weld[i-i]"', '37: outputs.reaction.joint: "i-i" is no index of an instance; write weld[i], '),
    ],
)
def test_a_fault_of_all_instances_is_one_line(old, new, line):
    first, *others = errors((old, new))
    assert first.startswith(line)
    assert len(others) == ("sqrt" in new)  # the square root is zero for one i and not real for another


def test_square_roots_that_are_not_real():
    assert errors(("1/20*0.9^i", "sqrt(2 - i)")) == [
        '9: bodies.link.mass: for i = 3: column 1 of "sqrt(2 - 3)": the square root of a negative number is not real',
        "9: bodies.link.mass: for i = 2: a positive number is needed, not 0",
    ]


@pytest.mark.parametrize(
    ("more", "line"),
    [
        (
            "[bodies.link_2]\nlength = 1\n",
            '44: bodies.link_2: "link_2_c1", a coordinate of the body link_2, is taken: it is a coordinate of the body '
            "link[2]; choose another name",
        ),
        ('[bodies."link[2]"]\nlength = 1\n', '6: bodies.link: "link[2]" is the name of another table; choose another'),
        (
            '[joints.weld_1]\nkind = "weld"\nbetween = ["ground.hook", "link[2].left"]\n',
            '44: joints.weld_1: "weld_1_1", a name of the joint weld_1, is taken: it is a name of the joint weld[1]; ',
        ),
        ('[outputs.tip_0]\nkind = "energy"\n', None),
        (
            '[outputs.tip_0]\nkind = "position"\nmarker = "link[1].left"\n',
            '44: outputs.tip_0: "tip_0_1" is taken: it is a component of the output tip[0]; choose another name',
        ),
        ("[parameters.i]\ndefault = 1\n", '44: parameters.i: "i" is taken: it is the index in tables with `count`; '),
        (
            '[bodies."2x"]\ncount = 3\nmass = 1\ninertia = 1\n',
            '44: bodies.2x: "2x" cannot be a name: it must begin with',
        ),
    ],
)
def test_two_names_that_meet(more, line):
    if line is None:
        assert parse(chain(more=more)).outputs[-1].name == "tip_0"
        return
    first, *_ = errors(more=more)
    assert first.startswith(line)


def test_all_faults_are_reported_at_once():
    lines = errors(("1/20*0.9^i", "1/i"), ('kind = "weld"', 'kind = "wld"'), ("weld[i]", "weld[i+1]"))
    assert [line.partition(": ")[0] for line in lines] == ["9", "19", "37"]
    assert "for i = 0: " in lines[0]
    assert "for i = 2: there is no weld[3]" in lines[2]


def test_many_instances_with_many_faults_are_few_lines():
    many = chain(
        ("0.9^i", "0.99^i"), ("count = 4\nansatz", "count = 1000\nansatz"), ("count = 3\nkind", "count = 999\nkind")
    )
    text = many.replace("length = 0.1", "lenght = 0.1\ncolour = 1").replace('"link[i].right", "', '"lik.right", "', 1)
    with pytest.raises(SpecError) as caught:
        parse(text)
    assert [p.line for p in caught.value.problems] == [10, 11, 21]


def test_a_count_belongs_to_some_sections():
    assert any(text.startswith("45: plots.m.count: unknown key") for text in errors(more="[plots.m]\ncount = 2\n"))


def test_warnings_of_instances_are_one(tmp_path: Path):
    path = tmp_path / "chain.toml"
    path.write_text(chain(("length = 0.1\n", "")))
    (warning,) = warnings(path)
    assert warning.startswith(f"{path}:6: bodies.link.length: no length is given")


def test_faults_of_the_derivation_have_the_line_of_their_table(tmp_path: Path):
    text = 'name = "two"\n[ground.markers]\no = [0, 0]\n[bodies.arm]\ncount = 2\nmarkers = { a = [0, 0] }\n'
    text += '[joints.pin]\nkind = "revolute"\ncount = 2\nbetween = ["ground.o", "arm[i].a"]\n'
    text += '[drives.m]\njoint = "pin[0]"\nspeed = 1\n[drives.n]\njoint = "pin[1]"\nspeed = 1\n'
    path = tmp_path / "two.toml"
    path.write_text(text)
    problem = derive.errors.Problem("bodies.arm[1]", "it has no mass")
    assert str(with_lines(SpecError((problem,)), path)) == f"{path}:4: bodies.arm: for i = 1: it has no mass"


@pytest.mark.long
def test_hash_seed_does_not_matter():
    code = "import sys, derive\nfrom derive.spec.toml.read import parse\ntext = sys.stdin.read()\n"
    code += "print(derive.short_text.full_text(parse(text)), derive.derive(parse(text)))\n"
    code += "try: parse(text.replace('i+1', 'i+2').replace('0.9^i', '1/i'))\n"
    code += "except derive.SpecError as error: print(error)\n"
    results = {
        subprocess.run(
            [sys.executable, "-c", code],
            input=CHAIN,
            capture_output=True,
            text=True,
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed},
        ).stdout
        for seed in ("0", "1")
    }
    assert len(results) == 1


def test_build_names_alike_instances_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "stands.toml"
    path.write_text(
        """
name = "stands"
[ground.markers]
foot = [0, 0]
[bodies.stand]
count = 3
markers = { foot = [0, 0], top = ["i", 1] }
[joints.stand]
count = 3
kind = "weld"
between = ["ground.foot", "stand[i].foot"]
[bodies.weight]
mass = 1
inertia = 1
markers = { hook = [0, 0] }
[springs.rope]
count = 3
between = ["stand[i].top", "weight.hook"]
stiffness = 10
"""
    )
    assert main(["build", str(path), "--out", str(tmp_path)]) == 0
    stands = [line for line in capsys.readouterr().out.splitlines() if "stand[" in line]
    assert len(stands) == 1 and "stand[i], i = 0 to 2: joint stand[i] fixes it to the ground" in stands[0]


def test_references_without_an_index_of_their_own_are_checked_beside_a_count_that_is_none() -> None:
    text = CHAIN.replace("[simulation]", "[bodies.foot]\ncount = 0\nmass = 1\ninertia = 1\n[simulation]")
    text += '\n[outputs.far]\nkind = "position"\nmarker = "link[7].right"\n'
    with pytest.raises(SpecError) as raised:
        parse(text)
    assert "a count is a whole number from 1 to 10000, not 0" in str(raised.value)
    assert "outputs.far.marker: there is no link[7]: the count of link is 4, and its index is from 0 to 3" in str(
        raised.value
    )
