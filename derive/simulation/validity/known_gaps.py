"""The gaps of the bending moment of a beam that are known in a run, as linear forms of the state and the outputs.

The bending moment EI v'' of the exact deflection vanishes at free and pinned ends, is in equilibrium with the forces at
ends that are clamped against rotation, and is the same on both sides of a weld between two pieces. Its derivative along
the axis is the shear force, which at an end is in equilibrium with the forces there. Where a force acts within a beam,
equilibrium gives the moment as well. Shapes fulfil this only as far as they can represent the deflection: the curvature
of two polynomials of degree 2 and 3 is linear, that of a rod between two pins is not; and sine waves know no moment at
a clamped end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from derive.runtime.native_call import Vector
from derive.simulation.validity.missed_moment import ENDS
from derive.simulation.validity.monitoring_outputs import MOMENT_GAP
from derive.simulation.validity.piece_shapes import PieceShapes
from derive.simulation.validity.surroundings import Surroundings
from derive.simulation.validity.watched_forms import WatchedForms
from derive.spec.model.beam_pieces import piece_of, place_in_piece


@dataclass(frozen=True, eq=False)
class KnownGap:
    """A quantity that the shapes of a piece miss at its place xi, as a form (z,).

    order: 0, of the bending moment, N m; 1, of its derivative along the axis, N.
    """

    xi: float
    order: int
    form: Vector


def known_gaps(
    around: Surroundings, forms: WatchedForms, shapes: PieceShapes, amplitudes: Sequence[Sequence[int]]
) -> list[list[KnownGap]]:
    """The known gaps of each piece of a beam; `amplitudes`: the numbers of the coordinates of each piece."""
    last = len(amplitudes) - 1

    def of_amplitudes(piece: int, factors: Vector) -> Vector:
        form = np.zeros(forms.size)
        form[amplitudes[piece]] = factors
        return form

    moments, slopes = shapes.moments(ENDS).T, shapes.shear_forces(ENDS).T
    gaps = {(i, xi, 0): of_amplitudes(i, -moments[end]) for i in range(last + 1) for end, xi in enumerate(ENDS)}
    for i in range(last):  # the moment between two pieces is the mean of theirs
        jump = (of_amplitudes(i + 1, moments[0]) - of_amplitudes(i, moments[1])) / 2
        gaps[i, 1.0, 0], gaps[i + 1, -1.0, 0] = jump, -jump
    for end, free in enumerate(around.free):
        if free:
            gaps[end * last, ENDS[end], 1] = of_amplitudes(end * last, -slopes[end])
    for (at, kind), output in around.gaps.items():
        piece, xi = piece_of(at, last + 1), float(place_in_piece(at, last + 1))
        if abs(at) == 1 or abs(xi) < 1:
            gaps[piece, xi, 0 if kind == MOMENT_GAP else 1] = forms.of_output(output)
    return [[KnownGap(xi, order, form) for (i, xi, order), form in gaps.items() if i == n] for n in range(last + 1)]
