"""Scenes that are wrong as a whole: all faults are reported at once, and none crashes."""

import pytest
from example_scenes import EVERYTHING, SMALL, errors, small

import derive
from derive.cli.main import main
from derive.errors import SpecError
from derive.spec.tables.shared import MAX_NAMED
from derive.spec.toml.read import parse

NUMBER = 'a number is needed, such as 2, 0.5 or "1/3"'
WHOLE_BEAM = (
    "`ends` and families of shape functions are for beams in one piece: with them the pieces could not bend at the "
    "cuts; leave `pieces` out, or take polynomials without `ends`"
)
PLOT = '[plots.p]\ndeflection = "bar.b"\nchord = ["rod.left", "rod.right"]\ndivided_by = 1\n'


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
