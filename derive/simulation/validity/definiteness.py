"""How far deflections take the mass matrix of a truncated beam of second order towards an indefinite one."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh, null_space

from derive.roles import Role
from derive.runtime.integrators.watch import Watched
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import ConstrainedSystem, constraint_matrix, coordinates_with, mass_matrix
from derive.simulation.observables.beams import piece_names
from derive.simulation.validity.watched_beam import SceneWatch, WatchedBeam


def lost_inertia(scene: SceneWatch, watched: WatchedBeam, seen: Watched) -> tuple[float, float]:
    """The largest part of the kinetic energy of a velocity that the deflections of a beam take away, and its time, s.

    Of the velocities that the constraints admit; other beams are straight. Above 1 the mass matrix is indefinite.
    Looked at are the states with the largest deflection of each piece, and the largest part of each of its strain
    energies.
    """
    native, k, shapes = scene.native, scene.k, watched.shapes
    own = [i for p in piece_names(shapes.beam) for i in shapes.amplitudes_in(native, p)]
    deformations = coordinates_with(native, Role.AMPLITUDE)
    quantities = [*watched.piece_deflections, *(part for parts in watched.energies for part in parts)]
    states = {float(seen.times[i]): seen.states[i] for i in quantities}
    time, lost = next(iter(states)), 0.0
    for t, q in states.items():
        straight = np.where(deformations, 0.0, q)
        bent = straight.copy()
        bent[own] = q[own]
        value = _lost(native, k, t, straight, bent)
        if value > lost:
            time, lost = t, value
    return time, lost


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
