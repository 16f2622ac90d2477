"""`write`: the text of a SID from a modal body."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Literal

import numpy as np

from derive.mechanics.bodies.modal_body import ModalBody, ModalFrame, ModalPoint
from derive.sid.mapping import GENERAL, INERTIA_COLUMN, MATRICES, SYMMETRIC, Array, Taylor, constant_matrix, to_matrices


def write(
    body: ModalBody,
    *,
    inertia: Literal["matrix", "vector"] = "matrix",
    frames: Mapping[str, ModalFrame] = MappingProxyType({}),
) -> str:
    """The text of a SID of a modal body, by the relations in `derive.sid.mapping`.

    inertia: the form of J, a symmetric 3 x 3 matrix, or the column J11, J22, J33, J12, J13, J23 that some programs
    expect. frames: the frames at points by their names, whose rotation vectors are psi there; it is zero elsewhere.
    Numbers have 17 digits, so that `read` returns the same doubles; zeros are omitted. The points of the body
    become the nodes 1, 2, ...; their names and that of the body are in the first line, after the numbers of nodes and
    modes, which are all that other programs read there.
    """
    matrices = to_matrices(body)
    if inertia == "vector":
        matrices["J"] = _as_column(matrices["J"])
    return "\n".join([*_lines(body, matrices, frames), ""])


def _lines(body: ModalBody, matrices: dict[str, Taylor], frames: Mapping[str, ModalFrame]) -> Iterator[str]:
    """The lines of the text."""
    points = " ".join(point.name for point in body.points)
    stiffening = "yes" if body.second_order else "no"
    names = f"name= {body.name} ; points= {points}".rstrip()
    yield f"{len(body.points)} {body.modes} : nodes, modes; Geo_Stiff= {stiffening} ; {names}"
    yield "part"
    yield "   new modal"
    yield "      refmod"
    yield f"         mass = {fortran_number(body.mass)}"
    yield f"         nelastq = {body.modes}"
    for i in range(body.modes):
        yield f"         ielastq( {i + 1}) = Eigen Mode {i + 1} : {_frequency(body, i):.6f} Hz"
    yield "      end refmod"
    yield "      frame"
    for at, point in enumerate(body.points, 1):
        yield from _node(at, point, body.modes, frames.get(point.name))
    yield "      end frame"
    for name in MATRICES:
        yield from _taylor(name, matrices[name], body.modes, "      ")
    yield "   end modal"
    yield "end part"


def _node(at: int, point: ModalPoint, n: int, frame: ModalFrame | None) -> Iterator[str]:
    """The lines of a node; `at` is its number, n that of modes, and `frame` turns there, if one is known."""
    yield f"         new node = {at}"
    yield "            rframe = body ref"
    yield from _taylor("origin", Taylor(point.position[:, None], point.shapes.T[:, :, None]), n, "            ")
    yield from _taylor("phi", _by_modes(point.shapes, point.second), n, "            ")
    turned = (np.zeros((n, 3)), None) if frame is None else (frame.twists, frame.second_twists)
    yield from _taylor("psi", _by_modes(*turned), n, "            ")
    yield from _taylor("AP", constant_matrix(np.eye(3)), n, "            ")
    yield "         end node"


def _by_modes(first: Array, second: Array | None) -> Taylor:
    """Vectors (N, 3) of the modes with those of second order, (N, N, 3), if there are any."""
    columns = np.ascontiguousarray(first.T)
    return constant_matrix(columns) if second is None else Taylor(columns, second.transpose(2, 1, 0))


def _taylor(name: str, matrix: Taylor, n: int, indent: str) -> Iterator[str]:
    """The lines of a matrix; its zeros are omitted."""
    rows, columns = matrix.m0.shape
    yield f"{indent}{name}"
    header = {"order": matrix.order, "nrow": rows, "ncol": columns, "nq": n, "nqn": 0, "structure": matrix.structure}
    for key, value in header.items():
        yield f"{indent}   {key} = {value}"
    half = matrix.structure == SYMMETRIC
    for i, j in np.argwhere(matrix.m0):
        if not half or j <= i:
            yield f"{indent}   m0( {i + 1}, {j + 1}) = {fortran_number(matrix.m0[i, j])}"
    if matrix.m1 is not None:
        for i, k, j in np.argwhere(matrix.m1):
            if not half or j <= i:
                yield f"{indent}   m1( {i + 1}, {k + 1}, {j + 1}) = {fortran_number(matrix.m1[i, k, j])}"
    yield f"{indent}end {name}"


def fortran_number(value: float) -> str:
    """A double with 17 digits in the notation of Fortran."""
    return f"{float(value):.16E}".replace("E", "D")


def _frequency(body: ModalBody, i: int) -> float:
    """The frequency (Hz) of mode i without coupling to other modes; it is a comment of the file."""
    return math.sqrt(max(float(body.stiffness[i, i] / body.c8[i, i]), 0.0)) / (2 * math.pi)


def _as_column(matrix: Taylor) -> Taylor:
    """A symmetric 3 x 3 matrix as a column of six."""

    def column(tensor: Array) -> Array:
        return np.array([tensor[a, ..., b] for a, b in INERTIA_COLUMN])[..., None]

    assert matrix.m1 is not None
    return Taylor(column(matrix.m0), column(matrix.m1), GENERAL)
