"""The natural frequencies of a beam as the joints of its scene hold it, and the shapes of its vibrations.

The beam deforms alone: all bodies move as far as the constraints admit in the initial state, with their masses; other
beams are rigid. Gravity, springs and spin are left out, so that frequencies are due to the stiffness of the beam alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, null_space

from derive.roles import Role
from derive.runtime.native_call import Matrix, ModelError, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import Mask, constraint_matrix, coordinates_with, mass_matrix
from derive.simulation.observables.beams import piece_names
from derive.simulation.validity.piece_shapes import PieceShapes

SMALL = 1e-5
"""The size of a motion in which forces are linear, relative to the largest coordinate."""
RIGID = 1e-9
"""Squared frequencies below this, relative to the largest, are those of rigid motion."""


@dataclass(frozen=True, eq=False)
class HeldMode:
    """A vibration of a beam: its frequency, rad/s, and the motion (nq,) of all coordinates of the scene."""

    frequency: float
    motion: Vector


def held_modes(shapes: PieceShapes, native: NativeScene, k: Vector, t: float, q: Vector) -> tuple[HeldMode, ...]:
    """The vibrations of a beam, the slowest first; none where the joints admit no deformation of it alone.

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
    G = constraint_matrix(native, t, straight, k) if native.nlambda else np.zeros((0, native.nq))
    return admitted_modes(K, M, G, free)


def admitted_modes(K: Matrix, M: Matrix, G: Matrix, free: Mask) -> tuple[HeldMode, ...]:
    """The vibrations of M xddot + K x = 0 (n, n) in the motions of the `free` x with G x = 0 (m, n), slowest first."""
    size = np.sqrt(np.diag(M)[free])
    scale = np.where(size > 0, size, 1.0)
    admitted = np.eye(len(scale))
    if len(G):
        rows = G[:, free] / scale
        admitted = null_space(rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), np.finfo(float).tiny))
    if not admitted.size:
        return ()
    reduced = [admitted.T @ (x[np.ix_(free, free)] / np.outer(scale, scale)) @ admitted for x in (K, M)]
    try:
        squares, modes = eigh(*reduced)
    except np.linalg.LinAlgError:  # a velocity without inertia
        return ()
    motions = np.zeros((len(squares), len(free)))
    motions[:, free] = (admitted @ modes / scale[:, None]).T
    elastic = squares > RIGID * squares[-1]
    return tuple(map(HeldMode, np.sqrt(squares[elastic]).tolist(), motions[elastic]))


@dataclass(frozen=True, eq=False)
class StaticResponse:
    """The change of z that a small motion from a state q (nq,) at rest at t (s) causes by itself."""

    native: NativeScene
    k: Vector
    t: float
    q: Vector

    def __call__(self, motion: Vector) -> Vector:
        """The change of z = [q; v; outputs; t] for a motion (nq,); zero where the model has no accelerations."""
        step = SMALL * max(1.0, float(np.abs(self.q).max())) / float(np.abs(motion).max())
        try:
            ahead, behind = (self._outputs(self.q + sign * step * motion) for sign in (1, -1))
        except ModelError:
            return np.zeros(self.native.nq + self.native.nv + len(self.native.outputs) + 1)
        return np.concatenate([motion, np.zeros(self.native.nv), (ahead - behind) / (2 * step), [0.0]])

    def _outputs(self, q: Vector) -> Vector:
        native, v = self.native, np.zeros(self.native.nv)
        return native.evaluate_outputs(self.t, q, v, *native.solve(self.t, q, v, self.k), self.k)
