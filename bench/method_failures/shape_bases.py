"""Shapes that make the mass matrix of a beam singular, or nearly so: many monomials, and rigid motion left in them.

c8 of monomials is a Gram matrix like that of Hilbert, whose condition number grows exponentially with the number of
shapes; that of Legendre polynomials, c8 = m / (2 n + 1), is diagonal. It is the orthogonal shapes that make the
difference: without them c8 in the mean frame is the same matrix. The entries are exact rationals.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

import mpmath
import numpy as np
import sympy as sp
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from derive.mechanics.bodies.beam_functions import ONE, XI, BeamFunction, polynomial
from derive.mechanics.bodies.reference_conditions import ConditionError, assumed_shapes
from derive.runtime.native_call import Matrix
from derive.spec.model.beam_parts import AssumedDeflection, Frame, Polynomial

MOST = 20
"""The largest number of shapes."""
DIGITS = 40
"""The decimal digits of eigenvalues."""


@dataclass(frozen=True)
class BasisCondition:
    """The condition of c8 of `count` monomials in the point frame, and of Legendre polynomials in the mean frame.

    monomials, legendre: condition numbers. error_monomials, error_legendre: the largest relative error of a solution of
    c8 x = b by the Cholesky factorisation in double precision, where x is all ones; infinite if c8 is not definite.
    """

    count: int
    monomials: float
    legendre: float
    error_monomials: float
    error_legendre: float


def basis_conditions(most: int = MOST) -> tuple[BasisCondition, ...]:
    """The condition of c8 for 2 to `most` shapes."""
    result = []
    for count in range(2, most + 1):
        point, mean = gram(shapes(count, "point")), gram(shapes(count, "mean"))
        conditions = exact_condition(point), exact_condition(mean)
        result.append(BasisCondition(count, *conditions, solution_error(point), solution_error(mean)))
    return tuple(result)


def shapes(count: int, frame: Literal["point", "mean"]) -> tuple[BeamFunction, ...]:
    """The shapes that `count` + 2 monomials leave in a frame: monomials in "point", Legendre polynomials in "mean"."""
    at = Fraction(0) if frame == "point" else None
    return assumed_shapes(AssumedDeflection(monomials(count + 1), Frame(frame, at), orthogonal=frame == "mean"))


def monomials(degree: int) -> tuple[Polynomial, ...]:
    """The coefficients of 1, xi, ..., xi^degree."""
    return tuple(tuple(Fraction(int(i == n)) for i in range(n + 1)) for n in range(degree + 1))


def gram(fields: tuple[BeamFunction, ...]) -> list[list[Fraction]]:
    """The mean products of functions of xi (n, n): c8 over the mass, if they are shapes."""
    return [[Fraction((a * b).integral()) / 2 for b in fields] for a in fields]


def exact_condition(entries: list[list[Fraction]]) -> float:
    """The ratio of the largest and the smallest eigenvalue of a positive definite matrix of rationals."""
    with mpmath.workdps(DIGITS):
        matrix = mpmath.matrix([[mpmath.mpf(x.numerator) / x.denominator for x in row] for row in entries])
        values = mpmath.eigsy(matrix, eigvals_only=True)
        return float(max(values) / min(values))


def solution_error(entries: list[list[Fraction]]) -> float:
    """The largest error of the solution of c8 x = b, whose elements are all 1, by Cholesky in double precision."""
    matrix = np.array([[float(x) for x in row] for row in entries])
    right = np.array([float(sum(row)) for row in entries])
    try:
        return float(np.abs(cho_solve(cho_factor(matrix), right) - 1).max())
    except LinAlgError:
        return float("inf")


DEFORMED = 1e-2
"""The amplitude, over the length, of the shapes xi^2 and xi^3 with which the mass matrix is examined."""
SINGULAR = 1e-12
"""Eigenvalues of M below this, relative to the largest, are zero."""
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)


@dataclass(frozen=True)
class RigidMotionLeft:
    """The mass matrix M of a beam with all four monomials of (21), from which no frame takes the rigid motion.

    rank, fields: of the exact Gram matrix of translation, rotation and the shapes, and their number. unknowns: the size
    of M. at_rest, deformed: the numerical rank of M undeformed, and with both xi^2 and xi^3 deformed by alpha. slope:
    the smallest eigenvalue of the deformed M that is not zero, over m alpha^2, with alpha over the length. error: the
    message of the error for such shapes.
    """

    rank: int
    fields: int
    unknowns: int
    at_rest: int
    deformed: int
    slope: float
    error: str


def rigid_motion_left() -> RigidMotionLeft:
    """The ranks and the message for a beam with m = l = 1 whose shapes are 1, xi, xi^2, xi^3."""
    ansatz = monomials(3)
    fields = (ONE, XI, *map(polynomial, ansatz))
    exact = sp.Matrix([[sp.Rational(x.numerator, x.denominator) for x in row] for row in gram(fields)])
    try:
        assumed_shapes(AssumedDeflection(ansatz, Frame("given")))
        error = ""
    except ConditionError as fault:
        error = str(fault)
    rest, deformed = (np.linalg.eigvalsh(four_monomials_mass(alpha)) for alpha in (0.0, DEFORMED))
    regular = deformed[deformed > SINGULAR * deformed[-1]]
    return RigidMotionLeft(
        int(exact.rank()),
        len(fields),
        len(rest),
        int(np.sum(rest > SINGULAR * rest[-1])),
        len(regular),
        float(regular[0]) / DEFORMED**2,
        error,
    )


def four_monomials_mass(alpha: float) -> Matrix:
    """The mass matrix (7, 7) of c1, c2, phi and four amplitudes, for m = l = 1 and v = alpha (xi^2 + xi^3)."""
    v = alpha * (NODES**2 + NODES**3)
    none = np.zeros((4, len(NODES)))
    along = np.vstack([np.ones_like(v), 0 * v, -v, none])  # the velocity of a point: (c1' - phi' v, c2' + phi' X + ...)
    across = np.vstack([0 * v, np.ones_like(v), NODES / 2, *(NODES**n for n in range(4))])
    return np.asarray((along * WEIGHTS) @ along.T + (across * WEIGHTS) @ across.T) / 2
