"""How far deflections take the mass matrix of a truncated beam of second order towards an indefinite one."""

from __future__ import annotations

import numpy as np

from derive.roles import Role
from derive.simulation.compiled_scene import coordinates_with
from derive.simulation.constraints.mass_definiteness import smallest_eigenvalue
from derive.simulation.observables.beams import amplitudes, piece_names
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.validity.piece_shapes import PieceShapes

ROWS = 12
"""States that are looked at: those with the largest strain energy of the beam."""


def lost_definiteness(motion: SceneMotion, shapes: PieceShapes) -> tuple[int, float]:
    """The part of the smallest eigenvalue of M that the deflections of a beam take away, and the row where it is most.

    M on the velocities that the constraints admit; other beams are straight. Above 1 it is indefinite.
    """
    native, k, beam = motion.native, motion.k, shapes.beam
    pieces = piece_names(beam)
    energy = sum(shapes.strain_energies(amplitudes(motion, beam, p))[0] for p in pieces)
    own = [i for p in pieces for i in shapes.amplitudes_in(native, p)]
    straight = coordinates_with(native, Role.AMPLITUDE)
    result = (0, 0.0)
    for row in np.argsort(energy)[-ROWS:]:
        t, q = float(motion.t[row]), np.where(straight, 0.0, motion.q[row])
        before = smallest_eigenvalue(native, k, t, q)
        q[own] = motion.q[row, own]
        lost = 1.0 - smallest_eigenvalue(native, k, t, q) / before if before > 0 else 0.0
        result = max(result, (int(row), lost), key=lambda each: each[1])
    return result
