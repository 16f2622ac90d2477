"""A modal body as the text of a SID."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal

import numpy as np

from derive.mechanics.bodies.modal_body import ModalBody, ModalPoint
from derive.sid.mapping import MATRICES, VECTOR, to_matrices
from derive.sid.taylor import GENERAL, SYMMETRIC, Array, Taylor, constant


def write(body: ModalBody, *, inertia: Literal["matrix", "vector"] = "matrix") -> str:
    """The text of a SID; numbers have the 17 digits that give the same doubles back, and zeros are left out.

    The points of the body become nodes 1, 2, ...; their names, and that of the body, are in the first line, which
    other programs take the numbers of nodes and modes from. `inertia` is how J is written: as a symmetric 3 x 3 matrix,
    or as the column of J11, J22, J33, J12, J13, J23 that some programs expect.
    """
    matrices = to_matrices(body)
    if inertia == "vector":
        matrices["J"] = _as_column(matrices["J"])
    return "\n".join([*_lines(body, matrices), ""])


def _lines(body: ModalBody, matrices: dict[str, Taylor]) -> Iterator[str]:
    points = " ".join(point.name for point in body.points)
    names = f"name= {body.name} ; points= {points}".rstrip()
    yield f"{len(body.points)} {body.modes} : nodes, modes; Geo_Stiff= no ; {names}"
    yield "part"
    yield "   new modal"
    yield "      refmod"
    yield f"         mass = {number(body.mass)}"
    yield f"         nelastq = {body.modes}"
    for i in range(body.modes):
        yield f"         ielastq( {i + 1}) = Eigen Mode {i + 1} : {_frequency(body, i):.6f} Hz"
    yield "      end refmod"
    yield "      frame"
    for at, point in enumerate(body.points, 1):
        yield from _node(at, point, body.modes)
    yield "      end frame"
    for name in MATRICES:
        yield from _taylor(name, matrices[name], body.modes, "      ")
    yield "   end modal"
    yield "end part"


def _node(at: int, point: ModalPoint, n: int) -> Iterator[str]:
    shapes = np.ascontiguousarray(point.shapes.T)
    yield f"         new node = {at}"
    yield "            rframe = body ref"
    yield from _taylor("origin", Taylor(point.position[:, None], shapes[:, :, None]), n, "            ")
    yield from _taylor("phi", constant(shapes), n, "            ")
    yield from _taylor("psi", constant(np.zeros((3, n))), n, "            ")
    yield from _taylor("AP", constant(np.eye(3)), n, "            ")
    yield "         end node"


def _taylor(name: str, matrix: Taylor, n: int, indent: str) -> Iterator[str]:
    rows, columns = matrix.m0.shape
    yield f"{indent}{name}"
    head = {"order": matrix.order, "nrow": rows, "ncol": columns, "nq": n, "nqn": 0, "structure": matrix.structure}
    for key, value in head.items():
        yield f"{indent}   {key} = {value}"
    half = matrix.structure == SYMMETRIC
    for i, j in np.argwhere(matrix.m0):
        if not half or j <= i:
            yield f"{indent}   m0( {i + 1}, {j + 1}) = {number(matrix.m0[i, j])}"
    if matrix.m1 is not None:
        for i, k, j in np.argwhere(matrix.m1):
            if not half or j <= i:
                yield f"{indent}   m1( {i + 1}, {k + 1}, {j + 1}) = {number(matrix.m1[i, k, j])}"
    yield f"{indent}end {name}"


def number(value: float) -> str:
    """A double with all of its digits, as Fortran writes it."""
    return f"{float(value):.16E}".replace("E", "D")


def _frequency(body: ModalBody, i: int) -> float:
    """In Hz, of mode i alone; it is there to be looked at."""
    return math.sqrt(max(float(body.stiffness[i, i] / body.c8[i, i]), 0.0)) / (2 * math.pi)


def _as_column(matrix: Taylor) -> Taylor:
    def column(tensor: Array) -> Array:
        return np.array([tensor[a, ..., b] for a, b in VECTOR])[..., None]

    assert matrix.m1 is not None
    return Taylor(column(matrix.m0), column(matrix.m1), GENERAL)
