"""`read_standard_input`: a body from standard input data (SID), which have no nodes but moments, and frames that move.

Each frame becomes a node, and a set of four nodes around it which move as it does, so that the mean motion of the set
is that of the frame. Modes, stiffness and moments are those of the file, in its frame of reference.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from derive.errors import Problem, SpecError
from derive.fem.keyword_file import required_text
from derive.fem.model import Array, FiniteElementModel
from derive.mechanics.bodies.modal_body import ModalBody
from derive.reduction.integrals import omega_factors
from derive.sid.blocks import SidError
from derive.sid.mapping import symmetric_parts
from derive.sid.read import StandardInput, read_with_rotations

AROUND = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / 3**0.5
"""The nodes around a frame, as multiples of ARM."""

ARM = 0.01
"""The distance of these nodes from the frame, relative to the radius of gyration of the body."""


def read_standard_input(path: Path) -> FiniteElementModel:
    """The body of a file. Raises SpecError with all faults."""
    try:
        content = read_with_rotations(required_text(path))
    except SidError as error:
        problems = tuple(Problem("", fault.message, fault.line) for fault in error.problems)
        raise SpecError(problems, str(path)) from None
    body = content.body
    positions, modes, sets = _frames(content)
    moments, geometric = moments_of(body)
    stiffening: dict[str, Any] = {**geometric}
    if body.second_order:
        second = [point.second for point in body.points for _ in range(1 + len(AROUND))]
        stiffening["K0F"] = np.array([-np.moveaxis(psi, -1, 0) for psi in second if psi is not None])
        stiffening["K0F_nodes"] = np.arange(len(positions))
    return FiniteElementModel(
        name=body.name if body.name != "body" else path.stem,
        node_numbers=np.arange(1, len(positions) + 1),
        positions=positions,
        modes=modes,
        modal_stiffness=body.stiffness,
        node_sets=sets,
        moments=moments,
        stiffening=stiffening,
        modal_damping=body.damping,
        notes=content.notes,
    )


def _frames(content: StandardInput) -> tuple[Array, Array, dict[str, Any]]:
    """The nodes (n, 3), the modes (N, n, 3) there, and the nodes around each frame by its name."""
    body = content.body
    arm = ARM * float(np.sqrt(np.trace(body.C3) / (2 * body.mass)))
    positions, modes, sets = [], [], {}
    for k, point in enumerate(body.points):
        twists = content.twists[point.name]
        arms = [np.zeros(3), *(arm * AROUND)]
        positions += [point.position + r for r in arms]
        modes += [point.shapes + np.cross(twists, r) for r in arms]
        first = k * len(arms) + 1
        sets[point.name] = np.arange(first, first + len(AROUND))
    if not positions:  # a body has nodes; this one moves with the floating frame
        positions, modes = [np.zeros(3)], [np.zeros((body.modes, 3))]
    return np.array(positions), np.ascontiguousarray(np.array(modes).transpose(1, 0, 2)), sets


def moments_of(body: ModalBody) -> tuple[Array, dict[str, Array]]:
    """The moments (4 + 3 N, 4 + 3 N) of 1, X and the modes, and the geometric stiffness matrices, of a modal body.

    C5 of a body of second order contains K0omega. Moments with the trace of c8 are left there, and the rest of C5 is
    that of K0omega, since the equations contain the sum alone.
    """
    n = body.modes
    tensors, axial = np.zeros((n + 1, n + 1, 3, 3)), np.zeros((n + 1, n + 1, 3))
    tensors[0, 0] = body.C3
    tensors[1:, 0] = tensors[0, 1:] = symmetric_parts(body.C4, -body.c6)
    c5 = symmetric_parts(body.C5, body.c7)
    stiffening: dict[str, Array] = {}
    if body.c9 is not None and body.c10 is not None:
        excess = (np.trace(c5, axis1=-2, axis2=-1) - 2 * body.c8) / 3
        isotropic = excess[..., None, None] * np.eye(3)
        c5 = c5 - isotropic
        tables = {"K0t": body.c9, "K0r": body.c10, "K0omega": omega_factors(isotropic)}
        stiffening = {name: np.ascontiguousarray(np.moveaxis(table, -1, 0)) for name, table in tables.items()}
    tensors[1:, 1:] = c5
    axial[0, 1:], axial[1:, 0], axial[1:, 1:] = body.c6, -body.c6, body.c7
    second = np.trace(tensors, axis1=-2, axis2=-1)[..., None, None] / 2 * np.eye(3) - tensors
    for a, b, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        second[..., a, b] += axial[..., k] / 2
        second[..., b, a] -= axial[..., k] / 2
    size = 3 * (n + 1)
    result = np.zeros((1 + size, 1 + size))
    result[0, 0] = body.mass
    result[0, 1:] = result[1:, 0] = np.concatenate([body.c1, body.c2.ravel()])
    result[1:, 1:] = second.transpose(0, 2, 1, 3).reshape(size, size)
    return result, stiffening
