"""Integrals over the mass of a body: inner products and moments of fields, and the shape integrals c1 .. c8.

A field is given by its values at the nodes, (nodes, 3). With the mass matrix m_kl of the nodes, int rho f g is the sum
of f_k m_kl g_l over all nodes k and l.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from derive.reduction.arithmetic import Array, inner_products, pairwise_sum

MAX_TERMS = 4_000_000
"""The number of products that are formed at once, which limits the memory."""

OMEGA_PRODUCTS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
"""The pairs of components of omega whose products form Omega = (w1^2, w2^2, w3^2, w1 w2, w2 w3, w1 w3)."""


@dataclass(frozen=True, eq=False)
class Integrals:
    """The shape integrals of the appendix, with the shapes of `ModalBody`.

    C4 and C5 are represented by their symmetric parts S4 (N, 3, 3) and S5 (N, N, 3, 3), because c6 and c7 are their
    antisymmetric parts. c9, c10 (N, N, 3): integrals of second-order fields, of which S5 then contains a part as well.
    """

    mass: float
    c1: Array
    c2: Array
    C3: Array
    S4: Array
    S5: Array
    c6: Array
    c7: Array
    c8: Array
    c9: Array | None = None
    c10: Array | None = None


def shape_integrals(mass: csr_array, x: Array, phi: Array) -> Integrals:
    """The shape integrals of a body with positions x (nodes, 3), m, and modes phi (N, nodes, 3), by the appendix."""
    fields = np.concatenate([x[None], phi])
    linear = np.array([pairwise_sum(field) for field in mass_times(mass, fields)])
    return integrals_of(float(pairwise_sum(mass.data)), linear, second_moments(mass, fields))


def integrals_of(mass: float, linear: Array, second: Array) -> Integrals:
    """The shape integrals from moments of X and the modes: int rho f_p (F, 3), and int rho f_p (x) f_q (F, F, 3, 3)."""
    trace = second[..., 0, 0] + second[..., 1, 1] + second[..., 2, 2]
    tensor = trace[..., None, None] * np.eye(3) - (second + np.swapaxes(second, -1, -2)) / 2
    axial = np.stack([second[..., a, b] - second[..., b, a] for a, b in ((1, 2), (2, 0), (0, 1))], axis=-1)
    return Integrals(
        mass=mass,
        c1=linear[0],
        c2=linear[1:],
        C3=tensor[0, 0],
        S4=tensor[1:, 0],
        S5=tensor[1:, 1:],
        c6=axial[0, 1:],
        c7=axial[1:, 1:],
        c8=trace[1:, 1:],
    )


def antisymmetric(axial: Array) -> Array:
    """The tensors e_abk v_k / 2 of vectors v (..., 3): the antisymmetric parts of C4 (v = c6) and of C5 (v = -c7)."""
    result = np.zeros((*axial.shape[:-1], 3, 3))
    for a, b, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        result[..., a, b] = axial[..., k] / 2
        result[..., b, a] = -axial[..., k] / 2
    return result


def canonical_csr(matrix: csr_array) -> csr_array:
    """A copy in canonical form: entries sorted by row and column, without duplicates and explicit zeros."""
    result = csr_array(matrix, dtype=np.float64, copy=True)
    result.sum_duplicates()
    result.eliminate_zeros()
    return result


def csr_product(matrix: csr_array, columns: Array) -> Array:
    """The product of a canonical matrix (m, n) and columns (n, F), summed in the order of the entries of each row."""
    rows = np.flatnonzero(np.diff(matrix.indptr))
    result = np.zeros((matrix.shape[0], columns.shape[1]))
    step = max(1, MAX_TERMS // max(matrix.nnz, 1))
    for at in range(0, columns.shape[1] if rows.size else 0, step):
        terms = matrix.data[:, None] * columns[matrix.indices, at : at + step]
        result[rows, at : at + step] = np.add.reduceat(terms, matrix.indptr[rows], axis=0)
    return result


def mass_times(mass: csr_array, fields: Array) -> Array:
    """The products (F, nodes, 3) of a canonical mass matrix and fields (F, nodes, 3)."""
    columns = np.ascontiguousarray(fields.transpose(1, 0, 2)).reshape(mass.shape[0], 3 * len(fields))
    result = csr_product(mass, columns).reshape(mass.shape[0], len(fields), 3)
    return np.ascontiguousarray(result.transpose(1, 0, 2))


def mass_products(mass: csr_array, f: Array, g: Array) -> Array:
    """The inner products (F, G) int rho f_p . g_q of fields f (F, nodes, 3) and g (G, nodes, 3)."""
    size = 3 * mass.shape[0]
    return inner_products(f.reshape(len(f), size), mass_times(mass, g).reshape(len(g), size))


def second_moments(mass: csr_array, fields: Array) -> Array:
    """The moments (F, F, 3, 3) int rho f_p (x) f_q of fields (F, nodes, 3), from which C3 to c8 follow."""
    scalars = np.ascontiguousarray(fields.transpose(0, 2, 1).reshape(3 * len(fields), -1))
    other = np.ascontiguousarray(mass_times(mass, fields).transpose(0, 2, 1).reshape(3 * len(fields), -1))
    table = inner_products(scalars, other)
    count = len(fields)
    return np.ascontiguousarray(((table + table.T) / 2).reshape(count, 3, count, 3).transpose(0, 2, 1, 3))


def omega_factors(parts: Array) -> Array:
    """The factors (..., 6) of Omega in -omega . T omega, for symmetric tensors T (..., 3, 3)."""
    columns = [-parts[..., a, b] * (1 if a == b else 2) for a, b in OMEGA_PRODUCTS]
    return np.asarray(np.stack(columns, axis=-1)) + 0.0


def omega_tensors(columns: Array, products: tuple[tuple[int, int], ...] = OMEGA_PRODUCTS) -> Array:
    """The symmetric tensors (..., 3, 3) that factors (..., 6) of Omega represent; `products` is the order of Omega."""
    result = np.zeros((*columns.shape[:-1], 3, 3))
    for at, (a, b) in enumerate(products):
        result[..., a, b] = result[..., b, a] = -columns[..., at] / (1 if a == b else 2)
    return result + 0.0
