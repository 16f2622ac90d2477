"""`read_ansys`: a part from an archive of ANSYS and the matrices that HBMAT has written beside it.

The mapping file names the node and the displacement of each row: a line is `row node direction`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.sparse import csr_array

from derive.errors import Problem, SpecError
from derive.fem.ansys.archive import read_archive
from derive.fem.ansys.harwell_boeing import read_harwell_boeing
from derive.fem.calculix.read import notes_on_mesh
from derive.fem.keyword_file import read_text, required_text
from derive.fem.model import FiniteElementModel, Indices
from derive.fem.node_names import node_list
from derive.fem.with_nodes import MatricesOfNodes, in_order_of_nodes, mesh_of_nodes
from derive.progress_line import show_progress

DIRECTIONS = {"UX": 0, "UY": 1, "UZ": 2}


def read_ansys(path: Path) -> FiniteElementModel:
    """The part of an archive, and of the matrices beside it. Raises SpecError with all faults."""
    problems: list[Problem] = []
    mesh = read_archive(required_text(path), problems)
    stem = path.stem
    files = {name: path.with_name(f"{stem}_{name}.matrix") for name in ("stiff", "mass")}
    mapping = path.with_name(f"{stem}_stiff.mapping")
    if missing := [file.name for file in (*files.values(), mapping) if not file.exists()]:
        problems.append(Problem("", f"{', '.join(missing)} missing beside it; {_how_to_write(stem)}"))
    if problems:
        raise SpecError(tuple(problems), str(path))
    rows = _rows(mapping, problems)
    matrices: list[csr_array] = []
    for file in files.values():
        show_progress(f"reading {file.name} ...")
        matrix = read_harwell_boeing(file, problems)
        if matrix is not None and rows is not None and len(rows[0]) != matrix.shape[0]:
            text = f"the matrix has {matrix.shape[0]} rows, and {mapping.name} has {len(rows[0])} lines"
            problems.append(Problem(file.name, f"{text}: these files are not of one run"))
        if matrix is not None:
            matrices.append(matrix)
    show_progress()
    if rows is not None and not problems:
        problems += _faults_of_rows(*rows, mesh.numbers)
    if problems or rows is None:
        raise SpecError(tuple(problems), str(path))
    kept = np.isin(mesh.numbers, rows[0])
    numbers = mesh.numbers[kept]
    stiffness, mass = in_order_of_nodes(MatricesOfNodes(*rows, *matrices), numbers)
    return FiniteElementModel(
        name=stem,
        node_numbers=numbers,
        positions=mesh.positions[kept],
        stiffness=stiffness,
        mass=mass,
        notes=tuple(notes_on_mesh(mesh, kept)),
        **mesh_of_nodes(mesh, numbers),
    )


def _how_to_write(stem: str) -> str:
    return (
        "write them in /AUX2 from the full file of a modal analysis without supports:\n"
        f"FILE,{stem},full\nHBMAT,{stem}_stiff,matrix,,ASCII,STIFF,NO,YES\nHBMAT,{stem}_mass,matrix,,ASCII,MASS,NO,YES"
    )


def _rows(path: Path, problems: list[Problem]) -> tuple[Indices, Indices] | None:
    """The node and the direction of each row; None after a fault."""
    nodes, directions = list[int](), list[int]()
    for number, line in enumerate(read_text(path).splitlines(), 1):
        words = line.split()
        if len(words) < 3 or not words[0].isdigit():
            continue  # the heading
        if words[2].upper() not in DIRECTIONS:
            text = f"line {number} is of {words[2]}, which is no displacement; mesh the part with solid elements"
            problems.append(Problem(path.name, text))
            return None
        if int(words[0]) != len(nodes) + 1:
            problems.append(Problem(path.name, f"line {number} is not of row {len(nodes) + 1}"))
            return None
        nodes.append(int(words[1]))
        directions.append(DIRECTIONS[words[2].upper()])
    return np.array(nodes, dtype=np.int64), np.array(directions, dtype=np.int64)


def _faults_of_rows(node: Indices, direction: Indices, numbers: Indices) -> list[Problem]:
    """Nodes that are not in the archive, and nodes of which some displacements have no row."""
    if (unknown := np.setdiff1d(node, numbers)).size:
        return [Problem("", f"the nodes {node_list(unknown)} of the matrices are not in the archive")]
    found, counts = np.unique(3 * node + direction, return_counts=True)
    of_nodes, own = np.unique(found // 3, return_counts=True)
    if (counts > 1).any() or (own < 3).any():
        text = f"displacements of the nodes {node_list(of_nodes[own < 3])} are missing"
        return [Problem("", f"{text}: the part is held or tied there; write it without supports")]
    return []
