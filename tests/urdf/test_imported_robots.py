"""Scenes of robots: their rigid bodies, their names, what they note, and how they move."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import derive
from derive.cli.main import main
from derive.errors import SpecError
from derive.export.urdf.description import roll_pitch_yaw, urdf_text
from derive.spec.files.xml_tree import parse_xml
from derive.spec.toml.read import parse
from derive.urdf.read import read_robot, robot_of
from derive.urdf.robot import Origin
from derive.urdf.texts import list_text
from derive.urdf.written_scene import written_scene
from explicit_motion import moved

ARM = Path(__file__).parent / "arm.urdf"
LENGTHS, MASSES, INERTIAS, CENTRES = (0.5, 0.4), (2.0, 1.0), (0.05, 0.02), (0.2, 0.15)
TWO_LINKS = f"""
<robot name="two">
  <link name="world"/>
  <link name="one"><inertial><origin xyz="{CENTRES[0]} 0 0"/><mass value="{MASSES[0]}"/>
    <inertia ixx="0.001" ixy="0" ixz="0" iyy="{INERTIAS[0]}" iyz="0" izz="{INERTIAS[0]}"/></inertial></link>
  <link name="two"><inertial><origin xyz="{CENTRES[1]} 0 0"/><mass value="{MASSES[1]}"/>
    <inertia ixx="0.001" ixy="0" ixz="0" iyy="{INERTIAS[1]}" iyz="0" izz="{INERTIAS[1]}"/></inertial></link>
  <joint name="a" type="continuous"><parent link="world"/><child link="one"/><axis xyz="0 -1 0"/></joint>
  <joint name="b" type="continuous"><parent link="one"/><child link="two"/><origin xyz="{LENGTHS[0]} 0 0"/>
    <axis xyz="0 -1 0"/><dynamics damping="0.3"/></joint>
</robot>
"""


def falling(_: float, state: np.ndarray) -> np.ndarray:
    """The rates of a pendulum of two links in the vertical plane, of textbooks, with damping in the second joint."""
    (a, b, adot, bdot), (m1, m2), (c1, c2), l1, g = state, MASSES, CENTRES, LENGTHS[0], 9.81
    coupling = m2 * l1 * c2 * np.cos(b)
    m22 = INERTIAS[1] + m2 * c2**2
    mass = np.array(
        [[INERTIAS[0] + m1 * c1**2 + m2 * l1**2 + m22 + 2 * coupling, m22 + coupling], [m22 + coupling, m22]]
    )
    s = m2 * l1 * c2 * np.sin(b)
    bias = np.array([-s * bdot * (2 * adot + bdot), s * adot**2 + 0.3 * bdot])
    second = m2 * c2 * g * np.cos(a + b)
    weight = np.array([(m1 * c1 + m2 * l1) * g * np.cos(a) + second, second])
    return np.concatenate([state[2:], np.linalg.solve(mass, -bias - weight)])


def test_an_arm_falls_as_the_equations_of_textbooks_say() -> None:
    """Also where its second joint, which is damped, turns by more than half a turn."""
    text = written_scene(robot_of(parse_xml(TWO_LINKS.encode()))).text
    for speed in (-14, 60):
        text = text.replace("start = { angle = 0 }", f"start = {{ angle = 0, speed = {speed} }}", 1)
    scene = parse(text)
    run = moved(scene, duration=1, output=0.02, tolerance=1e-10)
    start, rows = np.array([0.0, 0, -14, 60]), np.arange(51) * 0.02
    expected = solve_ivp(falling, (0, 1), start, "DOP853", rows, rtol=1e-11, atol=1e-11).y
    assert abs(expected[1]).max() > 3.2
    for name, angle in zip(("q_a", "q_b"), expected[:2], strict=True):
        assert abs(np.exp(1j * run[name]) - np.exp(1j * angle)).max() < 1e-6


def test_links_that_are_fixed_to_each_other_are_one_body() -> None:
    """Mass, first moment and tensor about the origin are sums over the links, in the frame of the first."""
    fore = next(body for body in parse(written_scene(read_robot(ARM)).text).bodies if body.name == "fore")
    centre = np.array([float(x) for x in fore.centre])
    turned = Origin((0, 0, 0.3), (0.3, -0.4, 0.6)).placement
    tool = turned.position + turned.rotation @ np.array([0, 0.02, 0.05])
    assert float(fore.mass) == pytest.approx(2.6)
    np.testing.assert_allclose(2.6 * centre, 2 * np.array([0, 0, 0.15]) + 0.6 * tool, atol=1e-15)
    own = np.array([[0.002, 0.0003, 0], [0.0003, 0.001, 0], [0, 0, 0.0015]])
    inner = Origin((0, 0, 0), (0, 0, 0.4)).placement.rotation
    axes = turned.rotation @ inner
    about_origin = np.diag([0.02, 0.02, 0.002]) + axes @ own @ axes.T
    for mass, at in ((2, np.array([0, 0, 0.15])), (0.6, tool), (-2.6, centre)):
        about_origin += mass * (at @ at * np.eye(3) - np.outer(at, at))
    xx, yy, zz, xy, xz, yz = (float(x) for x in fore.inertia)
    np.testing.assert_allclose([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], about_origin, atol=1e-15)


def test_notes_say_what_is_left_out_and_renamed() -> None:
    notes = "\n".join(written_scene(read_robot(ARM)).notes)
    for text in (
        "base.link (12 kg) is fixed to the ground",
        'renamed: "arm-2" -> arm_2',
        "friction is left out, of turn",
        "outside of the limits of shoulder",
        "not read: 1 <gazebo>, 1 <material>, 1 <transmission>",
    ):
        assert text in notes


def test_joints_that_follow_fixed_ones_stay_where_these_hold_them() -> None:
    """A finger that follows a joint without motion is part of its hand, turned by its offset."""
    text = ARM.read_text().replace('name="open_left" type="revolute"', 'name="open_left" type="fixed"')
    scene = written_scene(robot_of(parse_xml(text.encode())))
    assert "do not move, since the joints that they follow do not: open_right" in scene.notes
    assert {body.name for body in parse(scene.text).bodies} == {"ball", "puck", "column", "upper", "fore"}


def test_names_of_links_and_joints_that_meet() -> None:
    """A link and a joint of one name, and names that no scene allows, become different names."""
    text = TWO_LINKS.replace('"one"', '"a"').replace('"two"', '"for"').replace('name="b"', 'name="A"')
    scene = parse(written_scene(robot_of(parse_xml(text.encode()))).text)
    names = [x.name for x in (*scene.bodies, *scene.joints)]
    assert len({name.lower() for name in names}) == 4 and scene.name not in names


def test_a_comment_cannot_end_early() -> None:
    """Names with line breaks stay in their comments."""
    text = TWO_LINKS.replace('name="two">\n', 'name="two&#10;[bodies]&#10;x">\n', 1)
    assert parse(written_scene(robot_of(parse_xml(text.encode()))).text).name == "two_bodies_x"


@pytest.mark.parametrize("rpy", [(0.3, -0.2, 2.0), (0.5, np.pi / 2, 0.7), (-3, -np.pi / 2 + 1e-11, 1), (0, 0, 0)])
def test_angles_make_the_rotation_again(rpy: tuple[float, float, float]) -> None:
    rotation = Origin((0, 0, 0), rpy).placement.rotation
    again = Origin((0, 0, 0), roll_pitch_yaw(rotation)).placement.rotation
    assert abs(again - rotation).max() < 3e-15


def test_links_without_mass_and_one_named_world_are_exported() -> None:
    """The ground gets another name than a body, and what has no mass between joints has none again."""
    solid = '<inertial><mass value="1"/><inertia ixx="1" iyy="1.2" izz="1.4"/></inertial>'
    ends = [
        f'<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/></joint>'
        for name, parent, child in (("j", "world", "cross"), ("k", "cross", "tip"))
    ]
    links = f'<link name="world">{solid}</link><link name="cross"/><link name="tip">{solid}</link>'
    first = written_scene(robot_of(parse_xml(f'<robot name="r">{links}{"".join(ends)}</robot>'.encode())), "free").text
    again = robot_of(parse_xml(urdf_text(parse(first)).encode()))
    assert again.root == "world_2"
    assert [name for name, link in again.links.items() if not link.inertia] == ["world_2", "cross"]
    assert [joint.kind.value for joint in again.joints.values()] == ["floating", "continuous", "continuous"]


def test_what_a_description_cannot_have() -> None:
    """Loops, flexible bodies, drives and other joints are named together."""
    text = (Path(__file__).parents[2] / "examples" / "spatial_crank_slider_beam.toml").read_text()
    with pytest.raises(SpecError) as caught:
        urdf_text(parse(text))
    said = str(caught.value)
    assert "bodies.rod: this body is flexible" in said
    assert "a URDF has no universal joints; it has these: revolute, prismatic, planar, fixed" in said


def test_the_command_writes_a_file_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "new" / "arm.toml"
    assert main(["import", str(ARM), "--base", "free", "--out", str(target), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["specification"] == str(target) and len(said["notes"]) == 4
    assert len(derive.read(target).bodies) == 8
    before = target.read_bytes()
    assert main(["import", str(ARM), "--out", str(target)]) == 2
    assert "this file exists and is left alone" in capsys.readouterr().err
    assert target.read_bytes() == before
    assert main(["import", str(tmp_path / "none.urdf")]) == 2
    assert "none.urdf: the file cannot be read" in capsys.readouterr().err


ROUNDED = """<robot name="r"><link name="a"/>
<link name="b"><inertial><origin xyz="0.1 2e-18 0" rpy="0 1.5707963 0"/><mass value="1"/>
<inertia ixx="1" iyy="1.2" izz="1.4"/></inertial></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><origin rpy="3.14159265359 1.57079632679 0"/>
<axis xyz="0 0 1"/></joint></robot>"""


def test_builds_say_how_inverse_dynamics_are_added(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "r.urdf").write_text(TWO_LINKS)
    assert main(["import", str(tmp_path / "r.urdf"), "--out", str(tmp_path / "r.toml")]) == 0
    notes = []
    for options in ([], ["--functions", "inverse_dynamics"]):
        assert main(["build", str(tmp_path / "r.toml"), "--out", str(tmp_path), *options]) == 0
        notes.append("without inverse dynamics" in capsys.readouterr().out)
    assert notes == [True, False]


def test_angles_that_round_right_angles_are_right_angles() -> None:
    """The scene is that of a description with all digits of pi; angles that are given as others remain."""
    element = parse_xml(ROUNDED.encode())
    scene = written_scene(robot_of(element))
    assert "taken for right angles, within 4.9e-12 rad: 2 angles (--keep-angles leaves them as they are)" in scene.notes
    digits = ROUNDED.replace("3.14159265359", repr(math.pi)).replace("1.57079632679", repr(math.pi / 2))
    exact = written_scene(robot_of(parse_xml(digits.encode())))
    assert scene.text.split("name =", 1)[1] == exact.text.split("name =", 1)[1]
    assert "j = { at = [0, 0, 0], rotation = { x = [0, 0, -1], z = [-1, 0, 0] } }" in scene.text
    assert "centre = [0.1, 0, 0]" in scene.text
    kept = written_scene(robot_of(element, keep_angles=True))
    assert not any("right angle" in note for note in kept.notes)
    assert "3.14159265359" in kept.text


def test_rounding_errors_of_zeros_are_zeros() -> None:
    """Numbers that are small beside the largest one of their array; all others have all their digits."""
    assert list_text([0.1, 2e-18, -1e-14, 1 / 3]) == "[0.1, 0, -1e-14, 0.3333333333333333]"
    assert list_text([1e-20, -3e-20]) == "[1e-20, -3e-20]"
