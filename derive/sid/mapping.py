"""The conversion of the shape integrals of a modal body to the matrices of a SID, and its inverse.

The equations of motion of a SID, in the frame of the body, with r = X + sum a_k Phi_k and g the acceleration of O:

    m g     + mdCM~^T omegadot + Ct^T addot + 2 omega~ Ct^T adot                    + omega~ omega~ mdCM    = forces
    mdCM~ g + J omegadot       + Cr^T addot + sum_l Gr_l adot_l omega               + omega~ J omega        = moments
    Ct g    + Cr omegadot      + Me addot   + sum_l Ge_l adot_l omega + Oe Omega    + ksigma + Ke a + De adot = modal

with Omega = (w1^2, w2^2, w3^2, w1 w2, w2 w3, w1 w3). Comparing these with int rho {1, r x, Phi_i .} xddot, where
xddot = g + omegadot x r + omega x (omega x r) + 2 omega x rdot + rddot, gives each matrix:

    mdCM   = int rho r                  = c1 + sum_k a_k c2_k
    J      = int rho {(r.r) I - r r}    = C3 + sum_k a_k (C4_k + C4_k^T)          (+ sum a_i a_j C5_ij, not written)
    Ct_i   = int rho Phi_i              = c2_i
    Cr_i   = int rho r x Phi_i          = c6_i - sum_k c7_ik a_k
    Me_ij  = int rho Phi_i . Phi_j      = c8_ij
    Gr_l   = 2 int rho {(Phi_l.r) I - Phi_l r}  = 2 C4_l                          (+ 2 sum a_k C5_lk, not written)
    Ge_l,i = 2 int rho Phi_l x Phi_i    = -2 c7_il
    Oe_i   : Oe_i Omega = int rho Phi_i . (omega x (omega x r)) = -omega . D2_i omega, D2_i = C4_i + sum_k a_k C5_ik:
             (-S_11, -S_22, -S_33, -2 S_12, -2 S_23, -2 S_13) of the symmetric part S of D2_i, in m0 and in m1

Gr and Ge consist of the blocks l = 1, 2, ... side by side. A SID contains J to the first order in a, and by convention
Gr to the zeroth. Nothing is lost by that: C4 is half of Gr; the symmetric part of C5_ij is in the first order of Oe,
and its antisymmetric part is c7, which is in Ge (and again in the first order of Cr). `read` compares data that occurs
twice. (A program that uses J and Gr as they are nevertheless lacks their terms of second order.)

A body of second order (`derive.reduction.second_order`) has the further moments c9_ij = int rho Psi_ij and c10_ij =
int rho X x Psi_ij, and C5 contains those of X and Psi_ij. Its geometric stiffness is in the first orders:

    Ct_i   = c2_i + sum_k a_k c9_ik                             K0t = c9
    Cr_i   = c6_i + sum_k a_k (c10_ik - c7_ik)                  K0r = c10
    Oe_i   : as above, with all of C5                           K0omega is the part of X and Psi_ij
    phi_i  = Phi_i + sum_k a_k Psi_ik at a node                 K0F = -Psi

A SID contains mdCM and J to the first order in a; those of second order (1/2 sum a_i a_j c9_ij, and C5) follow from
this.

A SID contains neither the reasons of zeros nor the description of a body. `read` treats values that are exactly zero
as structural zeros, with the file as the reason. It refuses data that a modal body cannot represent, namely stresses
of the reference configuration (ksigma) and nodes with rotated frames (AP), and warns of data that it does not use, such
as rotations of nodes (psi) and with them K0M. `write` writes psi of markers of scenes, the first order of which is the
second one of their rotation vectors, and zeros of other points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from derive.mechanics.bodies.modal_body import ModalBody
from derive.reduction.integrals import omega_factors

Array = NDArray[np.float64]

AGREEMENT = 1e-4
"""Relative tolerance for quantities that a SID contains twice, since programs round their output."""

ZERO, DIAGONAL, SYMMETRIC, GENERAL, UNIT = range(5)
"""The values of `structure`. Only the lower triangle of a symmetric matrix is written."""


MATRICES = ("mdCM", "J", "Ct", "Cr", "Me", "Gr", "Ge", "Oe", "ksigma", "Ke", "De")
"""The matrices of the whole body, in the order of a SID."""

INERTIA_COLUMN = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""The entries of J if it is written as a column of six."""


@dataclass(frozen=True, eq=False)
class Taylor:
    """A matrix m0 + sum_k a_k m1_k that is linear in the modal coordinates a.

    m0: (rows, columns). m1: (rows, modes, columns), or None if the matrix is constant. structure: as in a SID.
    """

    m0: Array
    m1: Array | None = None
    structure: int = GENERAL

    @property
    def order(self) -> int:
        """The highest power of a."""
        return 0 if self.m1 is None else 1


Matrices = dict[str, Taylor]
"""The matrices of a body by their names."""


def constant_matrix(m0: Array, structure: int = GENERAL) -> Taylor:
    """A constant matrix; its structure is ZERO if all of its entries are zero."""
    return Taylor(m0, None, structure if np.any(m0) else ZERO)


def to_matrices(body: ModalBody) -> dict[str, Taylor]:
    """The matrices of a SID by name: those of MATRICES for a modal body."""
    n = body.modes
    s5 = symmetric_parts(body.C5, body.c7)
    inertia = np.stack([2 * part for part in symmetric_parts(body.C4, -body.c6)]) if n else np.zeros((0, 3, 3))
    return {
        "mdCM": Taylor(body.c1[:, None], body.c2.T[:, :, None].copy()),
        "J": Taylor(body.C3, inertia.transpose(1, 0, 2).copy(), SYMMETRIC),
        "Ct": constant_matrix(body.c2) if body.c9 is None else Taylor(body.c2, body.c9),
        "Cr": Taylor(body.c6, -body.c7 if body.c10 is None else body.c10 - body.c7),
        "Me": constant_matrix(body.c8, SYMMETRIC),
        "Gr": constant_matrix(np.concatenate([*(2 * body.C4), np.zeros((3, 0))], axis=1)),
        "Ge": constant_matrix((-2 * body.c7).reshape(n, 3 * n)),
        "Oe": Taylor(omega_factors(symmetric_parts(body.C4, -body.c6)), omega_factors(s5)),
        "ksigma": constant_matrix(np.zeros((n, 1))),
        "Ke": constant_matrix(body.stiffness, SYMMETRIC),
        "De": constant_matrix(body.damping, SYMMETRIC),
    }


def closest_symmetric(tables: Array, odd: Array) -> Array:
    """The part of tables (N, N, 3) that is symmetric in the modes, where `odd` is the antisymmetric part.

    The result consists of doubles next to the mean that reproduce both halves to the last bit, if there are any.
    """
    other = np.swapaxes(tables, 0, 1)
    result = mean = (tables + other) / 2
    for near in (mean, tables - odd, other + odd):
        for candidate in _neighbours(near):
            result = np.where((candidate + odd == tables) & (candidate - odd == other), candidate, result)
    upper = np.triu(np.ones(tables.shape[:2], dtype=bool))[:, :, None]
    return np.asarray(np.where(upper, result, np.swapaxes(result, 0, 1))) + 0.0


def _neighbours(values: Array) -> tuple[Array, Array, Array]:
    """The doubles next to values on both sides, and the values, which are preferred because they come last."""
    return np.nextafter(values, -np.inf), np.nextafter(values, np.inf), values


def symmetric_parts(tensors: Array, axial: Array) -> Array:
    """The symmetric parts S (..., 3, 3) of tensors S - e c / 2 with axial vectors c (..., 3).

    Because (t + t^T) / 2 rounds, the result is the double next to it that reproduces both halves to the last bit, if
    there is one.
    """
    result = (tensors + np.swapaxes(tensors, -1, -2)) / 2
    for a, b, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        first, second, half = tensors[..., a, b], tensors[..., b, a], axial[..., k] / 2
        best = result[..., a, b]
        for candidate in (*_neighbours(best), *_neighbours(first + half), *_neighbours(second - half)):
            exact = (candidate - half == first) & (candidate + half == second)
            best = np.where(exact, candidate, best)
        result[..., a, b] = result[..., b, a] = best
    return np.asarray(result)


def with_axial(parts: Array, axial: Array) -> Array:
    """The tensors S - e c / 2 (..., 3, 3) of symmetric parts S (..., 3, 3) and axial vectors c (..., 3)."""
    result = np.array(parts)
    for a, b, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        result[..., a, b] -= axial[..., k] / 2
        result[..., b, a] += axial[..., k] / 2
    return result
