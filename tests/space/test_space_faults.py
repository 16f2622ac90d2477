"""Faults of scenes in space, each a line that says where it is and what to do."""

from __future__ import annotations

import pytest

import derive
from conftest import ROOT
from derive.spec.toml.read import parse
from explicit_motion import moved

TEXT = (ROOT / "examples" / "spatial_crank_slider_rigid.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("at = [0, 0.12, 0.1]", "at = [0, 0.12]", r"with 2 components, and scene\.gravity of one in space, with 3"),
        ("gravity = [0, 0, -9.81]", "gravity = [0, -9.81]", "of one in space, with 3"),
        ("z = [-1, 0, 0], x = [0, 1, 0]", "z = [-1, 0, 0], x = [1, 1, 0]", "are at 135 degrees"),
        ("inertia = [1e-5, 1e-4, 1e-4, 0, 0, 0]", "inertia = [1e-5, 1e-4, 2e-4, 0, 0, 0]", "at most the sum"),
        ("inertia = [1e-5, 1e-4, 1e-4, 0, 0, 0]", "inertia = [1e-5, 1e-4, 1e-4, 1e-3, 0, 0]", "they are positive"),
        ("inertia = [1e-5, 1e-4, 1e-4, 0, 0, 0]", "", "needs inertia"),
        ('kind = "spherical"', 'kind = "sferical"', "spherical"),
        ('"crank.pin", "rod.ball"', '"crank.pin", "rod.bal"', 'did you mean "ball"'),
        ('"crank.pin", "rod.ball"', '"rod.yoke", "rod.ball"', "both markers are on the body rod"),
        ("start = { angle = 0, speed = 6 }", "start = { displacement = 0 }", "has no displacement"),
        ("rotation = { axis = [0, 0, 1], angle = -0.8 }", "rotation = [0, 0, 0, 0]", "length 0"),
    ],
)
def test_faults_have_a_line(old: str, new: str, message: str) -> None:
    assert old in TEXT
    with pytest.raises(derive.SpecError, match=message):
        parse(TEXT.replace(old, new))


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (
            '[springs.s]\nbetween = ["rod.ball", "rod.ball"]\nstiffness = 1',
            "springs.s.between: a spring is between two",
        ),
        ('[forces.f]\nat = "GROUND"\nforce = [0, 0, 1]', "forces.f.at: a force on the ground moves nothing"),
        ('[torques.m]\non = "GROUND"\ntorque = [0, 0, 1]', "torques.m.on: a torque on the ground moves nothing"),
    ],
)
def test_loads_that_move_nothing(more: str, message: str) -> None:
    ground = f"ground.{parse(TEXT).ground[0].name}"
    with pytest.raises(derive.SpecError) as error:
        parse(TEXT.replace("[simulation]", f"{more.replace('GROUND', ground)}\n[simulation]"))
    assert message in str(error.value)


def test_a_spring_between_points_that_a_joint_keeps_together() -> None:
    """Its line has no direction in any state."""
    joint = parse(TEXT).joints[0]
    spring = f'[springs.s]\nbetween = ["{joint.second}", "{joint.first}"]\nstiffness = 1\n'
    with pytest.raises(derive.SpecError, match=r"springs\.s\.between: the joint \w+ holds both markers at one place"):
        parse(TEXT.replace("[simulation]", f"{spring}[simulation]"))
    text = TEXT.replace("hub = [0, 0, 0]", "hub = [0, 0, 0], eye = [0, 0, 0]").replace(
        "[simulation]", f"{spring}[simulation]"
    )
    result = parse(text.replace(f'["{joint.second}", "{joint.first}"]', f'["crank.eye", "{joint.first}"]'))
    with pytest.raises(
        derive.SpecError, match=r"springs\.s\.between: a joint keeps crank\.eye and ground\.\w+ together"
    ):
        derive.derive(result).expanded()


@pytest.mark.parametrize("kind", ["angular_velocity", "angular_acceleration"])
def test_outputs_of_the_rotation_of_a_node(kind: str) -> None:
    text = (
        f'name = "node"\n[bodies.block]\nnodes = "{ROOT / "scenes/block.npz"}"\nunits = "SI"\nmodes = 1\n'
        f'markers = {{ n = 3 }}\n[outputs.w]\nkind = "{kind}"\nmarker = "block.n"\n'
    )
    with pytest.raises(derive.SpecError, match=rf"outputs\.w\.marker: the marker block\.n is a node.*output {kind}"):
        parse(text)


def test_drives_are_those_of_revolute_screw_and_prismatic_joints() -> None:
    drive = '[drives.motor]\njoint = "ball"\nspeed = 1\n'
    with pytest.raises(derive.SpecError, match="drive a revolute, a screw or a prismatic one"):
        parse(TEXT.replace("[simulation]", f"{drive}[simulation]"))


def test_a_linkage_that_cannot_be_assembled_says_what_is_left_of_each_joint() -> None:
    scene = parse(TEXT.replace("at = [0.3, 0, 0]", "at = [0.05, 0, 0]"))
    with pytest.raises(
        derive.SpecError, match=r"joints\.ball: the mechanism cannot be assembled: this is off by 0\.\d+ m"
    ):
        moved(scene)


def test_a_joint_that_is_met_the_wrong_way_round_is_refused() -> None:
    free = """
name = "reversed"
[ground.markers]
o = [0, 0, 0]
[bodies.top]
mass = 1
inertia = [1, 1, 1, 0, 0, 0]
markers = { hub = [0, 0, 0] }
keep_coordinates = true
start = { rotation = { axis = [1, 0, 0], angle = 3.14159 } }
[joints.hinge]
kind = "revolute"
between = ["ground.o", "top.hub"]
[simulation]
duration = 0.1
output = 0.1
"""
    with pytest.raises(derive.SpecError, match=r"joints\.hinge\.between.*wrong way round: z of top\.hub is 180 deg"):
        moved(parse(free))


def test_given_values_that_contradict_joints_are_named() -> None:
    scene = parse(TEXT.replace("guess = true, position = [0.2, 0, 0]", "position = [0.2, 0.05, 0]"))
    with pytest.raises(derive.SpecError, match=r"bodies\.slider\.start\.position.*contradicts"):
        moved(scene)


@pytest.mark.parametrize("value", ["0.5", '"pi/2"'])
def test_a_number_does_not_make_a_start_one_in_space(value: str) -> None:
    text = "[bodies.a]\nmass = 1\ninertia = 1\nmarkers = { o = [0, 0] }\nstart = { rotation = VALUE }\n"
    with pytest.raises(derive.SpecError, match=r'a\.start\.rotation: unknown key; did you mean "angle"'):
        parse(f'name = "plane"\n{text}'.replace("VALUE", value))
