"""Tables with `count`: their instances, formulas and references, and their names in columns and code."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

import derive
from derive.cli.main import main
from derive.errors import SpecError
from derive.spec.as_tables import specification_tables
from derive.spec.parsing.instance_text import InstanceReference, at_index, contains_index, reference
from derive.spec.parsing.parser import ExpressionError
from derive.spec.set_values import with_values
from derive.spec.toml.read import parse

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
