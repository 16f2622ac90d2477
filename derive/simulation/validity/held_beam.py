"""The natural frequencies of a beam as the joints of its scene hold it, and the shapes of its vibrations.

The beam deforms alone: all bodies move as far as the constraints admit in the initial state, with their masses; other
beams are rigid. Gravity, springs and spin are left out, so that frequencies are due to the stiffness of the beam alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, null_space

from derive.roles import Role
from derive.runtime.native_call import Matrix, ModelError, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import constraint_matrix, coordinates_with, mass_matrix, undeformed
from derive.simulation.observables.beams import piece_names
from derive.simulation.validity.piece_shapes import PieceShapes

SMALL = 1e-5
"""The size of a motion in which forces are linear, relative to the largest coordinate."""
RIGID = 1e-12
"""Squared frequencies below this, relative to the largest, are those of rigid motion: torsion is fast in a thin rod."""

APART = 1e-6
"""The relative difference of the stiffnesses of two planes that keeps equal vibrations in them apart."""


@dataclass(frozen=True, eq=False)
class HeldMode:
    """A vibration of a beam: its frequency, rad/s, and the motion (nq,) of all coordinates of the scene.

    The velocities of this motion have a kinetic energy of 1/2 J.
    """

    frequency: float
    motion: Vector


def held_modes(
    planes: Sequence[PieceShapes], native: NativeScene, k: Vector, t: float, q: Vector
) -> tuple[HeldMode, ...]:
    """The vibrations of a beam, the slowest first; none where the joints admit no deformation of it alone.

    planes: those in which it bends, which joints may couple. native, k: its compiled scene and the constants (nk,). q:
    the state (nq,) at t (s) in which it vibrates.
    """
    straight = undeformed(native, q)
    own, K = list[int](), np.zeros((native.nv, native.nv))
    for number, shapes in enumerate(planes):
        for piece in piece_names(shapes.beam):
            columns = shapes.rates_in(native, piece)
            K[np.ix_(columns, columns)] = (1 + number * APART) * shapes.stiffness
            own += columns
    return admitted_modes(K, native, k, t, straight, own)


def admitted_modes(
    K: Matrix, native: NativeScene, k: Vector, t: float, q: Vector, own: Sequence[int]
) -> tuple[HeldMode, ...]:
    """The vibrations with the stiffness K (nv, nv) and no deformation rates but `own` ones, slowest first.

    q: the undeformed state (nq,) in which the joints admit motions, at t (s).
    """
    admitted = admitted_velocities(native, k, t, q, own)
    if not admitted.size:
        return ()
    try:
        squares, modes = eigh(*(admitted.T @ x @ admitted for x in (K, mass_matrix(native, q, k))))
    except np.linalg.LinAlgError:  # a velocity without inertia
        return ()
    elastic = squares > RIGID * squares[-1]
    motions = (admitted @ modes[:, elastic]).T @ moved_by_velocities(native, q, k).T
    return tuple(map(HeldMode, np.sqrt(squares[elastic]).tolist(), motions))


def admitted_velocities(native: NativeScene, k: Vector, t: float, q: Vector, own: Sequence[int]) -> Matrix:
    """The velocities (nv, n) that joints admit in the undeformed state q, with no deformation rates but `own` ones."""
    moved = moved_by_velocities(native, q, k)
    free = ~np.any(moved[coordinates_with(native, Role.AMPLITUDE)], axis=0)
    free[list(own)] = True
    size = np.sqrt(np.diag(mass_matrix(native, q, k))[free])
    scale = np.where(size > 0, size, 1.0)
    admitted = np.eye(len(scale))
    if native.nlambda:
        G = constraint_matrix(native, t, q, k)[:, free] / scale
        admitted = null_space(G / np.maximum(np.linalg.norm(G, axis=1, keepdims=True), np.finfo(float).tiny))
    result = np.zeros((native.nv, admitted.shape[1]))
    result[free] = admitted / scale[:, None]
    return result


def moved_by_velocities(native: NativeScene, q: Vector, k: Vector) -> Matrix:
    """The rates (nq, nv) of the coordinates for unit velocities; in the plane velocities are these rates."""
    if native.nq == native.nv:
        return np.eye(native.nq)
    return np.array([native.rates(q, unit, k) for unit in np.eye(native.nv)]).T


@dataclass(frozen=True, eq=False)
class StaticResponse:
    """The change of z that a small motion from a state q (nq,) at t (s) causes by itself.

    v (nv,): the velocities, at rest or those with which the motion turns.
    """

    native: NativeScene
    k: Vector
    t: float
    q: Vector
    v: Vector

    def __call__(self, motion: Vector) -> Vector:
        """The change of z = [q; v; outputs; t] for a motion (nq,); zero where the model has no accelerations."""
        step = SMALL * max(1.0, float(np.abs(self.q).max())) / float(np.abs(motion).max())
        try:
            ahead, behind = (self.outputs(self.q + sign * step * motion) for sign in (1, -1))
        except ModelError:
            return np.zeros(self.native.nq + self.native.nv + len(self.native.outputs) + 1)
        return np.concatenate([motion, np.zeros(self.native.nv), (ahead - behind) / (2 * step), [0.0]])

    def start(self) -> Vector:
        """The z of the state; no outputs where the model has no accelerations."""
        try:
            outputs = self.outputs(self.q)
        except ModelError:  # the run says so, or it is what the monitors are to find
            outputs = np.zeros(len(self.native.outputs))
        return np.concatenate([self.q, self.v, outputs, [0.0]])

    def outputs(self, q: Vector) -> Vector:
        """The outputs (nout,) of a configuration."""
        native, v = self.native, self.v
        return native.evaluate_outputs(self.t, q, v, *native.solve(self.t, q, v, self.k), self.k)
