"""Checks of matrices of a body of nodes: size, symmetry, and equality of the mass along x, y and z."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, diags_array

from derive.spec.files.node_files import Array
from derive.spec.parsing.values import WrongValueError

NEARLY = 1e-10
"""The largest difference that counts as rounding, relative to the largest entry."""


class Entries(NamedTuple):
    """The entries of a matrix whose size is to be determined."""

    row: NDArray[np.int64]
    col: NDArray[np.int64]
    value: NDArray[np.float64]


def misfit(shape: tuple[int, ...], n: int, *fits: str) -> WrongValueError:
    """The error of an array with a shape that does not fit; `fits` are the admissible ones."""
    wanted = " or ".join([", ".join(fits[:-1]), fits[-1]] if fits[1:] else fits)
    return WrongValueError(f"the shape is {shape}, and that of `positions` ({n}, 3): {wanted} is needed")


def square(array: Array, sizes: tuple[int, ...], n: int, *fits: str) -> csr_array:
    """A square matrix of one of the sizes."""
    if not isinstance(array, Entries):
        if array.shape not in [(size, size) for size in sizes]:
            raise misfit(array.shape, n, *fits)
        return csr_array(array)
    indices = np.concatenate([array.row, array.col])
    least, most = (int(indices.min()), int(indices.max())) if indices.size else (0, 0)
    size = next((size for size in sizes if most < size), None)
    if least < 0 or size is None or (least > 0 and most in sizes):
        hint = "; these seem to be numbered from 1" if least > 0 and most in sizes else ""
        last = sizes[-1] - 1
        raise WrongValueError(
            f"the entries are in rows and columns {least} to {most}, and those of {n} nodes are 0 to {last}{hint}"
        )
    return _completed(csr_array((array.value, (array.row, array.col)), shape=(size, size)))


def _completed(matrix: csr_array) -> csr_array:
    """A full symmetric matrix from one that may have a single triangle."""
    if not _is_triangle(matrix):
        return matrix
    return csr_array(matrix + matrix.T - diags_array(matrix.diagonal()))


def _is_triangle(matrix: csr_array) -> bool:
    entries = coo_array(matrix)
    below, above = (entries.row > entries.col).any(), (entries.row < entries.col).any()
    return bool(below != above)


def symmetric(matrix: csr_array) -> csr_array:
    """The symmetric part of a matrix. Raises WrongValueError if its asymmetry is larger than rounding."""
    gap = coo_array(abs(matrix - matrix.T))
    largest = float(abs(matrix).max())
    if gap.nnz and gap.data.max() > NEARLY * largest:
        worst = int(gap.data.argmax())
        i, j = sorted((int(gap.row[worst]), int(gap.col[worst])))
        hint = (
            "only one triangle is filled: fill both, or write `symmetric` in the first line of a MatrixMarket file"
            if _is_triangle(matrix)
            else "a symmetric matrix is needed"
        )
        raise WrongValueError(
            f"the matrix is not symmetric: the entries ({i}, {j}) and ({j}, {i}) differ by "
            f"{gap.data[worst] / largest:.1e} of the largest entry; {hint}"
        )
    return csr_array((matrix + matrix.T) / 2) if gap.nnz and gap.data.max() else matrix


def of_nodes(matrix: csr_array) -> csr_array:
    """The matrix m of a mass matrix m (x) I3."""
    entries = coo_array(matrix)
    n = matrix.shape[0] // 3
    limit = NEARLY * float(np.abs(entries.data).max(initial=0))
    across = (entries.row % 3 != entries.col % 3) & (np.abs(entries.data) > limit)
    if across.any():
        i, j = (int(index[across.argmax()]) for index in (entries.row, entries.col))
        raise WrongValueError(
            f"the entry ({i}, {j}) couples two directions; a mass matrix of nodes couples x with x, y with y "
            "and z with z, all alike: leave out rotational inertia"
        )
    parts = []
    for axis in range(3):
        of_axis = (entries.row % 3 == axis) & (entries.col % 3 == axis)
        row, col = entries.row[of_axis] // 3, entries.col[of_axis] // 3
        parts.append(csr_array((entries.data[of_axis], (row, col)), shape=(n, n)))
    for axis in (1, 2):
        gap = coo_array(abs(parts[axis] - parts[0]))
        if gap.nnz and gap.data.max() > limit:
            i, j = (int(index[gap.data.argmax()]) for index in (gap.row, gap.col))
            raise WrongValueError(
                f"of nodes {i} and {j}, the mass in {'xyz'[axis]} is not that in x; a node has one mass, the same in "
                "all directions"
            )
    return parts[0]
