"""`read_mbdyn`: a part from a file of modal data of MBDyn (.fem): modes, their stiffness, and masses at the nodes.

The file is a row of record groups, which `** RECORD GROUP n, ...` begins. Its masses are lumped at the nodes, so that
the shape integrals are approximate; rotations and rotary inertias of the nodes are not used.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.sparse import csr_array, diags_array

from derive.errors import Problem, SpecError
from derive.fem.keyword_file import required_text
from derive.fem.model import Array, FiniteElementModel
from derive.reduction.arithmetic import symmetric_part
from derive.short_text import counted

HEADER, NODES, X, Y, Z, SHAPES, MASS, STIFFNESS, LUMPED = 1, 2, 5, 6, 7, 8, 9, 10, 11
"""The record groups that are read."""

NOT_READ = {3: "initial modal displacements", 4: "initial modal velocities", 12: "global inertia", 13: "modal damping"}


def read_mbdyn(path: Path) -> FiniteElementModel:
    """The part of a file. Raises SpecError with all faults."""
    problems: list[Problem] = []
    groups = _groups(required_text(path))
    header = [float(word) for word in groups.get(HEADER, []) if word.replace(".", "").isdigit()]
    if len(header) < 3:
        problems.append(Problem("RECORD GROUP 1", "the numbers of nodes and of modes are missing"))
        raise SpecError(tuple(problems), str(path))
    nodes = int(header[0])
    modes = int(sum(header[1:4]))
    wanted = {NODES: nodes, X: nodes, Y: nodes, Z: nodes, SHAPES: 6 * nodes * modes}
    wanted |= {MASS: modes**2, STIFFNESS: modes**2, LUMPED: 6 * nodes}
    numbers: dict[int, Array] = {}
    for group, count in wanted.items():
        words = groups.get(group)
        if words is None:
            problems.append(Problem(f"RECORD GROUP {group}", "this is missing"))
            continue
        try:
            numbers[group] = np.array([word.replace("D", "E") for word in words], dtype=np.float64)
        except ValueError:
            problems.append(Problem(f"RECORD GROUP {group}", "a number cannot be read"))
            continue
        if len(words) != count:
            text = f"there are {len(words)} numbers in place of {count}"
            whole = f"{counted(nodes, 'node')} with {counted(modes, 'mode')}"
            problems.append(Problem(f"RECORD GROUP {group}", f"{text}, those of {whole}"))
    if problems:
        raise SpecError(tuple(problems), str(path))
    shapes = numbers[SHAPES].reshape(modes, nodes, 6)
    stiffness, modal_mass = (symmetric_part(numbers[of].reshape(modes, modes)) for of in (STIFFNESS, MASS))
    lumped = numbers[LUMPED].reshape(nodes, 6)
    return FiniteElementModel(
        name=path.stem,
        node_numbers=_node_numbers(groups[NODES]),
        positions=np.stack([numbers[X], numbers[Y], numbers[Z]], axis=1),
        mass=csr_array(diags_array(lumped[:, :3].ravel())),
        modes=np.ascontiguousarray(shapes[:, :, :3]),
        modal_stiffness=stiffness,
        notes=(*_notes(shapes, lumped, modal_mass), *(f"not read: {NOT_READ[g]}" for g in groups if g in NOT_READ)),
    )


def _groups(text: str) -> dict[int, list[str]]:
    """The words of each record group; other lines with asterisks are comments."""
    groups: dict[int, list[str]] = {}
    words: list[str] = []
    for line in text.splitlines():
        heading = line.upper().replace(",", " ").split()
        if line.startswith("**"):
            number = heading[heading.index("GROUP") + 1 :][:1] if {"RECORD", "GROUP"} <= {*heading} else []
            if number and number[0].isdecimal():
                words = groups.setdefault(int(number[0]), [])
            continue
        words += line.split()
    return groups


def _node_numbers(words: list[str]) -> np.ndarray:
    """The numbers of the nodes, or their places where they have names."""
    try:
        return np.array(words, dtype=np.int64)
    except ValueError:
        return np.arange(1, len(words) + 1)


def _notes(shapes: Array, lumped: Array, modal_mass: Array) -> tuple[str, ...]:
    """Yield which groups of the file are left out, and how far the masses at the nodes are from the modal masses."""
    own = np.einsum("ink,nk,jnk->ij", shapes[:, :, :3], lumped[:, :3], shapes[:, :, :3])
    gap = float(np.abs(own - modal_mass).max() / np.abs(modal_mass).max())
    notes = [
        "the masses are lumped at the nodes, so that the integrals of the shapes are approximate: with them the modal "
        f"mass differs by {100 * gap:.2g} % of its largest entry from that of the file"
    ]
    if np.any(shapes[:, :, 3:]) or np.any(lumped[:, 3:]):
        notes.append("rotations and rotary inertias of the nodes are left out")
    return tuple(notes)
