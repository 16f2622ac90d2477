"""`read_nastran`: a part from bulk data and the matrices KAAX and MAAX that EXTSEOUT(DMIGPCH) has punched beside it.

A card DMIG of a column names its grid point and component, and then those of rows with their values; of a symmetric
matrix (form 6) one half is there.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.sparse import csr_array

from derive.errors import Problem, SpecError
from derive.fem.entries import from_triangle, symmetric_from
from derive.fem.keyword_file import read_text
from derive.fem.model import FiniteElementModel
from derive.fem.nastran.bulk_data import BulkCard, bulk_cards, real
from derive.fem.nastran.mesh import read_bulk_mesh
from derive.fem.node_names import node_list
from derive.fem.with_nodes import index_of, mesh_of_nodes
from derive.progress_line import show_progress
from derive.spec.files.file_content import unreadable

NAMES = {"stiffness": ("KAAX", "KAA", "K2GG"), "mass": ("MAAX", "MAA", "M2GG")}
"""The names of the matrices; the first that is there counts."""

SYMMETRIC = "6"
"""The form of a matrix of which one half is written."""

HOW_TO_WRITE = (
    "write them for a body without supports, whose grid points are all in the set A, with EXTSEOUT(STIFFNESS,MASS,"
    "DMIGPCH) in the case control, and run Nastran again"
)


def read_nastran(path: Path) -> FiniteElementModel:
    """The part of bulk data and of the punch file with the same name beside it. Raises SpecError with all faults."""
    problems: list[Problem] = []
    text, punched = _text(path, problems), _text(path.with_suffix(".pch"), problems, HOW_TO_WRITE)
    if problems:
        raise SpecError(tuple(problems), str(path))
    mesh, turned = read_bulk_mesh(text, problems)
    if turned:
        text = f"the grid points {node_list(np.array(turned))} have coordinate systems of their own (CP or CD)"
        problems.append(Problem("GRID", f"{text}; write positions and displacements in the basic system"))
    show_progress(f"reading {path.with_suffix('.pch').name} ...")
    columns = list(bulk_cards(punched, ("DMIG",)))
    names = {card.field(2).upper() for card in columns}
    matrices: dict[str, csr_array | None] = {}
    places: dict[str, dict[tuple[int, int], None]] = {}
    for what, known in NAMES.items():
        name = next((name for name in known if name in names), "")
        if not name:
            problems.append(Problem(path.with_suffix(".pch").name, f"there is no DMIG {known[0]}; {HOW_TO_WRITE}"))
            continue
        own = [card for card in columns if card.field(2).upper() == name]
        matrices[what], places[what] = _matrix(own, name, mesh.numbers, problems)
    show_progress()
    if problems:
        raise SpecError(tuple(problems), str(path))
    held = np.unique([node for node, _ in places["stiffness"]])
    kept = np.isin(mesh.numbers, held)
    rows = np.flatnonzero(np.repeat(kept, 3))
    taken = {what: None if m is None else csr_array(m[rows][:, rows]) for what, m in matrices.items()}
    numbers = mesh.numbers[kept]
    left_out = mesh.numbers[~kept]
    notes = (f"grid points without stiffness are left out: {node_list(left_out)}",) if len(left_out) else ()
    return FiniteElementModel(
        name=path.stem,
        node_numbers=numbers,
        positions=mesh.positions[kept],
        stiffness=taken["stiffness"],
        mass=taken["mass"],
        notes=notes,
        **mesh_of_nodes(mesh, numbers),
    )


def _text(path: Path, problems: list[Problem], hint: str = "") -> str:
    try:
        return read_text(path)
    except (OSError, ValueError) as error:
        text = unreadable(error)
        problems.append(Problem(path.name, f"{text}; {hint}" if hint else text))
        return ""


def _matrix(
    cards: list[BulkCard], name: str, numbers: np.ndarray, problems: list[Problem]
) -> tuple[csr_array | None, dict[tuple[int, int], None]]:
    """The matrix of all grid points, and the grid points and components of its entries; None after a fault."""
    header = next((card for card in cards if card.field(3) == "0"), None)
    if header is None or header.field(5) not in ("1", "2"):
        problems.append(
            Problem(f"DMIG {name}", "its first card, with the form and the type of real numbers, is missing")
        )
        return None, {}
    pairs: dict[tuple[int, int], None] = {}
    rows, columns, values = list[tuple[int, int]](), list[tuple[int, int]](), list[float]()
    for card in cards:
        if card is header:
            continue
        try:
            column = int(card.field(3)), int(card.field(4) or "0")
            for k in range(6, len(card.fields) + 2, 4):
                if card.field(k):
                    rows.append((int(card.field(k)), int(card.field(k + 1) or "0")))
                    columns.append(column)
                    values.append(real(card.field(k + 2)))
        except ValueError:
            problems.append(Problem(f"DMIG {name}", "a field of this card is no number", card.line))
            return None, {}
    pairs |= dict.fromkeys((*rows, *columns))
    if fault := _fault(pairs, numbers, name):
        problems.append(fault)
        return None, {}
    size = 3 * len(numbers)
    row, column_ = (_places(of, numbers) for of in (rows, columns))
    make = from_triangle if header.field(4) == SYMMETRIC else symmetric_from
    return make(row, column_, np.array(values), size), pairs


def _places(pairs: list[tuple[int, int]], numbers: np.ndarray) -> np.ndarray:
    of = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    return np.asarray(3 * index_of(numbers, of[:, 0]) + of[:, 1] - 1)


def _fault(pairs: dict[tuple[int, int], None], numbers: np.ndarray, name: str) -> Problem | None:
    """Grid points that are not in the bulk data, and entries that are no displacements."""
    others = sorted({node for node, component in pairs if not 1 <= component <= 3})
    unknown = sorted({node for node, _ in pairs} - {*numbers.tolist()})
    if unknown:
        text = f"the grid points {node_list(np.array(unknown))} are not in the bulk data"
        return Problem(f"DMIG {name}", text)
    if others:
        text = (
            f"there are rotations or scalar points ({node_list(np.array(others))}); mesh the part with solid elements"
        )
        return Problem(f"DMIG {name}", f"{text}, all of whose grid points are in the set A")
    return None
