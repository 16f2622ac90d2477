"""The bending moment that the shapes of a piece miss along it, from the part that they miss at some places.

The shapes are a projection: what they miss of the exact moment is orthogonal to their curvatures, in statics exactly.
Of the polynomials with this property and with what is known to be missed, the moments at both ends and its derivatives
where the shear force is known, that of the lowest degree is taken. Between two pins P2 has a constant moment; it misses
1 at both ends, so that it misses P2(xi) along the beam, and its deflection under a uniform load is 4/5 of the exact
one. A force within the piece bends the diagram of the moment by an angle there, and so it does that of what is missed:
the moment missed at its place determines the angle.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from derive.runtime.native_call import Matrix, Vector
from derive.simulation.validity.beam_line import places
from derive.simulation.validity.piece_shapes import PieceShapes, gauss_points

ENDS = np.array([-1.0, 1.0])


SECTIONS = 9
"""Sections of a piece at which bending moments are looked at, both ends among them."""


@dataclass(frozen=True, eq=False)
class MissedFields:
    """The fields that a piece misses, for each unit that is known to be missed.

    moments (units, SECTIONS): in `sections`. values (units, PLACES), slopes (units, 2), along (units, POINTS): the
    deflection at `places`, and its derivative along the axis at both ends and at Gauss points, but for a rigid motion
    of the piece. energies (parts, units): square roots of parts of the strain energy.
    """

    moments: Matrix
    values: Matrix
    slopes: Matrix
    along: Matrix
    energies: Matrix


def sections() -> Vector:
    """The sections of a piece, xi."""
    return np.linspace(-1, 1, SECTIONS)


def missed_fields(shapes: PieceShapes, known: Sequence[tuple[float, int]]) -> MissedFields:
    """The fields that a piece misses; known: places xi, each with 0 for the moment, N m, or 1 for its derivative, N."""
    xi, weights = gauss_points()
    kept, half, strain = shapes.moments(xi), shapes.length / 2, shapes.strain_order
    kinks = np.array([place for place, order in known if order == 0 and abs(place) < 1])
    degree = len(kept) + len(known) - len(kinks) - 1

    def each(order: int, at: Vector) -> Matrix:
        """The derivatives by xi, or the integrals if `order` is negative, of all functions (functions, places)."""
        unit = np.eye(degree + 1)
        of_degrees = legendre.legder(unit, order) if order > 0 else legendre.legint(unit, -order)
        r = at - kinks[:, None]
        power = 1 - order
        of_kinks = np.sign(r) * r**power / np.prod(np.arange(2, power + 1))  # |r| and its integrals
        return np.vstack([legendre.legval(at, of_degrees), of_kinks]).astype(np.float64)

    missed = np.array([each(order, np.array([place]))[:, 0] / half**order for place, order in known])
    conditions = np.vstack([(kept * weights) @ each(0, xi).T, missed])
    scale = np.linalg.norm(conditions, axis=1, keepdims=True)
    unit = np.vstack([np.zeros((len(kept), len(known))), np.eye(len(known))])
    factors = np.linalg.lstsq(conditions / scale, unit / scale, rcond=None)[0].T  # for each unit, of each function
    slopes, along, values = (
        factors @ each(-times, at) * half**power / shapes.bending_stiffness
        for power, times, at in ((1, 1, ENDS), (1, 1, xi), (2, strain, places()))
    )
    moments = factors @ each(0, xi)
    squares, axes = np.linalg.eigh((moments * weights) @ moments.T * half / (2 * shapes.bending_stiffness))
    energies = np.sqrt(np.maximum(squares, 0))[:, None] * axes.T
    return MissedFields(factors @ each(0, sections()), values, slopes, along, energies)
