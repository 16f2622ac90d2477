"""The shapes of links: which become visuals of bodies, where their meshes are found, and the way back."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

import derive
from derive.cli.main import main
from derive.export.urdf.description import urdf_text
from derive.simulation.observables.spatial_scene_player import drawn_bodies
from derive.simulation.space.marker_frames import own_frame
from derive.spec.files.xml_tree import parse_xml
from derive.spec.model.visuals import Mesh
from derive.urdf.read import robot_of
from derive.urdf.written_scene import written_scene

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
HAND = "package://my_robot/meshes/hand.stl"


def shape(form: str, tag: str = "visual", origin: str = "") -> str:
    return f"<{tag}>{origin}<geometry>{form}</geometry></{tag}>"


def mesh(name: str) -> str:
    return f'<mesh filename="{name}" scale="0.5 0.5 0.5"/>'


def robot(arm: str, tip: str = "", base: str = "") -> str:
    """An arm that carries a tip, which is fixed to it 2 m along its z axis and turned by a right angle about x."""
    return f"""<robot name="r"><link name="base">{base}</link><link name="arm">{INERTIAL}{arm}</link>
      <link name="tip">{tip}</link>
      <joint name="a" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
        <origin xyz="0 0 1" rpy="0.3 0 0"/></joint>
      <joint name="b" type="fixed"><parent link="arm"/><child link="tip"/>
        <origin xyz="0 0 2" rpy="1.5707963267948966 0 0"/></joint></robot>"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The folder of a URDF in a package with a mesh of one triangle, and a file that is none."""
    for name in ("urdf", "meshes"):
        (tmp_path / "my_robot" / name).mkdir(parents=True)
    triangle = struct.pack("<12fH", 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0)
    (tmp_path / "my_robot/meshes/hand.stl").write_bytes(bytes(80) + struct.pack("<I", 1) + triangle)
    (tmp_path / "my_robot/meshes/cut.stl").write_bytes(bytes(80) + struct.pack("<I", 2) + triangle)
    return tmp_path / "my_robot" / "urdf"


def test_shapes_become_visuals_of_the_body_of_their_link(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Meshes by package and by path, from another folder; those of links fixed to others, and those of the ground."""
    origin = '<origin xyz="0 0 1"/>'
    arm = shape(mesh(HAND)) + shape(mesh("../meshes/hand.stl")) + shape('<cylinder radius="0.1" length="2"/>')
    (folder / "r.urdf").write_text(
        robot(arm, shape('<sphere radius="0.2"/>', origin=origin), shape('<box size="1 1 4"/>'))
    )
    target = tmp_path / "other" / "r.toml"
    assert main(["import", str(folder / "r.urdf"), "--out", str(target)]) == 0
    assert "not shown" not in capsys.readouterr().out
    text = target.read_text()
    assert text.count('mesh = "../my_robot/meshes/hand.stl", scale = [0.5, 0.5, 0.5]') == 2
    (body,) = derive.read(target).bodies  # type: ignore[union-attr]
    assert isinstance(body, derive.SpatialRigidBody) and isinstance(body.visuals[0].mesh, Mesh)
    assert body.visuals[2].cylinder == (0.1, 2.0) and body.visuals[3].sphere == 0.2
    np.testing.assert_allclose(body.visuals[3].at, (0, -1, 2), atol=1e-15)
    drawn, ground = drawn_bodies(derive.read(target))  # type: ignore[arg-type]
    assert ground.name == "ground" and ground.x[:, 2].max() == 2
    np.testing.assert_allclose(drawn.x[:3].max(axis=0), (1, 1, 0))


def test_shapes_that_cannot_be_shown_have_a_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Shapes for contact stand for them where a link has no other; a body without any is the box of its inertia."""
    forms = [mesh("hand.ply"), mesh("package://my_robot/none.stl"), mesh("../meshes/cut.stl"), "<capsule/>"]
    others = ['<box size="1 0 1"/>', f'<mesh filename="{HAND}" scale="1 1"/>', mesh(""), ""]
    arm = "".join(map(shape, (*forms, *others)))
    for contact, count in ((shape('<box size="1 2 3"/>', "collision"), 1), ("", 0)):
        (folder / "r.urdf").write_text(robot(arm + contact))
        target = folder / f"{count}.toml"
        assert main(["import", str(folder / "r.urdf"), "--out", str(target)]) == 0
        said = capsys.readouterr().out
        for line in (
            "not shown: 2 shapes, which are no .stl or .obj or .dae files, such as hand.ply",
            "not shown: 1 shape, whose files are not there, such as package://my_robot/none.stl",
            "not shown: 1 shape, whose files cannot be read as meshes, such as ../meshes/cut.stl",
            "not shown: 1 shape, <capsule>, such as arm",
            "not shown: 1 shape, <box> without positive sizes, such as arm",
            f"not shown: 1 shape, whose scale is not three numbers, such as {HAND}",
            "not shown: 1 shape, without a geometry, such as arm",
        ):
            assert line in said
        assert ("shown by its shapes for contact: arm" in said) == bool(contact)
        (body,) = derive.read(target).bodies  # type: ignore[union-attr]
        assert [visual.box for visual in body.visuals] == [(1, 2, 3)] * count  # type: ignore[union-attr]


def test_exported_shapes_are_imported_again(folder: Path) -> None:
    """The description of the scene has the same shapes at the same places, in the frame of its own link."""
    arm = shape('<box size="1 2 3"/>', origin='<origin xyz="1 0 0" rpy="0.1 0.2 0.3"/>') + shape(mesh(HAND))
    text = robot(arm, shape('<sphere radius="0.2"/>'))
    first = written_scene(robot_of(parse_xml(text.encode())), "fixed", str(folder / "r.urdf"), folder).text
    (folder / "r.toml").write_text(first)
    again = urdf_text(derive.read(folder / "r.toml"))
    (folder / "again.toml").write_text(
        written_scene(robot_of(parse_xml(again.encode())), "fixed", str(folder / "x.urdf"), folder).text
    )
    scenes = [derive.read(folder / name) for name in ("r.toml", "again.toml")]
    one, two = (drawn_bodies(scene)[0] for scene in scenes)  # type: ignore[arg-type]
    assert one.surface == two.surface and len(one.surface.faces) > 100
    frame = own_frame(scenes[0].bodies[0].markers[0])  # type: ignore[union-attr, arg-type]
    count = 1 + max(i for face in one.surface.faces for i in face)
    np.testing.assert_allclose((one.x[:count] - frame.position) @ frame.axes, two.x[:count], atol=1e-12)
