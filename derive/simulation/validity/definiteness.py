"""How far deflections take the mass matrix of a truncated beam of second order towards an indefinite one."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh, null_space

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import ConstrainedSystem, constraint_matrix, coordinates_with, mass_matrix
from derive.simulation.observables.beams import amplitudes, piece_names
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.validity.piece_shapes import PieceShapes

ROWS = 12
"""States that are looked at: those with the largest strain energy of the beam."""


def lost_inertia(motion: SceneMotion, shapes: PieceShapes) -> tuple[int, float]:
    """The largest part of the kinetic energy of a velocity that the deflections of a beam take away, and its row.

    Of the velocities that the constraints admit; other beams are straight. Above 1 the mass matrix is indefinite.
    """
    native, k, beam = motion.native, motion.k, shapes.beam
    pieces = piece_names(beam)
    energy = sum(shapes.strain_energies(amplitudes(motion, beam, p))[0] for p in pieces)
    own = [i for p in pieces for i in shapes.amplitudes_in(native, p)]
    deformations = coordinates_with(native, Role.AMPLITUDE)
    row, lost = 0, 0.0
    for i in np.argsort(energy)[-ROWS:]:
        straight = np.where(deformations, 0.0, motion.q[i])
        bent = straight.copy()
        bent[own] = motion.q[i, own]
        value = _lost(native, k, float(motion.t[i]), straight, bent)
        if value > lost:
            row, lost = int(i), value
    return row, lost


def _lost(native: ConstrainedSystem, k: Vector, t: float, straight: Vector, bent: Vector) -> float:
    """1 less the smallest ratio of kinetic energies in two states (nq,); 0 where a velocity has no inertia at all."""
    before, after = mass_matrix(native, straight, k), mass_matrix(native, bent, k)
    size = np.sqrt(np.abs(np.diag(before)))
    scale = np.where(size > 0, size, 1.0)
    admitted = np.eye(len(scale))
    if native.nlambda:
        admitted = null_space(constraint_matrix(native, t, bent, k) / scale)
    if not admitted.size:
        return 0.0

    def reduced(M: Matrix) -> Matrix:
        result: Matrix = admitted.T @ (M / np.outer(scale, scale)) @ admitted
        return result

    try:
        return float(1.0 - eigh(reduced(after), reduced(before), eigvals_only=True)[0])
    except np.linalg.LinAlgError:
        return 0.0
