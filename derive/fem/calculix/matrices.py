"""The matrices that CalculiX stores: *FREQUENCY, SOLVER=MATRIXSTORAGE writes JOB.sti, JOB.mas and JOB.dof.

A line of JOB.dof is `node.direction` of a row, with the directions 1, 2 and 3 of the global axes; what supports and
equations eliminate has no row. The others hold the entries of one half with rows and columns from 1. The mass is the
consistent one.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.sparse import csr_array

from derive.errors import Problem
from derive.fem.entries import from_triangle, indices_of, read_rows
from derive.fem.keyword_file import text_or_fault
from derive.fem.model import Indices
from derive.fem.with_nodes import MatricesOfNodes
from derive.progress_line import show_progress

SUFFIXES = (".sti", ".mas", ".dof")

HOW_TO_WRITE = (
    "add three lines at the end of the input, for a body without supports, and run ccx again: *STEP, then "
    "*FREQUENCY, SOLVER=MATRIXSTORAGE, then *END STEP"
)


def read_matrices(job: Path, problems: list[Problem]) -> MatricesOfNodes | None:
    """The matrices beside the input of a job; None after a fault."""
    files = {suffix: job.with_suffix(suffix) for suffix in SUFFIXES}
    missing = [path.name for path in files.values() if not path.exists()]
    if missing:
        verb = "is" if len(missing) == 1 else "are"
        problems.append(Problem("", f"{', '.join(missing)} {verb} missing beside it; {HOW_TO_WRITE}"))
        return None
    rows_of_dof = _degrees_of_freedom(files[".dof"], problems)
    if rows_of_dof is None:
        return None
    node, direction = rows_of_dof
    matrices = [_matrix(files[suffix], len(node), problems) for suffix in (".sti", ".mas")]
    if matrices[0] is None or matrices[1] is None:
        return None
    return MatricesOfNodes(node, direction, matrices[0], matrices[1])


def _degrees_of_freedom(path: Path, problems: list[Problem]) -> tuple[Indices, Indices] | None:
    text = text_or_fault(path, problems, path.name)
    if text is None:
        return None
    rows = read_rows(path, 2, problems, text.replace(".", " "))
    if rows is None:
        return None
    bad = (rows != np.floor(rows)).any(axis=1) | (rows[:, 0] < 1) | (rows[:, 1] < 1) | (rows[:, 1] > 3)
    if bad.any():
        text = f"line {int(bad.argmax()) + 1} is no displacement of a node, such as 12.3 for the third one of node 12"
        problems.append(Problem(path.name, text))
        return None
    node, direction = rows[:, 0].astype(np.int64), rows[:, 1].astype(np.int64) - 1
    twice = len(np.unique(4 * node + direction)) < len(node)
    if twice:
        problems.append(Problem(path.name, "a displacement is there twice; run ccx again"))
        return None
    return node, direction


def _matrix(path: Path, size: int, problems: list[Problem]) -> csr_array | None:
    show_progress(f"reading {path.name} ...")
    rows = read_rows(path, 3, problems)
    if rows is None:
        return None
    largest = int(min(rows[:, :2].max(), 2**60))
    if largest != size and rows[:, :2].min() >= 1:
        text = f"the matrix has {largest} rows, and {path.with_suffix('.dof').name} has {size} lines"
        problems.append(Problem(path.name, f"{text}: these files are not of one run; run ccx again"))
        return None
    pairs = indices_of(rows, path, size, problems)
    show_progress()
    return None if pairs is None else from_triangle(*pairs, rows[:, 2], size)
