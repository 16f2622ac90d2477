"""The nearest deflection that shape functions have to a polynomial that they cannot describe.

The distance is that of the mass metric of a uniform beam: with rates, what is left has the least kinetic energy, and
the momentum of the beam is kept.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from derive.mechanics.bodies.beam_functions import ONE, XI, BeamFunction
from derive.mechanics.bodies.reference_conditions import PieceDeflection, on_piece, piece_deflection
from derive.spec.model.beam_parts import Polynomial


@dataclass(frozen=True)
class Projection:
    """The nearest deflection of a beam, by pieces, and its distance, root mean square over that of the polynomial."""

    parts: tuple[PieceDeflection, ...]
    remainder: float


def projection(deflection: Polynomial, shapes: tuple[BeamFunction, ...], pieces: int) -> Projection:
    """The nearest deflection on each of some pieces of equal length; it is exact where the shapes can describe it.

    deflection: a polynomial in xi of the whole beam; shapes: the shapes of a piece, none for a rigid one.
    """
    exact = [piece_deflection(deflection, shapes, pieces, k) for k in range(pieces)]
    known = tuple(part for part in exact if part is not None)
    if len(known) == pieces:
        return Projection(known, 0.0)
    basis = (ONE, XI, *shapes)
    gram = np.array([[float((f * g).integral()) for g in basis] for f in basis])
    parts, left, size = [], 0.0, 0.0
    for k in range(pieces):
        curve = on_piece(deflection, pieces, k)
        products = np.array([float((curve * f).integral()) for f in basis])
        weights = np.linalg.solve(gram, products)
        offset, slope, *amplitudes = map(Fraction, map(float, weights))
        parts.append(PieceDeflection(offset, slope, tuple(amplitudes)))
        square = float((curve * curve).integral())
        size += square
        left += max(0.0, square - float(weights @ products))
    return Projection(tuple(parts), float(np.sqrt(left / size)))
