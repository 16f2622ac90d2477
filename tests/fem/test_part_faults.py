"""Faults of parts of finite-element programs: each has a line that says where, what, and what to do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import block_diag, csr_array, identity, kron

from derive.errors import SpecError
from derive.fem.calculix.read import read_calculix
from derive.fem.imported_body import BodyOptions, imported_body
from derive.fem.model import FiniteElementModel
from derive.fem.written_body import FileUnits
from derive.spec.model.mesh import Elements
from fem.part_files import bracket_files, text_of


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> FiniteElementModel:
    """The bracket as it is read."""
    return read_calculix(bracket_files(tmp_path_factory.mktemp("bracket")))


def lines_of_faults(act: Callable[[], object]) -> str:
    """The text of the error that an action raises."""
    with pytest.raises(SpecError) as caught:
        act()
    return str(caught.value)


def faults_of(folder: Path, **changed: str) -> str:
    """The faults of the files of the bracket after changes, without the folder."""
    return lines_of_faults(lambda: read_calculix(bracket_files(folder, **changed))).replace(f"{folder}/", "")


def without_rows(count: int) -> dict[str, str]:
    """The files of the bracket without the first displacements."""
    changed = {"dof": "\n".join(text_of("dof").splitlines()[count:])}
    for suffix in ("sti", "mas"):
        parts = [line.split() for line in text_of(suffix).splitlines()]
        left = [(int(i) - count, int(j) - count, value) for i, j, value in parts if min(int(i), int(j)) > count]
        changed[suffix] = "\n".join(f"{i} {j} {value}" for i, j, value in left)
    return changed


SUPPORT = text_of("inp").replace("*STEP", "*BOUNDARY\n1, 1, 3\n*STEP", 1)
EQUATION = text_of("inp").replace("*STEP", "*EQUATION\n2\n1, 1, 1, 2, 1, -1\n*STEP", 1)
RIGID = text_of("inp").replace("*STEP", "*RIGID BODY, NSET=left, REF NODE=1\n*STEP", 1)


SHELL = text_of("inp").replace("*STEP", "*ELEMENT, TYPE=S8R\n9, 1, 2, 3, 4, 5, 6, 7, 8\n*STEP", 1)
FACE = text_of("inp").replace("*STEP", "*SURFACE, NAME=face\n2, S4\n*STEP", 1)
COUPLING = text_of("inp").replace("*STEP", "*NSET, NSET=s\n*COUPLING, REF NODE=1, SURFACE=s\n*STEP", 1)


OTHER_RUN = "and bracket.dof has 132 lines: these files are not of one run; run ccx again"
OTHER_TYPE = text_of("inp").replace("C3D20", "C3D15")
LACKING = "*NODE\n1,0,0,0\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n"
WRONG_SET = "*NODE, NSET=all\n1,0,0,0\n*NSET, NSET=b\nalle\n"


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"sti": f"{text_of('sti')}133 133 5\n"}, f": bracket.sti: the matrix has 133 rows, {OTHER_RUN}"),
        ({"mas": "1 1 5\n1 2 0\n2 2 4\n"}, f": bracket.mas: the matrix has 2 rows, {OTHER_RUN}"),
        ({"sti": "1 1 3\n1 two 5\n"}, ": bracket.sti: line 2 does not hold 3 numbers"),
        ({"sti": "1 1\n"}, ": bracket.sti: line 1 does not hold 3 numbers"),
        ({"mas": ""}, ": bracket.mas: the file is empty; the program has not finished, or stopped with an error"),
        ({"mas": "1 1 5\n1 2 0 3\n"}, ": bracket.mas: line 2 does not hold 3 numbers"),
        ({"mas": "1 1 5\n1 2 1e999\n"}, ": bracket.mas: line 2 holds a number that is NaN or infinite"),
        ({"mas": f"1 0 0\n{text_of('mas')}"}, ": bracket.mas: line 1 is an entry in row 1 and column 0"),
        ({"dof": text_of("dof").replace("1.2", "1.4", 1)}, ": bracket.dof: line 2 is no displacement of a node"),
        ({"dof": text_of("dof").replace("1.2", "1.1", 1)}, ": bracket.dof: a displacement is there twice"),
        ({"dof": text_of("dof").replace("44.", "99.")}, ": the nodes 99 of the matrices are not in the mesh"),
        (without_rows(3), ": displacements of the nodes 1 are missing in bracket.dof; run ccx again"),
        (
            {**without_rows(3), "inp": SUPPORT},
            ":68: *BOUNDARY: the part is held at the nodes 1; a body is stored without supports: leave them",
        ),
        (
            {**without_rows(1), "inp": EQUATION},
            ": displacements of the nodes 1 are missing in some directions (*EQUATION in line 68); tie nodes in all",
        ),
        ({"inp": RIGID}, ":68: *RIGID BODY: the matrices do not hold three displacements and three rotations of its"),
        (
            {"inp": RIGID.replace("NSET", "ELSET")},
            ":68: *RIGID BODY: a rigid body is read of a set of nodes with a reference node",
        ),
        (
            {"inp": SHELL},
            ": *ELEMENT: elements of the type S8R have rotations, and nodes of a body do not: mesh the part with solid",
        ),
        (
            {"dof": text_of("dof").replace("44.", "99."), "inp": COUPLING},
            ":69: *COUPLING: its reference node has rotations, and nodes of a body do not; leave it out",
        ),
        ({"inp": FACE.replace("S4", "4X")}, ":68: *SURFACE: a line is an element or a set of elements, and one of its"),
        ({"inp": FACE.replace("S4", "S9")}, ":68: *SURFACE: no element of the surface has the face that is given"),
        ({"inp": "*HEADING\n"}, ": there are no nodes: *NODE is missing"),
        ({"inp": "*NODE\n1, 2, x, 4\n"}, ':1: *NODE: a number is needed in "1, 2, x, 4", not "x"'),
        ({"inp": "*NODE\n1.5, 2, 3, 4\n"}, ":1: *NODE: the numbers of nodes and elements are whole and positive"),
        ({"inp": OTHER_TYPE}, ":48: *ELEMENT: an element of the type C3D15 is its number and the numbers of its 15"),
        ({"inp": LACKING}, ": *ELEMENT: element 1 has the node 2, which *NODE does not give"),
        ({"inp": WRONG_SET}, ':3: *NSET: there is no set "alle" before this line; did you mean "all"?'),
        ({"inp": "*INCLUDE, INPUT=none.inp\n"}, ':1: *INCLUDE: the file "none.inp" cannot be read: no such file'),
    ],
)
def test_faults_of_files(tmp_path: Path, changed: dict[str, str], message: str) -> None:
    assert f"bracket.inp{message}" in faults_of(tmp_path, **changed)


def test_several_faults_of_a_file_come_at_once(tmp_path: Path) -> None:
    text = "*NODE\n1, 2, x, 4\n*NODE\n1.5, 0, 0, 0\n*NSET\n1\n"
    assert len(faults_of(tmp_path, inp=text).splitlines()) == 3


def test_ties_in_all_directions_leave_nodes_out(tmp_path: Path) -> None:
    """Whether the rest moves as a rigid body then is checked as for any body."""
    text = EQUATION.replace("2, 1, -1\n", "2, 1, -1\n2\n1, 2, 1, 2, 2, -1\n2\n1, 3, 1, 2, 3, -1\n")
    model = read_calculix(bracket_files(tmp_path, **{**without_rows(3), "inp": text}))
    assert (len(model.positions), len(model.elements[0].nodes)) == (43, 2)
    assert "1 node that follows others (*EQUATION in line 68) is left out" in model.notes[0]


def test_a_body_that_is_held_is_refused(tmp_path: Path, model: FiniteElementModel) -> None:
    """A stiffness of nodes whose rows were removed resists rigid motions."""
    held = replace(
        model, node_numbers=model.node_numbers[1:], positions=model.positions[1:], node_sets={}, elements=(),
        stiffness=model.stiffness[3:, 3:], mass=model.mass[3:, 3:],  # type: ignore[index]
    )  # fmt: skip
    text = lines_of_faults(lambda: imported_body(held, BodyOptions(), "bracket.inp", ""))
    assert "the stiffness resists rigid motion" in text and "the body is tied to the ground, or equations" in text


def test_a_set_that_does_not_exist_has_names_like_it(model: FiniteElementModel) -> None:
    options = BodyOptions(interface=("Left", "rigth", "nowhere"))
    assert lines_of_faults(lambda: imported_body(model, options, "bracket.inp", "")).splitlines() == [
        'bracket.inp: --interface: there is no set of nodes "rigth"; did you mean "right"?',
        'bracket.inp: --interface: there is no set of nodes "nowhere"; the sets are all, right, left',
    ]
    text = lines_of_faults(lambda: imported_body(model, BodyOptions(scene=True), "bracket.inp", ""))
    assert text == "bracket.inp: --scene: a scene holds the body at a set of nodes: name it with --interface"


def test_two_nodes_are_no_interface(model: FiniteElementModel) -> None:
    sets = replace(model, node_sets={"edge": np.array([3, 4])})
    text = lines_of_faults(lambda: imported_body(sets, BodyOptions(("edge",)), "bracket.inp", ""))
    assert text.startswith("bracket.inp: --interface: the set edge has two nodes, which do not determine a rotation")


def test_an_indefinite_mass_names_the_node(model: FiniteElementModel) -> None:
    mass = model.mass.tolil()  # type: ignore[union-attr]
    for row in (30, 31, 32):
        mass[row, row] *= 1e-3
    indefinite = replace(model, mass=csr_array(mass))
    text = lines_of_faults(lambda: imported_body(indefinite, BodyOptions(), "bracket.inp", ""))
    assert "bracket.inp: the mass matrix is indefinite" in text and "(node 11)" in text
    for row in (30, 31, 32):
        mass[row, row] *= -1
    negative = replace(model, mass=csr_array(mass))
    text = lines_of_faults(lambda: imported_body(negative, BodyOptions(), "bracket.inp", ""))
    assert "bracket.inp: the mass of node 11 is negative" in text


def test_a_part_that_is_too_large_for_a_file(model: FiniteElementModel, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("derive.fem.imported_body.MAX_BYTES", 50_000)
    text = lines_of_faults(lambda: imported_body(model, BodyOptions(), "bracket.inp", ""))
    assert text.endswith("MB, and a file of nodes is read up to 0.05 MB; make the mesh coarser")


def test_matrices_of_other_sizes_than_the_nodes(model: FiniteElementModel) -> None:
    smaller = replace(model, mass=model.mass[:-3, :-3])  # type: ignore[index]
    text = lines_of_faults(lambda: imported_body(smaller, BodyOptions(), "bracket.inp", ""))
    assert text == "bracket.inp: the mass matrix has the shape (129, 129), and 44 nodes have 132 displacements"


def doubled(model: FiniteElementModel, shared: tuple[int, ...]) -> FiniteElementModel:
    """Two brackets, the second mirrored at the plane x = 0.2 m, which have the shared nodes in common."""
    n = len(model.positions)
    others = np.setdiff1d(np.arange(n), shared)
    index = np.zeros(n, np.int64)
    index[list(shared)] = shared
    index[others] = n + np.arange(len(others))
    places = np.concatenate([np.arange(n), index])
    tie = csr_array((np.ones(2 * n), (np.arange(2 * n), places)))
    tied = csr_array(kron(tie, identity(3)))
    mirror = csr_array(kron(identity(n), np.diag([-1.0, 1, 1])))
    matrices = [csr_array(tied.T @ block_diag([a, mirror @ a @ mirror]) @ tied) for a in (model.stiffness, model.mass)]
    mirrored = model.positions[others] * [-1, 1, 1] + [0.4, 0, 0]
    (block,) = model.elements
    elements = (block, Elements(block.kind, index[block.nodes], block.material))
    return replace(
        model, node_numbers=100 + np.arange(n + len(others)), positions=np.concatenate([model.positions, mirrored]),
        stiffness=matrices[0], mass=matrices[1], node_sets={}, elements=elements, frequencies=None, modes=None,
    )  # fmt: skip


def test_parts_that_nothing_connects(model: FiniteElementModel) -> None:
    text = lines_of_faults(lambda: imported_body(doubled(model, ()), BodyOptions(), "part.inp", ""))
    nodes = "44 nodes (144, 145, 146, 147, 148, 149, 150, 151 and 36 more)"
    expected = f"part.inp: the stiffness does not connect all nodes: {nodes} move against the others"
    assert text == f"{expected}; merge the nodes of parts that touch, or leave loose ones out"


def test_a_hinge_is_named_by_its_nodes(model: FiniteElementModel) -> None:
    """Brackets that share the lower edge of the face at x = 0.2 m turn about it."""
    edge = np.flatnonzero((model.positions[:, 0] == 0.2) & (model.positions[:, 2] == 0))
    assert len(edge) == 3
    text = lines_of_faults(lambda: imported_body(doubled(model, tuple(edge)), BodyOptions(), "part.inp", ""))
    names = ", ".join(str(100 + node) for node in edge)
    assert f"leaves 1 motion without strain besides the six rigid ones, about the nodes {names}: parts that" in text
    unknown = replace(doubled(model, tuple(edge)), elements=())
    text = lines_of_faults(lambda: imported_body(unknown, BodyOptions(), "part.inp", ""))
    assert "leaves 1 motion without strain besides the six rigid ones, above all of the nodes" in text


@pytest.mark.parametrize(
    ("units", "doubt"),
    [
        (FileUnits("m", "t", "s"), "a density is 7.85e+06 kg/m^3"),
        (FileUnits("mm", "kg", "s"), "a Young's modulus is 2.1e+14 Pa"),
        (FileUnits("m", "kg", "ms"), "a body of 0.2 m has its first frequency at 7.05e+05 Hz"),
    ],
)
def test_units_that_give_impossible_numbers_have_a_note(
    model: FiniteElementModel, units: FileUnits, doubt: str
) -> None:
    notes = imported_body(model, BodyOptions(units=units), "bracket.inp", "").notes
    (warning,) = [note for note in notes if note.startswith("warning")]
    assert doubt in warning and warning.endswith(
        "check the units: files in mm and N have the mass in t, --units mm,t,s"
    )


def test_millimetres_and_tonnes_read_as_si_have_a_note(model: FiniteElementModel) -> None:
    """The same bracket in mm, t and s has the density 7.85e-9 and a Young's modulus of 210000."""
    steel = replace(model.materials["STEEL"], young=2.1e5, density=7.85e-9)
    in_mm = replace(
        model, positions=1e3 * model.positions, mass=1e-3 * model.mass, stiffness=1e-3 * model.stiffness,  # type: ignore[operator]
        materials={"STEEL": steel},
    )  # fmt: skip
    first, *_ = imported_body(in_mm, BodyOptions(units=FileUnits("mm", "t", "s")), "bracket.inp", "").notes
    assert "mass 2.3864 kg" in first
    assert not any("warning" in note for note in imported_body(model, BodyOptions(), "bracket.inp", "").notes)
    wrong = imported_body(in_mm, BodyOptions(), "bracket.inp", "").notes
    (warning,) = [note for note in wrong if note.startswith("warning")]
    assert "a density is 7.85e-09 kg/m^3" in warning and "a body of 200 m has its first frequency at 705 Hz" in warning


def test_more_modes_than_a_singular_mass_matrix_moves(model: FiniteElementModel) -> None:
    """A mass matrix of rank 8 for each direction has 24 motions with mass, six of which are rigid."""
    near = np.column_stack([np.ones(44), model.positions, model.positions**2, model.positions[:, 0] ** 3])
    mass = csr_array(kron(near @ near.T, identity(3)))
    singular = replace(model, mass=mass, frequencies=None)
    body = imported_body(singular, BodyOptions(modes=18), "part.inp", "")
    assert "with 18 modes" in body.doc
    text = lines_of_faults(lambda: imported_body(singular, BodyOptions(modes=19), "part.inp", ""))
    expected = "part.inp: body.modes: 19 modes are too many: only 18 elastic modes move mass, since its matrix is"
    assert text == f"{expected} singular; integrate it with more points, or request fewer modes"
