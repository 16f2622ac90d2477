"""What the shapes of a piece miss of its bending moment along it, from what they miss of it at the ends.

The shapes are a projection: what they miss of the exact moment is orthogonal to their curvatures, in statics exactly.
Of the polynomials with this property and with the missed moments at both ends, and where it is known the missed shear
force there, that of the lowest degree is taken. Between two pins P2 has a constant moment; it misses 1 at both ends, so
that it misses P2(xi) along the beam, and its deflection under a uniform load is 4/5 of the exact one.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre

from derive.runtime.native_call import Matrix
from derive.simulation.validity.beam_line import places
from derive.simulation.validity.piece_shapes import PieceShapes, gauss_points

ENDS = np.array([-1.0, 1.0])


def missed_deflections(shapes: PieceShapes, shear_known: tuple[bool, bool]) -> tuple[Matrix, Matrix]:
    """Of a piece, per unit of what is missed: the deflections (4, PLACES) and their slopes at both ends (4, 2).

    What is missed: the moment at the left and at the right end, N m, and its derivative along the axis there, N, which
    counts where it is known.
    """
    xi, weights = gauss_points()
    kept, half = shapes.moments(xi), shapes.length / 2
    known = [0, 1, *(2 + end for end in (0, 1) if shear_known[end])]
    degree = len(kept) + len(known) - 1
    each = np.eye(degree + 1)
    at_ends = np.vstack([legendre.legvander(ENDS, degree), legendre.legval(ENDS, legendre.legder(each.T)).T / half])
    conditions = np.vstack([(kept * weights) @ legendre.legvander(xi, degree), at_ends[known]])
    scale = np.linalg.norm(conditions, axis=1, keepdims=True)
    unit = np.vstack([np.zeros((len(kept), 4)), np.eye(4)[known]])
    moments = np.linalg.lstsq(conditions / scale, unit / scale, rcond=None)[0]  # of each degree, for each unit
    slopes = legendre.legint(moments) * half / shapes.bending_stiffness
    values = legendre.legval(places(), legendre.legint(slopes) * half)
    return values.astype(np.float64), legendre.legval(ENDS, slopes).astype(np.float64)
