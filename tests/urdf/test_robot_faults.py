"""Descriptions of robots that cannot be read: all faults at once, each with its line, and nothing beyond the limits."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from derive.errors import SpecError
from derive.spec.files import xml_tree
from derive.spec.files.xml_tree import parse_xml
from derive.spec.toml.read import parse
from derive.urdf.read import read_robot, robot_of
from derive.urdf.repairs import nearest_tensor, with_locked_joints
from derive.urdf.robot import Robot
from derive.urdf.written_scene import written_scene

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'


def robot(*lines: str) -> Robot:
    """The robot of lines inside of <robot>, of which the first is line 2."""
    return robot_of(parse_xml("\n".join(['<robot name="r">', *lines, "</robot>"]).encode()))


def links(*names: str) -> list[str]:
    return [f'<link name="{name}">{INERTIAL}</link>' for name in names]


def joint(name: str, parent: str, child: str, kind: str = "revolute", inside: str = "") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{inside}</joint>'


def faults(*lines: str) -> list[tuple[int | None, str]]:
    """The faults of a robot, with their lines."""
    with pytest.raises(SpecError) as caught:
        written_scene(robot(*lines))
    return [(problem.line, f"{problem.path}: {problem.message}") for problem in caught.value.problems]


def test_all_faults_are_told_at_once() -> None:
    found = faults(
        *links("a", "b", "b"),
        joint("j", "a", "c"),
        joint("k", "a", "b", "screw"),
        joint("l", "a", "b", "revolute", '<axis xyz="0 0 0"/><origin xyz="1 2"/><mimic joint="none"/>'),
        joint("m", "a", "d", "revolute", '<limit lower="1" upper="-1"/>'),
        '<link name="d"><inertial><mass value="-1"/><inertia ixx="1" iyy="x" izz="nan"/></inertial></link>',
    )
    assert [line for line, _ in found] == sorted(line or 0 for line, _ in found)
    text = "\n".join(f"{line}: {message}" for line, message in found)
    for expected in (
        "4: link b: there is a link of this name in line 3 already",
        '5: joint j: there is no link "c"',
        '6: joint k: the type is one of revolute, continuous, prismatic, fixed, floating, planar, not "screw"',
        "7: joint l.axis: the axis has no direction",
        '7: joint l.origin.xyz: 3 numbers needed, not "1 2"',
        '7: joint l.mimic: there is no joint "none"',
        'link "b" has a parent already, by joint "k" in line 6',
        "8: joint m.limit: lower is above upper",
        "9: link d.mass: the mass is -1 kg; masses are not negative",
        '9: link d.inertia.iyy: a number needed, not "x"',
        '9: link d.inertia.izz: a number needed, not "nan"',
    ):
        assert expected in text


def test_a_cycle_beside_the_tree() -> None:
    ((line, text),) = faults(*links("a", "b", "c"), joint("j", "b", "c"), joint("k", "c", "b"))
    assert line == 3 and 'the links "b" -> "c" -> "b" make a cycle' in text


def test_two_roots() -> None:
    ((line, text),) = faults(*links("a", "b", "c"), joint("j", "a", "b"))
    assert line == 4 and text.startswith('link c: a second root beside link "a"')


def test_a_joint_that_follows_itself() -> None:
    followed = ('<mimic joint="k"/>', '<mimic joint="j"/>')
    found = faults(
        *links("a", "b", "c"), *(joint(n, "a", c, inside=m) for n, c, m in zip("jk", "bc", followed, strict=True))
    )
    assert [text for _, text in found] == [
        "joint j.mimic: the joint follows itself",
        "joint k.mimic: the joint follows itself",
    ]


def test_bodies_without_mass_name_the_joint_that_is_singular() -> None:
    ((line, text),) = faults(*links("a"), '<link name="b"/>', joint("j", "a", "b"))
    assert line == 3 and 'moves, has no mass and carries none, so that joint "j" becomes singular' in text


def test_many_bodies_without_mass_between_joints() -> None:
    """The one at the end of a long row has mass, which all carry; without it each joint is singular."""
    names = [f"l{i}" for i in range(1500)]
    row = [*(f'<link name="{name}"/>' for name in names), *(joint(f"j{b}", a, b) for a, b in pairwise(names))]
    assert len(faults(*row)) == len(names)  # and a line with all of their joints
    end = [*links("end"), joint("j", names[-1], "end")]
    assert written_scene(robot(*row, *end)).text.count("# without mass of its own") == len(names) - 1


def test_bodies_with_a_tensor_and_no_mass() -> None:
    """Also where they carry bodies that have mass, since the tensor would be lost."""
    without = INERTIAL.replace('mass value="1"', 'mass value="0"')
    ((line, text),) = faults(
        *links("a", "c"), f'<link name="b">{without}</link>', joint("j", "a", "b"), joint("k", "b", "c")
    )
    assert line == 4 and "has a tensor of inertia and no mass; give it a mass" in text


def test_elements_of_which_there_is_one() -> None:
    ((line, text),) = faults(*links("a"), f'<link name="b">{INERTIAL}\n{INERTIAL}</link>', joint("j", "a", "b"))
    assert line == 4 and text == ": a second <inertial> in the <link> of line 3; remove one"


def test_a_tiny_axis_has_a_direction() -> None:
    axis = '<axis xyz="0 0 1e-300"/>'
    scene = written_scene(robot(*links("a", "b"), joint("j", "a", "b", inside=axis)))
    assert "joint = [0, 0, 0]" in scene.text  # the axes of the body, of which z is that of the joint


def test_text_in_another_encoding(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    text = "\n".join(["<robot name='r'>", *links("a", "b\u00fc"), joint("j", "a", "b\u00fc"), "</robot>"])
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(SpecError, match=r"3: this is no XML: .* it is not in UTF-8, so save it in that"):
        read_robot(path)
    for head, encoding in (("", "utf-16"), ('<?xml version="1.0" encoding="iso-8859-1"?>\n', "latin-1")):
        path.write_bytes((head + text).encode(encoding))
        assert [*read_robot(path).links] == ["a", "b\u00fc"]


def test_a_tensor_that_no_body_has() -> None:
    flat = INERTIAL.replace('izz="1"', 'izz="9"')
    ((line, text),) = faults(*links("a"), f'<link name="b">{flat}</link>', joint("j", "a", "b"))
    assert line == 3 and "the largest is at most the sum of the other two; correct the <inertia> of this link" in text


TENSORS = {
    "point": np.zeros((3, 3)),
    "flat": np.diag([1.0, 1.0, 9.0]),
    "negative": np.diag([-0.1, 1.0, 1.0]),
    "turned": np.array([[1.0, 0.5, 2.0], [0.5, 2.0, -1.0], [2.0, -1.0, 0.5]]),
}


@pytest.mark.parametrize("tensor", TENSORS.values(), ids=[*TENSORS])
def test_the_nearest_tensor_is_one_of_a_body_and_no_other_is_nearer(tensor: np.ndarray) -> None:
    """Second moments of the mass are at least 1 mm squared times the mass; near the result none of these is closer."""
    mass, rng = 2.0, np.random.default_rng(0)
    nearest = nearest_tensor(tensor, mass)

    def second_moments(inertia: np.ndarray) -> np.ndarray:
        return np.linalg.eigvalsh(np.trace(inertia) / 2 * np.eye(3) - inertia)

    assert second_moments(nearest).min() >= mass * 1e-6 * (1 - 1e-9)
    distance = np.linalg.norm(nearest - tensor)
    assert distance > 0
    for _ in range(300):
        change = rng.normal(size=(3, 3)) * 0.1 * distance
        other = nearest + change + change.T
        if second_moments(other).min() >= mass * 1e-6:
            assert np.linalg.norm(other - tensor) >= distance
    possible = np.diag([1.0, 1.5, 2.0])
    assert np.allclose(nearest_tensor(possible, mass), possible, rtol=1e-12)


def test_a_tensor_is_repaired_on_request_alone() -> None:
    """The note has both tensors, and the scene the new one."""
    flat = INERTIAL.replace('izz="1"', 'izz="9"')
    described = robot(*links("a"), f'<link name="b">{flat}</link>', joint("j", "a", "b"))
    with pytest.raises(SpecError, match="or import it with --repair-inertia"):
        written_scene(described)
    scene = written_scene(described, repair_inertia=True)
    note = "inertia of b repaired: principal moments of 3.333, 3.333, 6.667 kg m^2 instead of 1, 1, 9"
    assert note in scene.notes and f"# {note}" in scene.text
    (body,) = parse(scene.text).bodies
    assert [round(float(x), 6) for x in body.inertia] == [3.333334, 3.333334, 6.666666, 0, 0, 0]


def test_joints_without_mass_can_be_locked() -> None:
    lines = [*links("a", "b"), '<link name="c"/>', '<link name="d"/>']
    lines += [joint("j", "a", "b"), joint("k", "b", "c"), joint("l", "b", "d")]
    assert faults(*lines)[-1][1] == ": to make these joints fixed: --lock k,l"
    scene = written_scene(with_locked_joints(robot(*lines), ["k", "l"]))
    assert [joint.name for joint in parse(scene.text).joints] == ["j"]
    with pytest.raises(SpecError, match='no joint "kk" to lock; did you mean "k"'):
        with_locked_joints(robot(*lines), ["kk"])


def test_an_axis_that_cannot_be_read_has_one_line() -> None:
    ((_, text),) = faults(*links("a", "b"), joint("j", "a", "b", "revolute", '<axis xyz="0 1"/>'))
    assert text == 'joint j.axis.xyz: 3 numbers needed, not "0 1"'


def test_nothing_moves() -> None:
    ((_, text),) = faults(*links("a"))
    assert "import it with --base free" in text


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "this is no XML: no element found"),
        ("<robot", "this is no XML: unclosed token"),
        ("<scene/>", "a URDF is needed, whose outermost element is <robot>, not <scene>"),
        ('<robot name="r"/>', "there is no <link>"),
        ('<?xml version="1.0" encoding="klingon"?><robot/>', "names an encoding that is not read (unknown encoding"),
        ("<robot/>", '<robot> needs name="..."'),
        ('<robot name="r" xmlns:xacro="x"><xacro:macro name="m"/></robot>', "xacro FILE > robot.urdf"),
        ('<robot name="r"><link name="${side}_arm"/></robot>', "xacro FILE > robot.urdf"),
        ('<!DOCTYPE r [<!ENTITY e SYSTEM "/etc/passwd">]><robot name="&e;"/>', "a document type"),
        (f"{'<a>' * 101}{'</a>' * 101}", "nested more than 100 deep"),
    ],
)
def test_what_is_no_description(content: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(content)
    with pytest.raises(SpecError, match=r"robot\.urdf") as caught:
        read_robot(path)
    assert message in str(caught.value)


def test_large_files_are_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(xml_tree, "MAX_BYTES", 10)
    path = tmp_path / "robot.urdf"
    path.write_text("<robot>     </robot>")
    with pytest.raises(SpecError, match="the file has more than"):
        read_robot(path)
