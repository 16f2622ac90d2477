"""Products of fields over the mass: int rho f g with fields that are sums over nodes."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from derive.reduction.arithmetic import Array, gram

MOST = 4_000_000
"""Numbers multiplied at once, which bounds the memory."""


def canonical(matrix: csr_array) -> csr_array:
    """A copy in order of rows and columns, each entry once and none zero."""
    result = csr_array(matrix, dtype=np.float64, copy=True)
    result.sum_duplicates()
    result.eliminate_zeros()
    return result


def times(matrix: csr_array, columns: Array) -> Array:
    """The product of a canonical matrix and columns (n, F), summed in the order of the entries of each row."""
    rows = np.flatnonzero(np.diff(matrix.indptr))
    result = np.zeros((matrix.shape[0], columns.shape[1]))
    step = max(1, MOST // max(matrix.nnz, 1))
    for at in range(0, columns.shape[1] if rows.size else 0, step):
        terms = matrix.data[:, None] * columns[matrix.indices, at : at + step]
        result[rows, at : at + step] = np.add.reduceat(terms, matrix.indptr[rows], axis=0)
    return result


def weighted(mass: csr_array, fields: Array) -> Array:
    """The mass times fields (F, nodes, 3), as (F, nodes, 3); `mass` is canonical."""
    columns = np.ascontiguousarray(fields.transpose(1, 0, 2)).reshape(mass.shape[0], 3 * len(fields))
    result = times(mass, columns).reshape(mass.shape[0], len(fields), 3)
    return np.ascontiguousarray(result.transpose(1, 0, 2))


def products(mass: csr_array, f: Array, g: Array) -> Array:
    """int rho f_p . g_q of the fields f (F, nodes, 3) and g (G, nodes, 3)."""
    size = 3 * mass.shape[0]
    return gram(f.reshape(len(f), size), weighted(mass, g).reshape(len(g), size))


def moments(mass: csr_array, fields: Array) -> Array:
    """int rho f_p (x) f_q of fields (F, nodes, 3), as (F, F, 3, 3): every shape integral is among these."""
    scalars = np.ascontiguousarray(fields.transpose(0, 2, 1).reshape(3 * len(fields), -1))
    other = np.ascontiguousarray(weighted(mass, fields).transpose(0, 2, 1).reshape(3 * len(fields), -1))
    table = gram(scalars, other)
    count = len(fields)
    return np.ascontiguousarray(((table + table.T) / 2).reshape(count, 3, count, 3).transpose(0, 2, 1, 3))
