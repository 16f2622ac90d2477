"""`tisserand import` of the bracket: the body builds with the frequencies of CalculiX, and the scene runs."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh, null_space

import derive
from derive.cli.main import main
from derive.fem.calculix.read import read_calculix
from derive.reduction import body_properties
from derive.reduction.body import prepare
from derive.simulation.observables.spatial_player_data import drawn_body
from derive.spec.model.body import DisplacementOrder, NodalBody
from derive.spec.model.spatial_scene import SpatialScene
from explicit_motion import moved
from fem.part_files import bracket_files, text_of

EIGHT_NODES = (
    (6, 2, 3, 2, -6, -8, -8, -6),
    (2, 6, 2, 3, -6, -6, -8, -8),
    (3, 2, 6, 2, -8, -6, -6, -8),
    (2, 3, 2, 6, -8, -8, -6, -6),
    (-6, -6, -8, -8, 32, 20, 16, 20),
    (-8, -6, -6, -8, 20, 32, 20, 16),
    (-8, -8, -6, -6, 16, 20, 32, 20),
    (-6, -8, -8, -6, 20, 16, 20, 32),
)
"""The integrals of products of the shape functions of a rectangle with eight nodes, times 180 and over its area."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the files of the bracket, which is the current one."""
    bracket_files(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def imported(*options: str) -> NodalBody | SpatialScene:
    """The specification that the command writes for the bracket."""
    assert main(["import", "bracket.inp", *options]) == 0
    return derive.read("bracket.toml")  # type: ignore[return-value]


def test_frequencies_of_the_body_are_those_of_the_program(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    body = imported("--modes", "14")
    assert isinstance(body, NodalBody)
    theirs = read_calculix(folder / "bracket.inp").frequencies
    assert theirs is not None
    own = body_properties(body).frequencies
    assert [f"{value:.6E}" for value in own] == [f"{value:.6E}" for value in theirs[6:]]
    assert "the 8 of the program differ by" in capsys.readouterr().out


def test_the_body_of_an_interface_builds(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    body = imported("--interface", "left,right", "--modes", "12")
    assert isinstance(body, NodalBody)
    assert (body.interface, body.component_modes, body.modes) == (("left", "right"), "craig_bampton", 12)
    assert [len(marker.nodes) for marker in body.interface_markers] == [8, 8]
    mesh = body.data.mesh
    assert mesh is not None
    assert [block.nodes.shape for block in mesh.elements] == [(3, 20)]
    assert mesh.node_numbers is not None and mesh.node_numbers.tolist() == list(range(1, 45))
    assert main(["build", "bracket.toml", "--out", "generated"]) == 0
    out = capsys.readouterr().out
    assert "Craig-Bampton modes of the interface left, right (6 static, 6 vibration" in out
    assert "704.61" in out


def test_modes_by_default_are_six_besides_the_static_ones(folder: Path) -> None:
    assert imported("--interface", "left", "--out", "bracket.toml").modes == 6  # type: ignore[union-attr]
    (folder / "bracket.toml").unlink()
    (folder / "bracket.npz").unlink()
    body = imported("--interface", "left,right", "--component-modes", "attachment")
    assert (body.modes, body.component_modes) == (18, "attachment")  # type: ignore[union-attr]


def test_an_error_chooses_the_modes(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    body = imported("--interface", "left,right", "--error", "0.05", "--up-to", "3000")
    assert isinstance(body, NodalBody)
    assert body.modes == derive.ModeSelection(error=0.05, up_to=3000.0)
    count = len(prepare(body).shapes.phi)
    expected = f"with {count} modes, whose error is 0.05 or less up to 3000 Hz, of the interface left, right"
    assert expected in capsys.readouterr().out


@pytest.mark.long
def test_the_scene_holds_the_body_at_the_first_set(folder: Path) -> None:
    """Its first frequency is that of the full matrices with no mean motion over the area of the set, a rectangle."""
    scene = imported("--interface", "left,right", "--scene")
    assert isinstance(scene, SpatialScene)
    model = read_calculix(folder / "bracket.inp")
    nodes = model.node_sets["left"]
    levers = model.positions[nodes] - model.positions[nodes].mean(axis=0)
    middle = np.abs(levers[:, 0] * levers[:, 1]) < 1e-9
    angles = np.where(middle, 1e3, 0) + np.arctan2(levers[:, 1], levers[:, 0])
    around = np.argsort(angles)  # four corners in a row, and then the nodes behind each of them
    weighted = np.zeros_like(levers)
    weighted[around] = np.array(EIGHT_NODES) @ levers[around]
    shares = np.zeros(8)
    shares[around] = np.array(EIGHT_NODES).sum(axis=0)
    rows = np.zeros((6, len(model.positions), 3))
    for axis, unit in enumerate(np.eye(3)):
        rows[axis, nodes] = shares[:, None] * unit
        rows[3 + axis, nodes] = np.cross(unit, weighted)  # the integral of levers x displacements vanishes
    free = null_space(rows.reshape(6, -1))
    stiffness, mass = (free.T @ matrix @ free for matrix in (model.stiffness, model.mass))
    full = np.sqrt(eigh(stiffness, mass, eigvals_only=True)[:2]) / (2 * np.pi)
    assert derive.modes(scene).frequencies[:2] == pytest.approx(full, rel=1e-4)
    run = moved(scene, duration=1e-3)
    assert [run[f"right_{axis}"][0] for axis in (1, 2, 3)] == pytest.approx([0, 0, 0], abs=1e-12)
    assert run["right_3"][-1] < -1e-7
    assert [output.name for output in scene.outputs] == [plot.name for plot in scene.plots] == ["right"]


def test_a_body_alone_vibrates_in_its_first_mode(folder: Path) -> None:
    """A specification that was just imported is simulated: five periods of the first mode, which begin at its top."""
    body = imported("--interface", "left,right", "--modes", "12")
    assert isinstance(body, NodalBody)
    run = moved(body)
    first = body_properties(body).frequencies[0]
    assert run.t[-1] * first == pytest.approx(5, rel=0.01)
    assert run["alpha1"] == pytest.approx(run["alpha1"][0] * np.cos(2 * np.pi * first * run.t), abs=1e-6)
    shape = np.linalg.norm(prepare(body).shapes.phi[0], axis=1).max()
    assert run["alpha1"][0] * shape == pytest.approx(0.01 * np.ptp(body.data.positions[:, 0]), rel=0.01)


def test_pictures_show_the_surface_of_the_elements(folder: Path) -> None:
    """Three bricks in an L have 14 faces, with the middles of edges; a hull of the nodes has others."""
    body = imported()
    assert isinstance(body, NodalBody)
    shown = drawn_body(body)
    assert sorted(len(face) for face in shown.surface.faces) == [8] * 14
    assert len(shown.x) == 44 and len(shown.surface.edges) == 2 * 28


def test_a_scene_with_sets_of_single_nodes_and_names_that_scenes_do_not_have(folder: Path) -> None:
    more = "*NSET, NSET=end face\n4, 5, 8, 12, 13\n*NSET, NSET=tip\n44\n*STEP"
    bracket_files(folder, inp=text_of("inp").replace("*STEP", more, 1))
    scene = imported("--interface", "end face,TIP", "--scene")
    assert isinstance(scene, SpatialScene)
    first, second = scene.bodies[0].markers
    assert (len(first.nodes), second.name, second.nodes) == (5, "tip", (43,))
    assert scene.joints[0].second.marker == first.name == "end_face"


def test_units_of_the_file(folder: Path) -> None:
    body = imported("--units", "mm,kg,s")
    assert isinstance(body, NodalBody)
    assert float(np.ptp(body.data.positions[:, 0])) == pytest.approx(0.2e-3)
    (folder / "bracket.toml").unlink()
    (folder / "bracket.npz").unlink()
    scene = imported("--units", "mm,kg,s", "--interface", "left,right", "--scene")
    assert scene.bodies[0].body.data.mesh.materials["0"].young == pytest.approx(210e9 * 1e3)  # type: ignore


def test_notes_as_json(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    imported("--interface", "left,right", "--json")
    written = json.loads(capsys.readouterr().out)
    assert (written["name"], written["files"]) == ("bracket", ["bracket.npz", "bracket.toml"])
    assert written["notes"][0].startswith("44 nodes, 3 hex20; mass 2.3864 kg; stiffness of 132 displacements")


def test_the_same_files_give_the_same_bytes(folder: Path) -> None:
    imported()
    first = (folder / "bracket.npz").read_bytes()
    (folder / "bracket.toml").unlink()
    (folder / "bracket.npz").unlink()
    imported()
    assert (folder / "bracket.npz").read_bytes() == first


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--interface", "lef,rght"], 'bracket.inp: --interface: there is no set of nodes "lef"; did you mean "left"?'),
        (["--base", "fixed"], '--base: this is for a robot, which "bracket.inp" is not'),
        (["--units", "mm,t"], '--units: length, mass and time are needed, such as mm,t,s, not "mm,t"'),
        (["--units", "mm,ton,s"], '--units: there is no unit "ton"'),
        (["--scene"], "bracket.inp: --scene: a scene holds the body at a set of nodes: name it with --interface"),
        (["--interface", "left,right", "--modes", "5"], "bracket.inp: body.modes: 5 modes are too few for this"),
        (["--modes", "9", "--error", "0.1", "--up-to", "9"], "--modes: the error chooses the number of modes"),
        (["--error", "0.1"], "--error: an error needs the frequencies that it is for: --error 0.01 --up-to 500, in Hz"),
        (["--error", "0.1", "--up-to", "x"], "bracket.inp: body.modes.up_to: "),
        (["--modes", "127"], "bracket.inp: body.modes: 127 modes are too many"),
    ],
)  # fmt: skip
def test_wrong_options(folder: Path, options: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["import", "bracket.inp", *options]) == 2
    assert message in capsys.readouterr().err
    assert not (folder / "bracket.toml").exists() and not (folder / "bracket.npz").exists()


def test_options_of_parts_are_refused_for_robots(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "r.urdf").write_text('<robot name="r"><link name="a"/></robot>')
    assert main(["import", "r.urdf", "--interface", "a", "--modes", "3"]) == 2
    assert capsys.readouterr().err.count('this is for a part, which "r.urdf" is not') == 2


def test_files_that_exist_are_left_alone(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "bracket.npz").write_text("mine")
    assert main(["import", "bracket.inp"]) == 2
    assert "bracket.npz: this file exists and is left alone" in capsys.readouterr().err
    assert (folder / "bracket.npz").read_text() == "mine"


def test_a_part_of_second_order(folder: Path) -> None:
    """Its geometric stiffness comes from the elements, whose largest stress simulations record."""
    body = imported("--modes", "3", "--second-order")
    assert isinstance(body, NodalBody)
    assert body.computes_geometric_stiffness and body.stress
    one = derive.modal(replace(body, order=DisplacementOrder.FIRST_ORDER))
    assert np.trace((derive.modal(body).C5 - one.C5)[..., 0, 0]) < 0  # spin stiffens it


def test_a_file_of_another_kind_names_those_that_are_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A mesh of another program is no robot either."""
    (tmp_path / "part.msh").write_text("part")
    assert main(["import", str(tmp_path / "part.msh")]) == 2
    assert 'files of the kind ".msh" are not read; those that are end in .urdf, .inp, ' in capsys.readouterr().err
