"""Readers of Abaqus, Nastran, ANSYS and MBDyn give the part of CalculiX from files that are composed in their formats.

These programs are not free, or not here: the files follow what they publish, and none was written by its program.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import other_formats
import pytest
from part_files import bracket_files, text_of
from scipy.sparse import csr_array

import derive
from derive.fem.calculix.read import read_calculix
from derive.fem.imported_body import BodyOptions, ImportedBody, imported_body
from derive.fem.model import FiniteElementModel
from derive.fem.readers import READERS
from derive.reduction.body import prepare
from derive.spec.construction.bodies import nodal_body
from derive.spec.model.body import NodalBody

Write = Callable[[FiniteElementModel, Path], Path]

FORMATS: dict[str, Write] = {
    "abaqus": lambda model, folder: other_formats.abaqus(model, folder, text_of("inp")),
    "abaqus labels": lambda model, folder: other_formats.abaqus(model, folder, text_of("inp"), labels=True),
    "nastran": other_formats.nastran,
    "ansys": other_formats.ansys,
}


@cache
def bracket() -> FiniteElementModel:
    """The part as CalculiX wrote it."""
    with TemporaryDirectory() as folder:
        return read_calculix(bracket_files(Path(folder)))


def read(path: Path) -> FiniteElementModel:
    """The part in a file, by the reader for its suffix."""
    return READERS[path.suffix].read(path)


def close(own: csr_array | None, expected: csr_array | None) -> None:
    """Check a matrix to the nine digits that the widths of fields leave."""
    assert own is not None and expected is not None
    assert abs(own - expected).max() <= 1e-9 * abs(expected).max()


@pytest.mark.parametrize("program", FORMATS)
def test_matrices_and_mesh_are_those_of_the_part(program: str, tmp_path: Path) -> None:
    """Matrices, positions, elements, materials and sets are the same, whatever the order of the rows in the files."""
    expected = bracket()
    own = read(FORMATS[program](expected, tmp_path))
    assert own.node_numbers.tolist() == expected.node_numbers.tolist()
    np.testing.assert_allclose(own.positions, expected.positions, atol=1e-10)
    close(own.stiffness, expected.stiffness)
    close(own.mass, expected.mass)
    (block,), (known,) = own.elements, expected.elements
    assert block.kind is known.kind
    assert block.nodes.tolist() == known.nodes.tolist()
    steel, material = own.materials[block.material], expected.materials[known.material]
    assert (steel.young, steel.poisson, steel.density) == (material.young, material.poisson, material.density)
    left = next(nodes for name, nodes in own.node_sets.items() if name.lower() in ("left", "set_4"))
    assert {*left.tolist()} <= {*expected.node_sets["left"].tolist()}


@pytest.mark.parametrize("program", ["nastran", "ansys"])
def test_a_part_becomes_the_body_of_calculix(program: str, tmp_path: Path) -> None:
    """The frequencies of the bodies agree to the digits of the files."""
    model = read(FORMATS[program](bracket(), tmp_path))
    first, second = (imported_body(part, BodyOptions(modes=4), "part", "") for part in (bracket(), model))
    np.testing.assert_allclose(frequencies(first), frequencies(second), rtol=1e-5)


def frequencies(body: ImportedBody) -> list[float]:
    """The natural frequencies in the note on them, Hz."""
    (note,) = (note for note in body.notes if "natural frequencies" in note)
    return [float(word) for word in note.split(": ")[1].split(" Hz")[0].split(", ")]


def test_modal_data_of_mbdyn_become_a_body_with_their_modes(tmp_path: Path) -> None:
    """The modes and their stiffness are those of the file, and a note says that its masses are approximate."""
    expected = bracket()
    arrays = {"positions": expected.positions, "mass": expected.mass, "stiffness": expected.stiffness}
    shapes = prepare(nodal_body("part", arrays, units="SI", modes=5)).shapes
    model = read(other_formats.mbdyn(expected, tmp_path, shapes.phi, shapes.stiffness))
    assert model.modes is not None
    np.testing.assert_allclose(model.modes, shapes.phi, rtol=1e-15)
    body = imported_body(model, BodyOptions(), "part.fem", "")
    assert "modes =" not in body.text
    (tmp_path / "part.npz").write_bytes(body.archive)
    (tmp_path / "part.toml").write_text(body.text)
    assert model.modal_stiffness is not None
    np.testing.assert_allclose(model.modal_stiffness, shapes.stiffness, rtol=1e-15)
    own = derive.read(tmp_path / "part.toml")
    assert isinstance(own, NodalBody)
    reduced = derive.modal(own)
    assert reduced.modes == 5
    assert reduced.mass == pytest.approx(float(model.mass.sum() / 3) if model.mass is not None else 0)
    assert any("approximate" in note for note in body.notes)
    assert "not read: initial modal displacements" in body.notes
    path = tmp_path / "part.fem"
    path.write_text(path.read_text().replace("** RECORD GROUP 5, NODAL", "** RECORD GROUP\n** RECORD GROUP NODAL"))
    with pytest.raises(derive.SpecError, match="RECORD GROUP 5: this is missing"):
        read(path)


@pytest.mark.parametrize(
    ("program", "suffix", "change", "message"),
    [
        ("abaqus", "_STIF2.mtx", lambda text: text + "\n9999 1 2.0", "the matrix has 9999 rows"),
        ("abaqus labels", "_MASS2.mtx", lambda text: text + "\n1,4, 1,4, 2.0", "is of a rotation"),
        ("nastran", ".pch", lambda text: text.replace("KAAX", "KXX "), "there is no DMIG KAAX"),
        ("nastran", ".bdf", lambda text: text.replace("BULK", "BULK\nGRID,1,5,0.,0.,0."), "coordinate systems"),
        ("ansys", "_stiff.mapping", lambda text: text.replace("UX", "ROTX"), "which is no displacement"),
        ("ansys", "_mass.matrix", lambda text: text.replace("RSA", "CSA"), "a real, assembled, square one is needed"),
        ("ansys", "_mass.matrix", lambda text: "\n".join(text.splitlines()[:-3]), "fewer entries"),
    ],
)  # fmt: skip
def test_files_that_are_not_as_they_should_be_have_a_line(
    program: str, suffix: str, change: Callable[[str], str], message: str, tmp_path: Path
) -> None:
    """Faults name the file and what to do, for each format."""
    path = FORMATS[program](bracket(), tmp_path)
    file = tmp_path / f"part{suffix}"
    file.write_text(change(file.read_text()))
    with pytest.raises(derive.SpecError) as refused:
        read(path)
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("program", "needed"), [("abaqus", "*MATRIX GENERATE"), ("nastran", "EXTSEOUT"), ("ansys", "HBMAT")]
)
def test_missing_matrices_say_how_they_are_written(program: str, needed: str, tmp_path: Path) -> None:
    """Without the files beside it, a mesh is refused with the lines that the program needs."""
    path = FORMATS[program](bracket(), tmp_path)
    for file in tmp_path.iterdir():
        if file != path and (program != "abaqus" or "STIF" in file.name):
            file.unlink()
    with pytest.raises(derive.SpecError) as refused:
        read(path)
    assert needed in str(refused.value)
