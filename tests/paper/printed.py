"""The printed equations of Koppens, Sauren, Veldpaus and van Campen (1988), transcribed by hand.

Nothing here is derived and nothing here imports the package: this is what its results are compared with.
The available text of the paper has lost most of its dots; they are restored here, and
`test_printed_against_brute_force` shows that with them the equations are right.
Numbers in names are the paper's equation numbers.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import sympy
from sympy import Rational, cos, sin

ROWS = ("c1", "c2", "phi", "alpha1", "alpha2")
"""The virtual displacements whose coefficients are printed in (33) and (41), in the paper's order."""

m, l, EI = sympy.symbols("m l EI")  # noqa: E741 - the paper's letters
c1, c2, phi, alpha1, alpha2 = sympy.symbols("c1 c2 phi alpha1 alpha2")
c1dot, c2dot, phidot, alpha1dot, alpha2dot = sympy.symbols("c1dot c2dot phidot alpha1dot alpha2dot")
c1ddot, c2ddot, phiddot, alpha1ddot, alpha2ddot = sympy.symbols("c1ddot c2ddot phiddot alpha1ddot alpha2ddot")
xi = sympy.Symbol("xi")
a0, a1, a2, a3 = sympy.symbols("a0 a1 a2 a3")


@dataclass(frozen=True)
class PrintedTerm:
    """One term of one row, so that a test can leave out, or turn the sign of, each term by itself."""

    row: str
    expr: sympy.Expr


def row_sum(terms: Iterable[PrintedTerm], row: str) -> sympy.Expr:
    """The coefficient of one virtual displacement: the sum of its terms."""
    return sympy.Add(*(term.expr for term in terms if term.row == row))


# Common factors (m, m/5, 1/3, ...) are multiplied into the terms they stand before; otherwise the terms are
# as printed, in the order of printing.

EQUATION_33: tuple[PrintedTerm, ...] = (
    PrintedTerm("c1", m * c1ddot),
    PrintedTerm("c1", -m * alpha1 * phiddot * cos(phi) / 3),
    PrintedTerm("c1", m * alpha1 * phidot**2 * sin(phi) / 3),
    PrintedTerm("c1", -2 * m * phidot * alpha1dot * cos(phi) / 3),
    PrintedTerm("c1", -m * alpha1ddot * sin(phi) / 3),
    PrintedTerm("c2", m * c2ddot),
    PrintedTerm("c2", -m * alpha1 * phiddot * sin(phi) / 3),
    PrintedTerm("c2", -m * alpha1 * phidot**2 * cos(phi) / 3),
    PrintedTerm("c2", -2 * m * phidot * alpha1dot * sin(phi) / 3),
    PrintedTerm("c2", m * alpha1ddot * cos(phi) / 3),
    PrintedTerm("phi", -m * alpha1 * c1ddot * cos(phi) / 3),
    PrintedTerm("phi", -m * alpha1 * c2ddot * sin(phi) / 3),
    PrintedTerm("phi", m * phiddot * l**2 / 12),
    PrintedTerm("phi", m * phiddot * alpha1**2 / 5),
    PrintedTerm("phi", m * phiddot * alpha2**2 / 7),
    PrintedTerm("phi", 2 * m * phidot * alpha1 * alpha1dot / 5),
    PrintedTerm("phi", 2 * m * phidot * alpha2 * alpha2dot / 7),
    PrintedTerm("phi", m * l * alpha2ddot / 10),
    PrintedTerm("alpha1", -m * c1ddot * sin(phi) / 3),
    PrintedTerm("alpha1", m * c2ddot * cos(phi) / 3),
    PrintedTerm("alpha1", -m * phidot**2 * alpha1 / 5),
    PrintedTerm("alpha1", m * alpha1ddot / 5),
    PrintedTerm("alpha1", 64 * alpha1 * EI / l**3),
    PrintedTerm("alpha2", m * l * phiddot / 10),
    PrintedTerm("alpha2", -m * phidot**2 * alpha2 / 7),
    PrintedTerm("alpha2", m * alpha2ddot / 7),
    PrintedTerm("alpha2", 192 * alpha2 * EI / l**3),
)
"""Conditions on a selected material point, shapes (31) and (32)."""

EQUATION_41: tuple[PrintedTerm, ...] = (
    PrintedTerm("c1", m * c1ddot),
    PrintedTerm("c2", m * c2ddot),
    PrintedTerm("phi", m * phiddot * l**2 / 12),
    PrintedTerm("phi", m * phiddot * alpha1**2 / 5),
    PrintedTerm("phi", m * phiddot * alpha2**2 / 7),
    PrintedTerm("phi", 2 * m * phidot * alpha1 * alpha1dot / 5),
    PrintedTerm("phi", 2 * m * phidot * alpha2 * alpha2dot / 7),
    PrintedTerm("alpha1", m * alpha1ddot / 5),
    PrintedTerm("alpha1", -m * phidot**2 * alpha1 / 5),
    PrintedTerm("alpha1", 144 * alpha1 * EI / l**3),
    PrintedTerm("alpha2", m * alpha2ddot / 7),
    PrintedTerm("alpha2", -m * phidot**2 * alpha2 / 7),
    PrintedTerm("alpha2", 1200 * alpha2 * EI / l**3),
)
"""Conditions on mean displacements, shapes (39) and (40)."""


# The beam: ansatz, conditions, shapes, strain energy, rotation.

DISPLACEMENT_21 = a0 + a1 * xi + a2 * xi**2 + a3 * xi**3

# A condition is given as the expression that it sets to zero.
CONDITION_28 = a0
CONDITION_29 = a1
CONDITION_35 = 3 * a0 + a2
CONDITION_37 = 5 * a1 + 3 * a3

SHAPE_31 = xi**2
SHAPE_32 = xi**3
SHAPE_39 = Rational(1, 2) * (-1 + 3 * xi**2)
SHAPE_40 = Rational(1, 2) * (-3 * xi + 5 * xi**3)

POINT_SHAPES = (SHAPE_31, SHAPE_32)
MEAN_SHAPES = (SHAPE_39, SHAPE_40)

ROTATION_26 = sympy.Matrix([[cos(phi), -sin(phi), 0], [sin(phi), cos(phi), 0], [0, 0, 1]])


def displacement_30(shape1: sympy.Expr, shape2: sympy.Expr) -> sympy.Expr:
    """(30): the displacement free of rigid motion."""
    return alpha1 * shape1 + alpha2 * shape2


def displacement_38(shape1: sympy.Expr, shape2: sympy.Expr) -> sympy.Expr:
    """(38): the same line as (30)."""
    return alpha1 * shape1 + alpha2 * shape2


TRANSLATION_23 = sympy.Matrix([c1, c2, 0])
POSITION_24 = sympy.Matrix([Rational(1, 2) * xi * l, 0, 0])


def displacement_25(v: sympy.Expr) -> sympy.Matrix:
    """(25): u for a lateral displacement v."""
    return sympy.Matrix([0, v, 0])


def axial_27(rate: sympy.Expr) -> sympy.Matrix:
    """(27): omega for the rate of phi, delta pi for its variation."""
    return sympy.Matrix([0, 0, rate])


def strain_energy_22(v: sympy.Expr) -> sympy.Expr:
    """(22): the strain energy of the beam for a lateral displacement v, a polynomial in xi."""
    return 4 * EI / l**3 * sympy.integrate(sympy.expand(sympy.diff(v, xi, 2) ** 2), (xi, -1, 1))


def mean_displacement_34(v: sympy.Expr) -> sympy.Expr:
    """(34): what has to vanish for the center of mass not to be displaced."""
    return sympy.integrate(sympy.expand(v), (xi, -1, 1))


def mean_rotation_36(v: sympy.Expr) -> sympy.Expr:
    """(36): what has to vanish for u and X to be on a mean parallel."""
    return sympy.integrate(sympy.expand(xi * v), (xi, -1, 1))


# The body in three dimensions. Vectors are 3 x 1, tensors 3 x 3; r stands for X + u.


def deformation_4(Q: sympy.Matrix, gradient: sympy.Matrix) -> sympy.Matrix:
    """(4): F from the rotation and from nabla u, whose entry (i, j) is the derivative of u_j by X_i."""
    return Q * (sympy.eye(3) + gradient.T)


def acceleration_5(
    cddot: sympy.Matrix,
    Q: sympy.Matrix,
    omega: sympy.Matrix,
    omegadot: sympy.Matrix,
    r: sympy.Matrix,
    udot: sympy.Matrix,
    uddot: sympy.Matrix,
) -> sympy.Matrix:
    """(5): the acceleration of a material point; omega and omegadot in the body base."""
    return cddot + Q * (omega.cross(omega.cross(r)) + omegadot.cross(r) + 2 * omega.cross(udot) + uddot)


def virtual_displacement_6(
    delta_c: sympy.Matrix, Q: sympy.Matrix, delta_pi: sympy.Matrix, r: sympy.Matrix, delta_u: sympy.Matrix
) -> sympy.Matrix:
    """(6): the virtual displacement of a material point (the printed text puts two dots too many on it)."""
    return delta_c + Q * (delta_pi.cross(r) + delta_u)


def green_lagrange_9(F: sympy.Matrix) -> sympy.Matrix:
    """(9): the Green-Lagrange strain."""
    return (F.T * F - sympy.eye(3)) / 2
