"""The bracket in CalculiX: what the program writes is imported, and the body has its frequencies to all digits."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from programs import program

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.fem.calculix.read import read_calculix
from derive.fem.imported_body import BodyOptions, imported_body
from derive.fem.model import FiniteElementModel
from derive.fem.written_body import SI, FileUnits
from derive.reduction import body_properties
from derive.simulation.observables.mesh_surface import mesh_surface
from derive.spec.model.body import NodalBody
from derive.spec.model.mesh import ElementKind
from markdown_pages import copy_tree, run_page

sys.path.append(str(ROOT / "tests/solids"))
from grid_meshes import box_mesh

pytestmark = pytest.mark.hosts

NAMES = {"tet4": "C3D4", "tet10": "C3D10", "hex8": "C3D8", "hex20": "C3D20", "wedge6": "C3D6", "wedge15": "C3D15"}
SIDES = (0.4, 0.25, 0.1)  # m
MM = FileUnits("mm", "t", "s")
STORE = "*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n*END STEP"


def run_bracket(folder: Path, bricks: tuple[int, int, int], changes: tuple[tuple[str, str], ...] = ()) -> Path:
    """Run CalculiX on the bracket of `scenes/make_bracket.py`, whose input is changed before."""
    path = folder / "bracket.inp"
    subprocess.run([sys.executable, ROOT / "scenes/make_bracket.py", path, *map(str, bricks)], check=True)
    text = path.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    path.write_text(text)
    command = [program("ccx"), "bracket"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert "Job finished" in done.stdout, done.stdout[-2000:]
    return path


def test_the_body_has_the_frequencies_of_the_program(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """An interface does not change those of the full matrices, which the command prints as well."""
    path = run_bracket(tmp_path, (6, 2, 1))
    monkeypatch.chdir(tmp_path)
    assert main(["import", "bracket.inp", "--modes", "12", "--out", "free.toml"]) == 0
    theirs = read_calculix(path).frequencies
    assert theirs is not None
    free = derive.read("free.toml")
    assert isinstance(free, NodalBody)
    own = body_properties(free).frequencies
    assert [f"{value:.6E}" for value in own] == [f"{value:.6E}" for value in theirs[6:18]]
    assert main(["import", "bracket.inp", "--interface", "left,right", "--modes", "12"]) == 0
    assert main(["build", "bracket.toml", "--out", "generated"]) == 0
    out = capsys.readouterr().out
    assert all(f"{value:.5g}" in out for value in theirs[6:12])
    assert out.count("the 8 of the program differ by") == 2


def test_supports_are_refused_with_the_nodes(tmp_path: Path) -> None:
    path = run_bracket(tmp_path, (1, 1, 1), (("*STEP", "*BOUNDARY\n1, 1, 3\n*STEP"),))
    with pytest.raises(derive.SpecError, match=r"bracket\.inp:68: \*BOUNDARY: the part is held at the nodes 1; "):
        read_calculix(path)


def test_nodes_tied_in_all_directions_move_with_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The middle of an edge that follows its ends alike in x, y and z keeps rigid motions and the form of the mass."""
    path = tmp_path / "bracket.inp"
    subprocess.run([sys.executable, ROOT / "scenes/make_bracket.py", path, "1", "1", "1"], check=True)
    edge = "\n".join(f"*EQUATION\n3\n2, {k}, -2, 1, {k}, 1, 3, {k}, 1" for k in (1, 2, 3))
    path = run_bracket(tmp_path, (1, 1, 1), (("*STEP", f"{edge}\n*STEP"),))
    monkeypatch.chdir(tmp_path)
    assert main(["import", "bracket.inp", "--modes", "8"]) == 0
    out = capsys.readouterr().out
    assert "1 node that follows others (*EQUATION in line 68) is left out" in out
    body, theirs = derive.read("bracket.toml"), read_calculix(path).frequencies
    assert isinstance(body, NodalBody) and theirs is not None
    assert np.allclose(body_properties(body).frequencies, theirs[6:14], rtol=1e-6)
    assert float(body.data.mass.sum()) == pytest.approx(2.3864)


def test_a_rigid_body_moves_with_its_reference_node(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Four nodes around the reference node take its place, with the frequencies of the program; joints hold them."""
    rigid = "*NODE\n900, 0.01, 0.02, 0.25\n*RIGID BODY, NSET=left, REF NODE=900\n*STEP"
    path = run_bracket(tmp_path, (1, 1, 1), (("*STEP", rigid),))
    monkeypatch.chdir(tmp_path)
    theirs = read_calculix(path).frequencies
    assert theirs is not None
    assert main(["import", "bracket.inp", "--modes", "8", "--out", "free.toml"]) == 0
    assert "left is rigid: its motion is that of its reference node" in capsys.readouterr().out
    free = derive.read("free.toml")
    assert isinstance(free, NodalBody)
    assert np.allclose(body_properties(free).frequencies[:6], theirs[6:12], rtol=3e-6)
    assert body_properties(free).mass == pytest.approx(2.3864)
    assert main(["import", "bracket.inp", "--interface", "left,right", "--scene", "--out", "held.toml"]) == 0
    scene = derive.read("held.toml")
    assert [float(x) for x in scene.ground[0].position] == pytest.approx([0.01, 0.02, 0.25])  # type: ignore[union-attr]


def test_point_masses_are_in_the_matrices(tmp_path: Path) -> None:
    mass = "*ELEMENT, TYPE=MASS, ELSET=load\n900, 1\n*MASS, ELSET=load\n0.5\n*STEP"
    model = read_calculix(run_bracket(tmp_path, (1, 1, 1), (("*STEP", mass),)))
    assert float(model.mass[::3][:, ::3].sum()) == pytest.approx(2.3864 + 0.5)  # type: ignore[index]
    assert model.notes[0] == "1 line of elements of the type MASS: in the matrices, but not in pictures"


def box_file(folder: Path, element: str, unit: float, young: str, density: str) -> Path:
    """Run CalculiX on a box of 0.4 m, 0.25 m and 0.1 m, in another unit of length (m); its node numbers have gaps."""
    kind = ElementKind(next(kind for kind, name in NAMES.items() if element.startswith(name)))
    x, mesh = box_mesh(kind, tuple(side / unit for side in SIDES), (4, 3, 2))
    lines = ["*NODE", *(f"{7 + 3 * i}, {a:.12g}, {b:.12g}, {c:.12g}" for i, (a, b, c) in enumerate(x))]
    lines.append(f"*ELEMENT, TYPE={element}, ELSET=box")
    for number, nodes in enumerate(mesh.elements[0].nodes, 1):
        texts = [str(number), *(str(7 + 3 * node) for node in nodes)]
        lines += [",".join(texts[:11]) + "," * (len(texts) > 11), *[",".join(texts[11:])][: len(texts) // 12]]
    lines += ["*MATERIAL, NAME=steel", "*ELASTIC", f"{young}, 0.3", "*DENSITY", density]
    lines += ["*SOLID SECTION, ELSET=box, MATERIAL=steel", "*STEP", "*FREQUENCY", "16", "*END STEP"]
    path = folder / "box.inp"
    path.write_text("\n".join([*lines, STORE, ""]))
    subprocess.run([program("ccx"), "box"], cwd=folder, check=True, capture_output=True, timeout=120)
    return path


def box_body(folder: Path, model: FiniteElementModel, units: FileUnits = SI) -> NodalBody:
    """The body of an imported box."""
    imported = imported_body(model, BodyOptions(modes=8, units=units), "box.inp", "box.npz")
    (folder / "box.npz").write_bytes(imported.archive)
    (folder / "box.toml").write_text(imported.text)
    body = derive.read(folder / "box.toml")
    assert isinstance(body, NodalBody)
    return body


@pytest.mark.parametrize("element", [*NAMES.values(), "C3D8R", "C3D20R"])
def test_boxes_of_every_element(element: str, tmp_path: Path) -> None:
    """Frequencies, mass and surface of a box."""
    model = read_calculix(box_file(tmp_path, element, 1.0, "2.1e11", "7800"))
    assert model.node_numbers.tolist() == [7 + 3 * i for i in range(len(model.positions))]
    body = box_body(tmp_path, model)
    assert body.data.mesh is not None and model.frequencies is not None
    if element != "C3D8R":  # with one point of integration the mass is singular, and CalculiX finds other frequencies
        assert np.allclose(body_properties(body).frequencies, model.frequencies[6:14], rtol=1e-6)
    assert float(body.data.mass.sum()) == pytest.approx(7800 * np.prod(SIDES), rel=1e-9)
    at, shown = body.data.positions, mesh_surface(body.data.mesh.elements)
    fans = (at[[face[0], face[i], face[i + 1]]] for face in shown.faces for i in range(1, len(face) - 1))
    assert sum(np.linalg.det(fan) for fan in fans) / 6 == pytest.approx(np.prod(SIDES))


def test_millimetres_and_tonnes_are_the_same_body(tmp_path: Path) -> None:
    """CalculiX loses digits of the frequencies of free bodies with small numbers of mass, but not of the matrices."""
    bodies = []
    for name, units, values in (("m", SI, (1.0, "2.1e11", "7800")), ("mm", MM, (1e-3, "2.1e5", "7.8e-9"))):
        folder = tmp_path / name
        folder.mkdir()
        bodies.append(box_body(folder, read_calculix(box_file(folder, "C3D20", *values)), units))
    first, second = (body_properties(body) for body in bodies)
    assert np.allclose(first.frequencies, second.frequencies, rtol=1e-9)
    assert np.allclose(first.inertia, second.inertia, rtol=1e-9)
    (steel,) = bodies[1].data.mesh.materials.values()  # type: ignore[union-attr]
    assert (steel.young, steel.density) == pytest.approx((2.1e11, 7800.0))


def test_incompatible_modes_are_refused(tmp_path: Path) -> None:
    path = box_file(tmp_path, "C3D8I", 1.0, "2.1e11", "7800")
    with pytest.raises(derive.SpecError, match=r"are not in the mesh: .* incompatible modes \(C3D8I\)"):
        read_calculix(path)


def test_the_commands_of_the_page(tmp_path: Path) -> None:
    program("ccx")
    outputs = run_page(ROOT / "docs/how_to/calculix.md", copy_tree(tmp_path)).values()
    assert any("Craig-Bampton modes of the interface left, right" in text for text in outputs)


def test_the_file_of_the_example_is_that_of_the_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run_bracket(tmp_path, (6, 2, 1))
    monkeypatch.chdir(tmp_path)
    assert main(["import", "bracket.inp", "--interface", "left,right", "--modes", "12"]) == 0
    made, committed = np.load("bracket.npz"), np.load(ROOT / "examples/bracket.npz")
    assert sorted(made.files) == sorted(committed.files)
    for name in made.files:
        size = np.abs(committed[name]).max()
        assert np.allclose(made[name], committed[name], rtol=0, atol=1e-11 * size), name
