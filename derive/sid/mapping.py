"""The matrices of a SID out of the shape integrals of a modal body, and back.

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

Gr and Ge hold the blocks of l = 1, 2, ... side by side. A SID holds J to the first order in a, and by custom Gr to the
zeroth. **Nothing is lost by that**: C4 is half of Gr; C5_ij has its symmetric part in the first order of Oe, and its
antisymmetric part is c7, which is in Ge (and again in the first order of Cr). Data that occurs twice is compared on
reading. (A program that uses J and Gr unchanged lacks the terms of second order in them, all the same.)

Not in a SID: the reasons of zeros (on reading, what is exactly zero is taken as zero by structure, and the reason is
the file), and the description of the body. Not in a modal body, and refused if it is in a file: stresses of the
reference (ksigma), geometric stiffness (in the first order of Ct, of phi and of Oe; that in Oe shows, because without
it -trace of the first order of Oe is 2 Me), and nodes with rotated frames (AP). Rotations of nodes (psi) are
written as zeros and skipped on reading.
"""

from __future__ import annotations

import numpy as np

from derive.mechanics.bodies.modal_body import ModalBody
from derive.sid.taylor import SYMMETRIC, Array, Taylor, constant

MATRICES = ("mdCM", "J", "Ct", "Cr", "Me", "Gr", "Ge", "Oe", "ksigma", "Ke", "De")
"""The matrices of the whole body, in the order of a SID."""

SQUARES = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
"""The components of omega that Omega holds the products of."""

VECTOR = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""The entries of J, where it is written as a column of six."""


def to_matrices(body: ModalBody) -> dict[str, Taylor]:
    """The matrices of a SID."""
    n = body.modes
    s5 = symmetric_parts(body.C5, body.c7)
    inertia = np.stack([2 * part for part in symmetric_parts(body.C4, -body.c6)]) if n else np.zeros((0, 3, 3))
    return {
        "mdCM": Taylor(body.c1[:, None], body.c2.T[:, :, None].copy()),
        "J": Taylor(body.C3, inertia.transpose(1, 0, 2).copy(), SYMMETRIC),
        "Ct": constant(body.c2),
        "Cr": Taylor(body.c6, -body.c7),
        "Me": constant(body.c8, SYMMETRIC),
        "Gr": constant(np.concatenate([*(2 * body.C4), np.zeros((3, 0))], axis=1)),
        "Ge": constant((-2 * body.c7).reshape(n, 3 * n)),
        "Oe": Taylor(to_squares(symmetric_parts(body.C4, -body.c6)), to_squares(s5)),
        "ksigma": constant(np.zeros((n, 1))),
        "Ke": constant(body.stiffness, SYMMETRIC),
        "De": constant(body.damping, SYMMETRIC),
    }


def symmetric_parts(tensors: Array, axial: Array) -> Array:
    """Symmetric parts S of tensors (..., 3, 3), with `axial` the c of S - e c / 2.

    (t + t^T) / 2 rounds; of the doubles beside it that one is taken which gives both halves back to the last bit.
    """
    result = (tensors + np.swapaxes(tensors, -1, -2)) / 2
    for a, b, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        first, second, half = tensors[..., a, b], tensors[..., b, a], axial[..., k] / 2
        best = result[..., a, b]
        for candidate in (first + half, second - half):
            exact = (candidate - half == first) & (candidate + half == second)
            best = np.where(exact, candidate, best)
        result[..., a, b] = result[..., b, a] = best
    return np.asarray(result)


def with_axial(parts: Array, axial: Array) -> Array:
    """Tensors S - e c / 2 of their symmetric parts S and of c."""
    result = np.array(parts)
    for a, b, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        result[..., a, b] -= axial[..., k] / 2
        result[..., b, a] += axial[..., k] / 2
    return result


def to_squares(parts: Array) -> Array:
    """Symmetric tensors (..., 3, 3) as factors of Omega, (..., 6)."""
    columns = [-parts[..., a, b] * (1 if a == b else 2) for a, b in SQUARES]
    return np.asarray(np.stack(columns, axis=-1)) + 0.0


def from_squares(columns: Array, products: tuple[tuple[int, int], ...] = SQUARES) -> Array:
    """Factors of Omega, (..., 6), as symmetric tensors."""
    result = np.zeros((*columns.shape[:-1], 3, 3))
    for at, (a, b) in enumerate(products):
        result[..., a, b] = result[..., b, a] = -columns[..., at] / (1 if a == b else 2)
    return result + 0.0
