"""The lowest natural frequency of a beam as the joints of its scene hold it, and the shape of that vibration.

The beam deforms alone: all bodies move as far as the constraints admit in the initial state, with their masses; other
beams are rigid. Gravity, springs and spin are left out, so that what is found is what the beam itself resists with.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, null_space

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import constraint_matrix, coordinates_with, mass_matrix
from derive.simulation.observables.beams import piece_names
from derive.simulation.validity.piece_shapes import PieceShapes

RIGID = 1e-9
"""Squared frequencies below this, relative to the largest, are those of rigid motion."""


@dataclass(frozen=True, eq=False)
class LowestMode:
    """The lowest frequency of a beam, rad/s, and the amplitudes (pieces, shapes) of its shape."""

    frequency: float
    amplitudes: Matrix


def lowest_mode(shapes: PieceShapes, native: NativeScene, k: Vector, t: float, q: Vector) -> LowestMode | None:
    """The lowest mode of a beam; None where the joints admit no deformation of it alone.

    native, k: its compiled scene and the constants (nk,). q: the state (nq,) at t (s) in which it vibrates.
    """
    pieces = [shapes.amplitudes_in(native, piece) for piece in piece_names(shapes.beam)]
    own = [column for columns in pieces for column in columns]
    deformations = coordinates_with(native, Role.AMPLITUDE)
    straight = np.where(deformations, 0.0, q)
    free = ~deformations
    free[own] = True
    K = np.zeros((native.nq, native.nq))
    for columns in pieces:
        K[np.ix_(columns, columns)] = shapes.stiffness
    M = mass_matrix(native, straight, k)
    size = np.sqrt(np.diag(M)[free])
    scale = np.where(size > 0, size, 1.0)
    admitted = np.eye(len(scale))
    if native.nlambda:
        G = constraint_matrix(native, t, straight, k)[:, free] / scale
        admitted = null_space(G / np.maximum(np.linalg.norm(G, axis=1, keepdims=True), np.finfo(float).tiny))
    if not admitted.size:
        return None
    reduced = [admitted.T @ (x[np.ix_(free, free)] / np.outer(scale, scale)) @ admitted for x in (K, M)]
    try:
        squares, modes = eigh(*reduced)
    except np.linalg.LinAlgError:  # a velocity without inertia
        return None
    elastic = squares > RIGID * squares[-1]
    if not elastic.any():
        return None
    i = int(np.argmax(elastic))
    motion_of_all = np.zeros(native.nq)
    motion_of_all[free] = admitted @ modes[:, i] / scale
    return LowestMode(float(np.sqrt(squares[i])), motion_of_all[pieces])
