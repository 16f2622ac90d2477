"""`read_abaqus`: a part from the input of Abaqus and the matrices that *MATRIX GENERATE has written beside it.

A line of these files is `row column value` (FORMAT=COORDINATE), where the rows are the three displacements of each node
in the order of the numbers of nodes, or `node, direction, node, direction, value` (FORMAT=MATRIX INPUT).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.sparse import csr_array

from derive.errors import Problem, SpecError
from derive.fem.calculix.read import notes_on_mesh
from derive.fem.entries import indices_of, read_rows, symmetric_from
from derive.fem.keyword_file import text_or_fault
from derive.fem.keyword_mesh import read_mesh
from derive.fem.model import Array, FiniteElementModel, Indices
from derive.fem.node_names import node_list
from derive.fem.with_nodes import index_of, mesh_of_nodes, nodes_of_elements
from derive.progress_line import show_progress

HOW_TO_WRITE = (
    "add four lines at the end of the input, for a body without supports, and run Abaqus again: *STEP, then "
    "*MATRIX GENERATE, STIFFNESS, MASS, then *MATRIX OUTPUT, STIFFNESS, MASS, FORMAT=COORDINATE, then *END STEP"
)

KINDS = {"stiffness": "STIF", "mass": "MASS"}
"""The part of the names of the files by the matrix: JOB_STIF2.mtx is the stiffness of step 2."""


def matrix_files(job: Path) -> dict[str, list[Path]]:
    """The files of matrices beside the input of a job; the steps of one matrix in the order of their numbers."""
    return {
        name: sorted(job.parent.glob(f"{job.stem}_{kind}*.mtx"), key=lambda path: (len(path.name), path.name))
        for name, kind in KINDS.items()
    }


def read_abaqus(path: Path) -> FiniteElementModel:
    """The part of a job of Abaqus; of several steps with matrices the last one counts. Raises SpecError."""
    mesh = read_mesh(path)
    problems: list[Problem] = []
    if mesh.rigid_bodies:  # that of CalculiX alone is read
        mesh.cards["RIGID BODY"] = (mesh.rigid_bodies[0].line, len(mesh.rigid_bodies))
    kept = np.isin(mesh.numbers, nodes_of_elements(mesh))
    numbers = np.sort(mesh.numbers[kept])
    files = matrix_files(path)
    if missing := [f"{path.stem}_{KINDS[name]}1.mtx" for name, found in files.items() if not found]:
        problems.append(Problem("", f"{', '.join(missing)} missing beside it; {HOW_TO_WRITE}"))
        raise SpecError(tuple(problems), str(path))
    matrices = {name: _matrix(found[-1], numbers, problems) for name, found in files.items()}
    if problems:
        raise SpecError(tuple(problems), str(path))
    notes = [f"{name} from {found[-1].name}" for name, found in files.items()]
    order = index_of(mesh.numbers, numbers)
    return FiniteElementModel(
        name=path.stem,
        node_numbers=numbers,
        positions=mesh.positions[order],
        stiffness=matrices["stiffness"],
        mass=matrices["mass"],
        notes=(*notes, *notes_on_mesh(mesh, kept)),
        **mesh_of_nodes(mesh, numbers),
    )


def _matrix(path: Path, numbers: Indices, problems: list[Problem]) -> csr_array | None:
    """The matrix of a file, with the three displacements of each node together; None after a fault."""
    show_progress(f"reading {path.name} ...")
    text = text_or_fault(path, problems, path.name)
    if text is None:
        return None
    text = text.replace(",", " ")
    first = next((line.split() for line in text.splitlines() if line.strip()), [])
    of_labels = len(first) == 5
    rows = read_rows(path, 5 if of_labels else 3, problems, text)
    show_progress()
    if rows is None:
        return None
    return _of_labels(rows, path, numbers, problems) if of_labels else _of_rows(rows, path, numbers, problems)


def _of_rows(rows: Array, path: Path, numbers: Indices, problems: list[Problem]) -> csr_array | None:
    size = 3 * len(numbers)
    largest = int(min(rows[:, :2].max(), 2**60))
    if largest != size:
        text = f"the matrix has {largest} rows, and the {len(numbers)} nodes of the elements have {size} displacements"
        how = "write FORMAT=MATRIX INPUT, which names the nodes, or leave out what is no solid element"
        problems.append(Problem(path.name, f"{text}; {how}"))
        return None
    pairs = indices_of(rows, path, size, problems)
    return None if pairs is None else symmetric_from(*pairs, rows[:, 2], size)


def _of_labels(rows: Array, path: Path, numbers: Indices, problems: list[Problem]) -> csr_array | None:
    places = []
    for node, direction in (rows[:, 0:2].T, rows[:, 2:4].T):
        at = index_of(numbers, node.astype(np.int64))
        if (at < 0).any():
            unknown = np.unique(node[at < 0]).astype(np.int64)
            problems.append(Problem(path.name, f"the nodes {node_list(unknown)} are in no solid element of the input"))
            return None
        if ((direction < 1) | (direction > 3)).any():
            line = int(((direction < 1) | (direction > 3)).argmax()) + 1
            text = f"line {line} is of a rotation or another variable; solid elements have three displacements"
            problems.append(Problem(path.name, text))
            return None
        places.append(3 * at + direction.astype(np.int64) - 1)
    return symmetric_from(places[0], places[1], rows[:, 4], 3 * len(numbers))
