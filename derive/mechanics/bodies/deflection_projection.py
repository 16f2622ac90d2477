"""The nearest deflection that shape functions have to a polynomial that they cannot describe.

The distance is that of the mass metric of a uniform beam: with rates, what is left has the least kinetic energy, and
the momentum of the beam is kept.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from derive.mechanics.bodies.beam_functions import BeamFunction
from derive.mechanics.bodies.reference_conditions import LINE, PieceDeflection, on_piece, piece_deflection
from derive.spec.model.beam_parts import Polynomial


@dataclass(frozen=True)
class Projection:
    """The nearest deflection of a beam, by pieces, and its distance, root mean square over that of the polynomial."""

    parts: tuple[PieceDeflection, ...]
    remainder: float


def projection(
    deflection: Polynomial, shapes: tuple[BeamFunction, ...], pieces: int, rigid: tuple[BeamFunction, ...] = LINE
) -> Projection:
    """The nearest deflection on each of some pieces of equal length; it is exact where the shapes can describe it.

    deflection: a polynomial in xi of the whole beam; shapes: the shapes of a piece, none for a rigid one; rigid: its
    rigid motions, see `piece_deflection`.
    """
    exact = [piece_deflection(deflection, shapes, pieces, k, rigid) for k in range(pieces)]
    known = tuple(part for part in exact if part is not None)
    if len(known) == pieces:
        return Projection(known, 0.0)
    basis = (*rigid, *shapes)
    gram = np.array([[float((f * g).integral()) for g in basis] for f in basis])
    parts, left, size = [], 0.0, 0.0
    for k in range(pieces):
        curve = on_piece(deflection, pieces, k)
        products = np.array([float((curve * f).integral()) for f in basis])
        weights = np.linalg.solve(gram, products)
        values = [Fraction(float(weight)) for weight in weights]
        offset, slope = (*values[: len(rigid)], Fraction(0))[:2]
        parts.append(PieceDeflection(offset, slope, tuple(values[len(rigid) :])))
        square = float((curve * curve).integral())
        size += square
        left += max(0.0, square - float(weights @ products))
    return Projection(tuple(parts), float(np.sqrt(left / size)))
