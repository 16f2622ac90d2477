"""The bracket of CalculiX in the formats of other programs, which are not free: composed from what they publish.

A reader that understands these files as we do need not understand those of the program; the tests compare the numbers.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from scipy.sparse import csr_array, tril

from derive.fem.model import FiniteElementModel
from derive.spec.model.mesh import ElementKind

Rows = Iterable[tuple[int, int, float]]


def halves(matrix: csr_array | None) -> Iterator[tuple[int, int, float]]:
    """The entries of the lower half."""
    entries = tril(matrix, format="coo")
    yield from zip(entries.row.tolist(), entries.col.tolist(), entries.data.tolist(), strict=True)


def abaqus(model: FiniteElementModel, folder: Path, inp: str, labels: bool = False) -> Path:
    """The input, and its matrices by rows and columns or by nodes and directions."""
    (folder / "part.inp").write_text(inp)
    numbers = model.node_numbers
    for name, matrix in (("STIF", model.stiffness), ("MASS", model.mass)):
        lines = [
            f"{numbers[i // 3]},{i % 3 + 1}, {numbers[j // 3]},{j % 3 + 1}, {value:.17g}"
            if labels
            else f"{i + 1} {j + 1} {value:.17g}"
            for i, j, value in halves(matrix)
        ]
        (folder / f"part_{name}2.mtx").write_text("\n".join(lines))
    return folder / "part.inp"


def nastran(model: FiniteElementModel, folder: Path) -> Path:
    """Bulk data in large fields, and a punch file with the matrices by columns."""
    numbers = model.node_numbers.tolist()
    lines = ["SOL 103", "CEND", "BEGIN BULK"]
    for number, (x, y, z) in zip(numbers, model.positions.tolist(), strict=True):
        lines += [f"GRID*   {number:16d}{'':16}{x:16.9e}{y:16.9e}*", f"*       {z:16.9e}"]
    (block,) = model.elements
    assert block.kind is ElementKind.HEX20
    for label, nodes in enumerate(block.nodes, 1):
        own = [numbers[n] for n in nodes]
        own = own[:12] + own[16:] + own[12:16]
        fields: list[str | int] = ["CHEXA", label, 7, *own]
        rows: list[list[str | int]] = [fields[:9], ["", *fields[9:17]], ["", *fields[17:]]]
        lines += ["".join(f"{field!s:<8}" for field in row) for row in rows]
    steel = model.materials[block.material]
    lines += ["PSOLID,7,3", f"MAT1,3,{steel.young:.4E},,{steel.poisson},{steel.density}".replace("E+11", "+11")]
    left = ",".join(str(numbers[n]) for n in model.node_sets["left"][:6])
    lines += [f"SET1,4,{left}", "ENDDATA", ""]
    (folder / "part.bdf").write_text("\n".join(lines))
    punched: list[str] = []
    for name, matrix in (("KAAX", model.stiffness), ("MAAX", model.mass)):
        punched.append(f"DMIG    {name:<8}{0:8d}{6:8d}{2:8d}{0:8d}")
        columns: dict[int, list[tuple[int, float]]] = {}
        for i, j, value in halves(matrix):
            columns.setdefault(j, []).append((i, value))
        for j, entries in columns.items():
            punched.append(f"DMIG*   {name:<16}{numbers[j // 3]:16d}{j % 3 + 1:16d}")
            punched += [
                f"*       {numbers[i // 3]:16d}{i % 3 + 1:16d}" + f"{value:16.9E}".replace("E", "D")
                for i, value in entries
            ]
    (folder / "part.pch").write_text("\n".join(punched))
    return folder / "part.bdf"


def ansys(model: FiniteElementModel, folder: Path) -> Path:
    """An archive, matrices in the format of Harwell and Boeing whose rows are shuffled, and their mapping."""
    numbers, count = model.node_numbers.tolist(), len(model.positions)
    lines = ["/PREP7", "ET, 1,186", f"NBLOCK,6,SOLID, {numbers[-1]}, {count}", "(3i9,6e21.13e3)"]
    for number, at in zip(numbers, model.positions.tolist(), strict=True):
        words = [f"{value:21.13E}" for value in at]
        while words and float(words[-1]) == 0:
            words.pop()  # as the program does
        lines.append(f"{number:9d}{0:9d}{0:9d}{''.join(words)}")
    (block,) = model.elements
    lines += ["N,R5.3,LOC,       -1,", f"EBLOCK,19,SOLID, {len(block.nodes)}, {len(block.nodes)}", "(19i9)"]
    for label, nodes in enumerate(block.nodes, 1):
        own = [numbers[n] for n in nodes]
        entries = [2, 1, 1, 1, 0, 0, 0, 0, 20, 0, label, *own]
        lines += ["".join(f"{entry:9d}" for entry in part) for part in (entries[:19], entries[19:])]
    steel = model.materials[block.material]
    lines += [f"{-1:9d}", "MPTEMP,R5.0, 1, 1, 0.0,", f"MPDATA,R5.0, 1,EX  , 2, 1, {steel.young:.6E} ,"]
    lines += [f"MP,PRXY,2,{steel.poisson}", f"MP,DENS,2,{steel.density}"]
    left = [numbers[n] for n in model.node_sets["left"]]
    lines += [f"CMBLOCK,LEFT    ,NODE,{len(left):8d}", "(8i10)"]
    lines += ["".join(f"{n:10d}" for n in left[k : k + 8]) for k in range(0, len(left), 8)]
    (folder / "part.cdb").write_text("\n".join(lines))
    order = np.random.default_rng(1).permutation(3 * count)
    rows = [f"{k:8d}{numbers[i // 3]:10d}  U{'XYZ'[i % 3]}" for k, i in enumerate(order, 1)]
    (folder / "part_stiff.mapping").write_text("\n".join([" Matrix Eqn   Node   DOF", *rows]))
    for name, matrix in (("stiff", model.stiffness), ("mass", model.mass)):
        assert matrix is not None
        (folder / f"part_{name}.matrix").write_text(harwell_boeing(csr_array(matrix[order][:, order])))
    return folder / "part.cdb"


def harwell_boeing(matrix: csr_array) -> str:
    """A symmetric matrix by the columns of its lower half."""
    half = tril(matrix, format="csc")
    half.sort_indices()
    n = half.shape[0]
    parts = [
        [f"{p + 1:14d}" for p in half.indptr],
        [f"{i + 1:8d}" for i in half.indices],
        [f"{value:25.17E}".replace("E", "D") for value in half.data],
    ]
    lines = [
        ["".join(part[k : k + m]) for k in range(0, len(part), m)] for part, m in zip(parts, (5, 10, 3), strict=True)
    ]
    counts = [sum(map(len, lines)), *map(len, lines), 0]
    head = [f"{'matrix':<72}KEY", "".join(f"{c:14d}" for c in counts)]
    head += [f"RSA{'':11}{n:14d}{n:14d}{half.nnz:14d}{0:14d}", f"{'(5I14)':<16}{'(10I8)':<16}{'(1P,3D25.17)':<20}"]
    return "\n".join([*head, *(line for part in lines for line in part)])


def mbdyn(model: FiniteElementModel, folder: Path, modes: np.ndarray, stiffness: np.ndarray) -> Path:
    """Modal data with the masses of rows of the consistent matrix, lumped."""
    assert model.mass is not None
    count, lumped = len(model.positions), np.abs(model.mass.diagonal()).reshape(-1, 3)
    lumped = lumped * float(model.mass.sum() / 3 / lumped[:, 0].sum())
    text = ["** MBDyn MODAL DATA FILE", "** RECORD GROUP 1, HEADER", "**   REVISION, NODE, NORMAL, ATTACHMENT, ..."]
    text += [f"   REV0  {count}  {len(modes)}  0  0  0", "** RECORD GROUP 2, FINITE ELEMENT NODE LIST"]
    text += [
        " ".join(map(str, model.node_numbers.tolist())),
        "** RECORD GROUP 3, INITIAL MODAL DISPLACEMENTS",
        "0 " * len(modes),
    ]
    for group, column in zip((5, 6, 7), model.positions.T.tolist(), strict=True):
        text += [f"** RECORD GROUP {group}, NODAL COORDINATES", *(f"{value:.17g}" for value in column)]
    text.append("** RECORD GROUP 8, NON-ORTHOGONALISED MODE SHAPES")
    for number, mode in enumerate(modes, 1):
        text.append(f"**    NORMAL MODE SHAPE #  {number}")
        text += [" ".join(f"{x:.17g}" for x in (*row, 0, 0, 0)) for row in mode.tolist()]
    for group, matrix in ((9, np.eye(len(modes))), (10, stiffness)):
        text += [
            f"** RECORD GROUP {group}, MODAL MATRIX",
            *(" ".join(f"{x:.17g}" for x in row) for row in matrix.tolist()),
        ]
    text += ["** RECORD GROUP 11, DIAGONAL OF LUMPED MASS MATRIX"]
    text += [" ".join(f"{x:.17g}" for x in (*row, 0, 0, 0)) for row in lumped.tolist()]
    (folder / "part.fem").write_text("\n".join(text))
    return folder / "part.fem"
