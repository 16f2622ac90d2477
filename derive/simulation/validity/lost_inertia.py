"""The inertia that deflections take away of a beam of second order with truncated terms.

Its kinetic energy lacks terms of the fourth order in deflections and their rates, so that its mass matrix loses
inertia, and in the end is indefinite. Shapes that are steep lose most: the largest loss says when the run stops, and
that of each vibration how much too fast it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, null_space

from derive.roles import Role
from derive.runtime.integrators.watch import Watched
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import ConstrainedSystem, constraint_matrix, coordinates_with, mass_matrix
from derive.simulation.observables.beams import piece_names
from derive.simulation.validity.held_beam import RIGID, moved_by_velocities
from derive.simulation.validity.piece_shapes import PieceShapes
from derive.simulation.validity.watched_beam import SceneWatch, WatchedBeam


@dataclass(frozen=True, eq=False)
class LostInertia:
    """The largest part of the kinetic energy of a velocity that deflections take away, and its time t, s.

    frequencies (n,), rad/s: those of the vibrations of the straight beam in its plane, in order. stiffer (n,): the
    relative change of their squares in the deflected state.
    """

    t: float
    largest: float
    frequencies: Vector
    stiffer: Vector

    def of_frequency(self, frequency: float) -> float:
        """The relative change of the square of a frequency, rad/s: that of the vibrations near it."""
        return float(np.interp(frequency, self.frequencies, self.stiffer)) if len(self.frequencies) else 0.0


def lost_inertia(scene: SceneWatch, watched: WatchedBeam, seen: Watched) -> LostInertia:
    """The inertia that the deflections of a beam take away; above 1 the mass matrix is indefinite.

    Of the velocities that the constraints admit; other beams are straight. In space they are those in the plane of the
    deflections: a slender beam has so little inertia about its own axis that small terms take it away, which hardly
    matters for its deflections. Looked at are the states with the largest deflection of each piece, and the largest
    part of each of its strain energies.
    """
    native, k, shapes = scene.native, scene.k, watched.shapes
    pieces = piece_names(shapes.beam)
    own = [i for p in pieces for i in shapes.amplitudes_in(native, p)]
    held = [i for p in pieces for i in shapes.beside_in(native, p)]
    deformations = coordinates_with(native, Role.AMPLITUDE)
    quantities = [*watched.piece_deflections, *(part for parts in watched.energies for part in parts)]
    states = {float(seen.times[i]): seen.states[i] for i in quantities}
    time, lost, last = next(iter(states)), 0.0, (np.zeros(0), np.zeros(0))
    for t, q in states.items():
        straight = np.where(deformations, 0.0, q)
        bent = straight.copy()
        bent[own] = q[own]
        value = _lost(_Energies.of(native, k, t, straight, bent, held))
        if value > lost:
            time, lost, last = t, value, (straight, bent)
    if not 0 < lost < 1:
        return LostInertia(time, lost, np.zeros(0), np.zeros(0))
    moved = moved_by_velocities(native, last[0], k)[deformations]
    rates = [i for p in pieces for i in shapes.rates_in(native, p)]
    others = [i for i in np.flatnonzero(np.any(moved, axis=0)).tolist() if i not in rates]
    before, after = _vibrations(_Energies.of(native, k, time, *last, [*held, *others]), shapes, [*pieces], native)
    return LostInertia(time, lost, np.sqrt(before), np.maximum(after / before - 1, 0))


@dataclass(frozen=True, eq=False)
class _Energies:
    """The velocities (nv, n) that constraints admit in a deflected state, and their inertia before and in it."""

    admitted: Matrix
    before: Matrix
    after: Matrix

    @classmethod
    def of(
        cls, native: ConstrainedSystem, k: Vector, t: float, straight: Vector, bent: Vector, held: Sequence[int]
    ) -> _Energies:
        """The inertia in two states (nq,); held: the numbers of velocities that vanish."""
        before, after = mass_matrix(native, straight, k), mass_matrix(native, bent, k)
        size = np.sqrt(np.abs(np.diag(before)))
        scale = np.where(size > 0, size, 1.0)
        conditions = np.eye(len(scale))[list(held)]
        if native.nlambda:
            conditions = np.vstack([constraint_matrix(native, t, bent, k) / scale, conditions])
        admitted = (null_space(conditions) if len(conditions) else np.eye(len(scale))) / scale[:, None]
        return cls(admitted, *(admitted.T @ M @ admitted for M in (before, after)))


def _lost(energies: _Energies) -> float:
    """1 less the smallest ratio of kinetic energies in two states; 0 where a velocity has no inertia at all."""
    if not energies.before.size:
        return 0.0
    try:
        return float(1.0 - eigh(energies.after, energies.before, eigvals_only=True)[0])
    except np.linalg.LinAlgError:
        return 0.0


def _vibrations(
    energies: _Energies, shapes: PieceShapes, pieces: Sequence[str], native: ConstrainedSystem
) -> tuple[Vector, Vector]:
    """The squares of the frequencies of a beam in its plane before and in the deflected state."""
    K = np.zeros((native.nv,) * 2)
    for piece in pieces:
        columns = shapes.rates_in(native, piece)
        K[np.ix_(columns, columns)] = shapes.stiffness
    admitted = energies.admitted.T @ K @ energies.admitted
    before, after = (eigh(admitted, M, eigvals_only=True) for M in (energies.before, energies.after))
    elastic = before > RIGID * before[-1] if len(before) else np.zeros(0, bool)
    return before[elastic], after[elastic]
