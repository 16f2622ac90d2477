"""What the shapes of a piece miss of its bending moment, from what they miss of it at both ends.

The shapes are a projection: what they miss of the exact moment along the piece is orthogonal to their curvatures, in
statics exactly so. Of the polynomials with this property and with the missed moments at both ends that of the lowest
degree is taken. Between two pins P2 has a constant moment; it misses 1 at both ends, so that it misses P2(xi) along the
beam, and its deflection under a uniform load is 4/5 of the exact one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from derive.runtime.native_call import Matrix
from derive.simulation.validity.beam_line import places
from derive.simulation.validity.piece_shapes import PieceShapes, gauss_points


@dataclass(frozen=True, eq=False)
class MissedMoment:
    """Per unit of the moment that is missed at the left and at the right end of a piece.

    values (2, PLACES), slopes (2, 2): the missed deflection, m, and its derivative at both ends.
    """

    values: Matrix
    slopes: Matrix


def missed_moment(shapes: PieceShapes) -> MissedMoment:
    """Of a piece with these shapes."""
    xi, weights = gauss_points()
    kept = shapes.moments(xi)
    degree = len(kept) + 1
    basis = legendre.legvander(xi, degree).T
    conditions = np.vstack([(kept * weights) @ basis.T, legendre.legvander([-1.0, 1.0], degree)])
    scale = np.linalg.norm(conditions, axis=1, keepdims=True)
    wanted = np.vstack([np.zeros((len(kept), 2)), np.eye(2)]) / scale
    moments = np.linalg.lstsq(conditions / scale, wanted, rcond=None)[0].T  # by degrees of Legendre polynomials
    half, stiffness = shapes.length / 2, shapes.bending_stiffness
    slope = [legendre.legint(m) * half / stiffness for m in moments]
    return MissedMoment(
        np.array([legendre.legval(places(), legendre.legint(s) * half) for s in slope]),
        np.array([legendre.legval([-1.0, 1.0], s) for s in slope]),
    )
