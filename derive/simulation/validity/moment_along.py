"""The bending moment between the ends of a piece of a beam, from equilibrium.

Across the axis, M'' = -rho a: the inertia of the piece and of its attached masses bends it, with the accelerations a of
its frame and of its amplitudes. The moment is that of a piece between two pins, and the linear one that gives it its
known values: at the ends, and where something acts. Gravity is in the acceleration of the frame. Left out are what is
of second order, and the rotary inertia of masses.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre

from derive.mechanics.multibody.bodies.beam import masses_of_piece
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.observables.motion import si_value
from derive.simulation.validity.beam_line import places
from derive.simulation.validity.missed_moment import ENDS
from derive.simulation.validity.piece_shapes import PieceShapes, gauss_points

TERMS = 9
"""Legendre polynomials whose parts of a missed moment count in its energy."""
DEGREE = 40
"""Of the polynomials that stand for accelerations along a piece."""


def moments_of_inertia(shapes: PieceShapes, piece: int, xi: Vector) -> Matrix:
    """(2 + shapes, len(xi)): the bending moments at places of a piece between two pins, N m.

    They are those of unit accelerations: of the frame across the axis, of its rotation, and of the amplitudes.
    """
    density, half = shapes.mass / shapes.length, shapes.length / 2
    twice = legendre.legint(-density * half**2 * _series(_accelerations(shapes, gauss_points()[0])), 2)
    left_end, right_end = legendre.legval(ENDS, twice).T
    at_ends = np.outer(left_end, (1 - xi) / 2) + np.outer(right_end, (1 + xi) / 2)
    result: Matrix = legendre.legval(xi, twice).astype(np.float64) - at_ends
    for mass in masses_of_piece(shapes.beam, piece):
        at = float(mass.at)
        force = -si_value(mass.mass) * _accelerations(shapes, np.array([at]))
        left, right = np.minimum(xi, at) + 1, 1 - np.maximum(xi, at)
        result -= force * half * left * right / 2
    return result


def without_kept(shapes: PieceShapes, moments: Matrix) -> Matrix:
    """Moments at the Gauss points (points, z) without what the shapes of a piece can represent.

    The equations of motion leave nothing of that; what is here is of what this equilibrium leaves out.
    """
    xi, weights = gauss_points()
    kept = shapes.moments(xi)
    factors = np.linalg.solve((kept * weights) @ kept.T, (kept * weights) @ moments)
    result: Matrix = moments - kept.T @ factors
    return result


def deflections_of_moments(shapes: PieceShapes) -> tuple[Matrix, Matrix]:
    """Of a piece, per unit of the moments at its Gauss points: deflections (points, PLACES), slopes at both ends."""
    half = shapes.length / 2
    slopes = legendre.legint(_series(np.eye(len(gauss_points()[0])))) * half / shapes.bending_stiffness
    values = legendre.legval(places(), legendre.legint(slopes) * half)
    return values.astype(np.float64), legendre.legval(ENDS, slopes).astype(np.float64)


def energy_roots(shapes: PieceShapes, moments: Matrix) -> Matrix:
    """Forms (terms, z) whose squares add up to the strain energy of moments (points, z) at the Gauss points, J."""
    xi, weights = gauss_points()
    factors = np.sqrt((np.arange(TERMS) + 0.5) * shapes.length / (4 * shapes.bending_stiffness))
    result: Matrix = factors[:, None] * (legendre.legvander(xi, TERMS - 1).T @ (weights[:, None] * moments))
    return result


def _series(values: Matrix) -> Matrix:
    """The Legendre series (DEGREE + 1, n) of functions with values (n, points) at the Gauss points."""
    xi, weights = gauss_points()
    series: Matrix = (np.arange(DEGREE + 1) + 0.5)[:, None] * (legendre.legvander(xi, DEGREE).T @ (values * weights).T)
    return series


def _accelerations(shapes: PieceShapes, xi: Vector) -> Matrix:
    """(2 + shapes, len(xi)): across the axis at places xi, for unit accelerations."""
    return np.vstack([np.ones_like(xi), xi * shapes.length / 2, shapes.values(xi)])
