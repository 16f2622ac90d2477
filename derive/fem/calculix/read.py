"""`read_calculix`: a part from the input of CalculiX and the files that it has written beside it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from derive.errors import Problem, SpecError
from derive.fem.calculix.matrices import read_matrices
from derive.fem.calculix.results import read_frequencies, read_modes
from derive.fem.calculix.rigid_bodies import without_rotations
from derive.fem.keyword_mesh import KeywordMesh, read_mesh
from derive.fem.model import FiniteElementModel
from derive.fem.node_names import node_list
from derive.fem.with_nodes import MatricesOfNodes, in_order_of_nodes, mesh_of_nodes, nodes_of_elements
from derive.short_text import counted

TIES = ("EQUATION", "MPC", "TIE", "COUPLING", "KINEMATIC", "DISTRIBUTING COUPLING", "CYCLIC SYMMETRY MODEL", "EMBEDDED")
"""The keywords by which displacements of nodes follow others."""


WITH_ROTATIONS = (*("S3", "S4", "S6", "S8", "B2", "B3", "T2", "T3", "M3D", "CPS", "CPE", "CAX", "U1"), "US", "SAX")
"""The beginnings of the types of shells, beams, trusses and plane elements, for which CalculiX adds nodes."""


def read_calculix(path: Path) -> FiniteElementModel:
    """The part of a job of CalculiX. Raises SpecError with all faults.

    Nodes without displacements of their own are left out: those of no element, and those that equations tie to others
    in all three directions alike, whose mass and stiffness the matrices then hold at the others.
    """
    mesh = read_mesh(path)
    problems = list(_faults_of_elements(mesh))
    matrices = None if problems else read_matrices(path, problems)
    rigid = [
        f"{mesh.names.get(body.name, body.name)} is rigid: its motion is that of its reference node"
        for body in mesh.rigid_bodies
    ]
    if matrices is not None:
        mesh, matrices = without_rotations(mesh, matrices, problems)
    if matrices is not None and not problems:
        problems += _faults_of_displacements(mesh, matrices, path.stem)
    if problems or matrices is None:
        raise SpecError(tuple(problems), str(path))
    kept = np.isin(mesh.numbers, matrices.node)
    numbers = mesh.numbers[kept]
    stiffness, mass = in_order_of_nodes(matrices, numbers)
    frequencies = read_frequencies(path)
    modes = read_modes(path, numbers, problems)
    notes = [*rigid, *notes_on_mesh(mesh, kept), *(f"{problem.path}: {problem.message}" for problem in problems)]
    if frequencies is not None and modes is not None:
        modes = modes[-len(frequencies) :] if len(modes) >= len(frequencies) else None
    return FiniteElementModel(
        name=path.stem,
        node_numbers=numbers,
        positions=mesh.positions[kept],
        stiffness=stiffness,
        mass=mass,
        frequencies=frequencies,
        modes=modes,
        notes=tuple(notes),
        **mesh_of_nodes(mesh, numbers),
    )


def _faults_of_elements(mesh: KeywordMesh) -> Iterator[Problem]:
    """The fault of elements whose nodes have other coordinates than displacements."""
    types = [name for name in mesh.other_elements if name.startswith(WITH_ROTATIONS)]
    if types:
        text = f"elements of the type {', '.join(types)} have rotations, and nodes of a body do not"
        yield Problem(
            "*ELEMENT", f"{text}: mesh the part with solid elements, such as C3D10 or C3D20, and run ccx again"
        )


def _faults_of_displacements(mesh: KeywordMesh, matrices: MatricesOfNodes, job: str) -> Iterator[Problem]:
    """Faults of nodes that are not in the mesh, that are held, or that follow others in some directions alone."""
    unknown = np.setdiff1d(matrices.node, mesh.numbers)
    if unknown.size and "COUPLING" in mesh.cards:
        text = "its reference node has rotations, and nodes of a body do not; leave it out, run ccx again, and name its"
        yield Problem(
            "*COUPLING",
            f"{text} surface with --interface: its marker couples in the same way",
            mesh.cards["COUPLING"][0],
        )
        return
    if unknown.size:
        text = f"the nodes {node_list(unknown)} of the matrices are not in the mesh: CalculiX adds nodes for shells,"
        yield Problem("", f"{text} beams and incompatible modes (C3D8I); use other solid elements, such as C3D20")
        return
    if "RIGID BODY" in mesh.cards:
        text = "a rigid body is read of a set of nodes with a reference node: NSET=..., REF NODE=..."
        yield Problem("*RIGID BODY", f"{text}; name these, and run ccx again", mesh.cards["RIGID BODY"][0])
        return
    numbers, counts = np.unique(matrices.node, return_counts=True)
    absent = np.setdiff1d(nodes_of_elements(mesh), numbers)
    partly = numbers[counts < 3]
    if not (absent.size or partly.size):
        return
    if "BOUNDARY" in mesh.cards:
        where = np.concatenate([partly, absent])
        text = f"the part is held at the nodes {node_list(where)}; a body is stored without supports: leave them out"
        free = f"{text}, or free it in the step that stores the matrices by a line *BOUNDARY, OP=NEW, and run ccx again"
        yield Problem("*BOUNDARY", free, mesh.cards["BOUNDARY"][0])
    elif partly.size:
        text = f"displacements of the nodes {node_list(partly)} are missing in some directions"
        yield Problem("", f"{text}{_ties(mesh)}; tie nodes in all three directions, or leave the ties out")
    elif not (mesh.rigid_bodies or any(card in mesh.cards for card in TIES)):
        yield Problem("", f"displacements of the nodes {node_list(absent)} are missing in {job}.dof; run ccx again")


def _ties(mesh: KeywordMesh) -> str:
    """The keywords that may be the cause, with their lines."""
    given = [f"*{card} in line {mesh.cards[card][0]}" for card in TIES if card in mesh.cards]
    return f" ({', '.join(given)})" if given else ""


def notes_on_mesh(mesh: KeywordMesh, kept: NDArray[np.bool_]) -> Iterator[str]:
    """Yield notes on parts that are left out or not read."""
    left_out = mesh.numbers[~kept]
    tied = np.intersect1d(left_out, nodes_of_elements(mesh))
    loose = np.setdiff1d(left_out, tied)
    if loose.size:
        yield f"{counted(loose.size, 'node')} of no element {_are(loose.size)} left out: {node_list(loose)}"
    if tied.size:
        yield (
            f"{counted(tied.size, 'node')} that {'follows' if tied.size == 1 else 'follow'} others"
            f"{_ties(mesh)} {_are(tied.size)} left out, with the elements there in pictures: {node_list(tied)}"
        )
    for name, count in mesh.other_elements.items():
        yield f"{counted(count, 'line')} of elements of the type {name}: in the matrices, but not in pictures"
    if mesh.unknown:
        yield f"{counted(mesh.unknown, 'number')} in sets of nodes {_are(mesh.unknown)} not those of nodes"
    if others := [f"{count} *{card}" for card, (_, count) in mesh.cards.items()]:
        yield f"not read: {', '.join(others)}"


def _are(count: int) -> str:
    return "is" if count == 1 else "are"
