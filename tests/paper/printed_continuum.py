"""(1)-(3), (7)-(14) and (16)-(19), transcribed by hand. Vectors are 3 x 1, tensors 3 x 3, X are the coordinates.

An equation that sets something to zero is given as what it sets to zero. Volume and surface integrals are given by
their integrands, those of the conditions as sums over point masses.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from sympy import Expr, Matrix, Symbol


def divergence(tensor: Matrix, X: Sequence[Symbol]) -> Matrix:
    """nabla . A: the derivative of the first index."""
    return Matrix([sum(sp.diff(tensor[i, j], X[i]) for i in range(3)) for j in range(3)])


def double_dot(a: Matrix, b: Matrix) -> Expr:
    """A : B of a symmetric A."""
    return (a.T * b).trace()


def position_1(c: Matrix, Q: Matrix, X: Matrix, u: Matrix) -> Matrix:
    """(1)."""
    return c + Q * (X + u)


def difference_2(Q: Matrix, dX: Matrix, u_there: Matrix, u_here: Matrix) -> Matrix:
    """(2): dx, with u at X + dX and at X."""
    return Q * (dX + u_there - u_here)


def line_element_3(F: Matrix, dX: Matrix) -> Matrix:
    """(3): dx."""
    return F * dX


def momentum_7(T: Matrix, F: Matrix, rho: Expr, b: Matrix, xddot: Matrix, X: Sequence[Symbol]) -> Matrix:
    """(7), left side less right side."""
    return divergence(T * F.T, X) + rho * b - rho * xddot


def stress_8(E: Matrix, mu: Expr, lamda: Expr) -> Matrix:
    """(8)."""
    return 2 * mu * E + lamda * E.trace() * sp.eye(3)


def virtual_work_10(T: Matrix, F: Matrix, rho: Expr, xddot: Matrix, delta_x: Matrix, X: Sequence[Symbol]) -> Expr:
    """(10): the integrand over the volume."""
    return (divergence(T * F.T, X) - rho * xddot).dot(delta_x)


def volume_11(T: Matrix, delta_E: Matrix, rho: Expr, xddot: Matrix, delta_x: Matrix) -> Expr:
    """(11): the integrand over the volume, left side."""
    return double_dot(T, delta_E) + rho * xddot.dot(delta_x)


def surface_11(T: Matrix, F: Matrix, n: Matrix, delta_x: Matrix) -> Expr:
    """(11): the integrand over the surface, right side."""
    return (F * T * n).dot(delta_x)


def load_12(T: Matrix, F: Matrix, n: Matrix) -> Matrix:
    """(12): the load per unit of undeformed area."""
    return F * T * n


def volume_13(E: Matrix, delta_E: Matrix, mu: Expr, lamda: Expr, rho: Expr, xddot: Matrix, delta_x: Matrix) -> Expr:
    """(13): the integrand over the volume."""
    return double_dot(2 * mu * E + lamda * E.trace() * sp.eye(3), delta_E) + rho * xddot.dot(delta_x)


def displacement_14(alpha: Sequence[Expr], Phi: Sequence[Matrix]) -> Matrix:
    """(14)."""
    return sum((a * shape for a, shape in zip(alpha, Phi, strict=True)), sp.zeros(3, 1))


def held_16(shape_there: Matrix) -> Matrix:
    """(16): a shape at P_c."""
    return shape_there


def mean_displacement_17(masses: Sequence[Expr], shape: Sequence[Matrix]) -> Matrix:
    """(17): the mean of a shape over the mass."""
    return sum((m * f for m, f in zip(masses, shape, strict=True)), sp.zeros(3, 1)) / sum(masses)


def rotation_18(chi: Expr, e: Matrix, X: Matrix) -> Matrix:
    """(18)."""
    return chi * e.cross(X)


def mean_rotation_19(masses: Sequence[Expr], X: Sequence[Matrix], shape: Sequence[Matrix]) -> Matrix:
    """(19)."""
    return sum((m * x.cross(f) for m, x, f in zip(masses, X, shape, strict=True)), sp.zeros(3, 1))
