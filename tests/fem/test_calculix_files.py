"""Files of CalculiX: the bracket that the program itself wrote, and what its formats allow besides."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

import derive
from derive.errors import SpecError
from derive.fem.calculix.read import read_calculix
from derive.fem.imported_body import BodyOptions, imported_body
from derive.fem.keyword_mesh import KINDS, read_mesh
from derive.fem.model import FiniteElementModel
from derive.solids.element_shapes import element_shape
from derive.solids.face_areas import face_tables
from derive.spec.model.mesh import ElementKind, Elements
from fem.part_files import bracket_files, text_of


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> FiniteElementModel:
    """The bracket as it is read."""
    return read_calculix(bracket_files(tmp_path_factory.mktemp("bracket")))


def test_frequencies_of_the_matrices_are_those_of_the_program_to_its_digits(model: FiniteElementModel) -> None:
    squares = eigh(model.stiffness.toarray(), model.mass.toarray(), eigvals_only=True)  # type: ignore[union-attr]
    own = np.sqrt(squares[6:20]) / (2 * np.pi)
    assert [f"{value:.6E}" for value in own] == [f"{value:.6E}" for value in model.frequencies[6:]]  # type: ignore[index]
    assert squares[5] < 1e-9 * squares[6]


def test_the_modes_are_those_of_the_matrices(model: FiniteElementModel) -> None:
    assert model.modes is not None and model.mass is not None and model.stiffness is not None
    modes = model.modes[6:].reshape(14, -1)
    assert np.allclose(modes @ model.mass @ modes.T, np.eye(14), atol=1e-4)  # six digits are written
    assert model.frequencies is not None
    values = np.diag(modes @ model.stiffness @ modes.T)
    assert np.allclose(values, (2 * np.pi * model.frequencies[6:]) ** 2, rtol=1e-4)


def test_the_mass_is_that_of_the_volume(model: FiniteElementModel) -> None:
    assert model.mass is not None
    along = np.tile([1.0, 0, 0], 44)
    assert along @ model.mass @ along == pytest.approx(7850 * 0.04 * (0.2 * 0.02 + 0.18 * 0.02), rel=1e-12)


def test_nodes_sets_and_materials(model: FiniteElementModel) -> None:
    assert model.node_numbers.tolist() == list(range(1, 45))
    assert {name: len(nodes) for name, nodes in model.node_sets.items()} == {"all": 44, "right": 8, "left": 8}
    assert (model.positions[model.node_sets["right"], 0] == 0.2).all()
    (steel,) = model.materials.values()
    assert (steel.young, steel.poisson, steel.density) == (210e9, 0.3, 7850.0)
    assert model.notes == ()


def test_middles_of_edges_are_at_the_edges_that_vtk_has_there(model: FiniteElementModel) -> None:
    (bricks,) = model.elements
    assert bricks.kind is ElementKind.HEX20
    edges = element_shape(ElementKind.HEX20).edges
    for i, (first, second) in enumerate(edges):
        at = model.positions[bricks.nodes]
        assert np.allclose(at[:, 8 + i], (at[:, first] + at[:, second]) / 2)


def test_the_order_of_dof_is_that_of_the_matrices(tmp_path: Path) -> None:
    """The rows may come in any order, of which .dof is the key."""
    order = np.random.default_rng(31).permutation(132)
    place = np.argsort(order) + 1
    dof = text_of("dof").splitlines()
    changed = {"dof": "\n".join(dof[i] for i in order)}
    for suffix in ("sti", "mas"):
        parts = [line.split() for line in text_of(suffix).splitlines()]
        changed[suffix] = "\n".join(f"{place[int(i) - 1]} {place[int(j) - 1]} {value}" for i, j, value in parts)
    shuffled = read_calculix(bracket_files(tmp_path, **changed))
    (tmp_path / "as_written").mkdir()
    expected = read_calculix(bracket_files(tmp_path / "as_written"))
    assert abs(shuffled.stiffness - expected.stiffness).max() == 0  # type: ignore[operator]
    assert abs(shuffled.mass - expected.mass).max() == 0  # type: ignore[operator]


def test_includes_generated_sets_and_continued_lines(tmp_path: Path) -> None:
    (tmp_path / "mesh.inp").write_text(
        "** a comment\n*Node\n1, 0, 0, 0\n2, 1.\n3,0,1.D0,0\n4,0,0,1\n5, 1, 1, 1\n*ELEMENT, TYPE=C3D4,\nELSET=All\n"
        "7, 1, 2, 3, 4\n8, 5, 2,\n3, 4\n*NSET, NSET=Some, GENERATE\n1, 5, 2\n*NSET, NSET=more\nsome, 2\n"
    )
    (tmp_path / "part.inp").write_text(
        "*INCLUDE, INPUT=mesh.inp\n*MATERIAL, NAME=A\n*ELASTIC\n1e9, 0.25\n*SOLID SECTION, ELSET=all, MATERIAL=a\n"
        "*ELEMENT, TYPE=SPRINGA, ELSET=s\n9, 1, 2\n*CLOAD\n1, 1, 5\n"
    )
    mesh = read_mesh(tmp_path / "part.inp")
    assert mesh.positions.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]
    (block,) = mesh.elements
    assert block.nodes.tolist() == [[1, 2, 3, 4], [5, 2, 3, 4]]
    assert (block.material, mesh.materials["A"].young, mesh.materials["A"].density) == ("A", 1e9, None)
    assert {name: nodes.tolist() for name, nodes in mesh.sets.items()} == {"SOME": [1, 3, 5], "MORE": [1, 2, 3, 5]}
    assert mesh.names["SOME"] == "Some"
    assert (mesh.other_elements, mesh.cards) == ({"SPRINGA": 1}, {"CLOAD": (8, 1)})


def test_nodes_of_no_element_are_left_out(tmp_path: Path) -> None:
    text = text_of("inp").replace("*ELEMENT", "500, 1, 2, 3\n*ELEMENT", 1)
    model = read_calculix(bracket_files(tmp_path, inp=text))
    assert len(model.positions) == 44
    assert model.notes == ("1 node of no element is left out: 500",)


@pytest.mark.parametrize(
    ("lines", "name"),
    [
        ("*SURFACE, NAME=Load Face\n2, S4\n", "Load Face"),
        ("*SURFACE, NAME=Load Face, TYPE=NODE\nright\n", "Load Face"),
    ],
)
def test_surfaces_are_sets_of_nodes(lines: str, name: str, tmp_path: Path) -> None:
    """The end of the leg along x is a face of its last element, whose nodes are also the set `right`."""
    model = read_calculix(bracket_files(tmp_path, inp=text_of("inp").replace("*STEP", f"{lines}*STEP", 1)))
    assert np.array_equal(model.node_sets[name], model.node_sets["right"])


def test_faces_of_every_solid_are_those_of_its_shape(tmp_path: Path) -> None:
    """S1, S2, ... of CalculiX have the same corners as the faces of VTK, in another order."""
    for kind, count in (("C3D4", 4), ("C3D10", 4), ("C3D6", 5), ("C3D15", 5), ("C3D8", 6), ("C3D20", 6)):
        nodes = KINDS[kind].node_count
        text = "*NODE\n" + "".join(f"{i}, {i}, 0, 0\n" for i in range(1, nodes + 1))
        text += f"*ELEMENT, TYPE={kind}, ELSET=e\n1, {', '.join(map(str, range(1, nodes + 1)))}\n"
        text += "".join(f"*SURFACE, NAME=s{k}\ne, S{k}\n" for k in range(1, count + 1))
        (tmp_path / "part.inp").write_text(text)
        found = {frozenset(read_mesh(tmp_path / "part.inp").sets[f"S{k}"].tolist()) for k in range(1, count + 1)}
        expected = {frozenset(node + 1 for node in face.nodes) for face in face_tables(KINDS[kind])}
        assert found == expected, kind


def test_elements_of_two_materials(tmp_path: Path) -> None:
    text = text_of("inp").replace(
        "*STEP", "*ELSET, ELSET=back\n3\n*SOLID SECTION, ELSET=back, MATERIAL=light\n*STEP", 1
    )
    text = text.replace("*MATERIAL", "*MATERIAL, NAME=light\n*ELASTIC\n7e10, 0.3\n*DENSITY\n2700\n*MATERIAL", 1)
    model = read_calculix(bracket_files(tmp_path, inp=text))
    assert [(len(block.nodes), block.material) for block in model.elements] == [(2, "STEEL"), (1, "LIGHT")]
    body = imported_body(model, BodyOptions(), "bracket.inp", "nodes.npz")
    (tmp_path / "nodes.npz").write_bytes(body.archive)
    (tmp_path / "body.toml").write_text(body.text)
    mesh = derive.read(tmp_path / "body.toml").data.mesh  # type: ignore[union-attr]
    assert mesh is not None
    young = {len(block.nodes): mesh.materials[block.material].young for block in mesh.elements}
    assert young == {2: 210e9, 1: 70e9}


@pytest.mark.parametrize("kind", ["C3D8R", "C3D10MT", "C3D6", "c3d20r"])
def test_letters_behind_a_type_choose_the_integration(kind: str, tmp_path: Path) -> None:
    count = {"C3D8R": 8, "C3D10MT": 10, "C3D6": 6, "c3d20r": 20}[kind]
    nodes = "\n".join(f"{i}, {i}, 0, 0" for i in range(1, count + 1))
    listed = ", ".join(map(str, range(1, count + 1)))
    (tmp_path / "part.inp").write_text(f"*NODE\n{nodes}\n*ELEMENT, TYPE={kind}\n1, {listed}\n")
    (block,) = read_mesh(tmp_path / "part.inp").elements
    assert isinstance(block, Elements) and block.nodes.shape == (1, count)


def test_a_file_that_is_missing_says_what_to_do(tmp_path: Path) -> None:
    path = bracket_files(tmp_path)
    (tmp_path / "bracket.sti").unlink()
    with pytest.raises(SpecError, match=r"bracket\.sti is missing beside it; add three lines") as caught:
        read_calculix(path)
    assert "*FREQUENCY, SOLVER=MATRIXSTORAGE" in str(caught.value)
