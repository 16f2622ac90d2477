"""The deflection of a whole beam as its pieces bend, from the line that its supports define.

The curvatures of the pieces are integrated twice along the beam, so that the angles between the floating frames of the
pieces do not matter. The line is the chord; of a beam with one end that is clamped against rotation the tangent there.
"""

from __future__ import annotations

import numpy as np

from derive.runtime.native_call import Matrix, Vector

PLACES = 5
"""Places along a piece, both ends among them, and as many along the whole beam."""


def places() -> Vector:
    """The places along a piece, xi from -1 to 1."""
    return np.linspace(-1, 1, PLACES)


def twists_along(values: Matrix, pieces: int, clamped: int | None) -> Matrix:
    """(places, pieces fields): the rotations of a twisted beam per unit of each field (fields, PLACES) of each piece.

    They are relative to the end, -1 or 1, that is `clamped` against rotation, or to the left end.
    """
    own = (values - values[:, :1]).T
    along = np.zeros((pieces, PLACES, pieces, len(values)))
    for j in range(pieces):
        along[j, :, j] = own
        along[j, :, :j] = own[-1]
    rotations = along.reshape(pieces * PLACES, -1)
    if clamped == 1:
        rotations = rotations - rotations[-1]
    rows = np.linspace(0, len(rotations) - 1, PLACES).round().astype(int)
    result: Matrix = rotations[rows]
    return result


def deflections_along(values: Matrix, slopes: Matrix, length: float, pieces: int, clamped: int | None) -> Matrix:
    """(places, pieces fields): the deflections of a beam per unit of each field of each piece.

    values: of the fields at `places` (fields, PLACES). slopes: their derivatives along the axis at both ends (fields,
    2). length: of a piece. clamped: the end, -1 or 1, from whose tangent deflections are measured; None for the chord.
    """
    x = np.linspace(0, length, PLACES)
    own = values - values[:, :1] - slopes[:, :1] * x  # from the tangent at the left end of the piece
    rise, rotation = own[:, -1], slopes[:, 1] - slopes[:, 0]
    along = np.zeros((pieces, PLACES, pieces, len(values)))
    for j in range(pieces):
        along[j, :, j] = own.T
        for i in range(j):
            along[j, :, i] = rise + np.outer(x + (j - i - 1) * length, rotation)
    deflections = along.reshape(pieces * PLACES, -1)
    position = np.add.outer(length * np.arange(pieces), x).ravel()
    end, last = deflections[-1].copy(), position[-1]
    if clamped is None:
        deflections -= np.outer(position / last, end)
    elif clamped == 1:
        deflections -= end + np.outer(position - last, np.tile(rotation, pieces))
    rows = np.linspace(0, len(position) - 1, PLACES).round().astype(int)
    result: Matrix = deflections[rows]
    return result
