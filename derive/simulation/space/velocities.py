"""Initial velocities in space: given values are kept, guesses come next, and others adapt with the least energy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import null_space

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import constraint_matrix, mass_matrix, max_norm
from derive.simulation.configurations import velocities_with
from derive.simulation.constraints.closest_state import RATES_CONSISTENT
from derive.simulation.constraints.scaling import mass_factor
from derive.simulation.initial.targets import Strength
from derive.simulation.space.assembly import SpatialAssembler
from derive.simulation.space.targets import SpatialTarget

RANK = 1e-9
"""Singular values below this part of the largest count as zero."""


def spatial_velocities(
    assembler: SpatialAssembler, q: Vector, targets: Sequence[SpatialTarget], momentum: Vector
) -> Vector:
    """The velocities (nv,) in a configuration that meet the constraints, then given targets, then guesses.

    What is left free has the least kinetic energy 1/2 v . M v + momentum . v. Demands that contradict earlier ones are
    met in the sense of least squares. Bodies deform only if the constraints and given targets cannot be met otherwise.
    """
    native = assembler.native
    rigid = ~velocities_with(native, Role.AMPLITUDE)
    rigid[[j for target in targets for j in target.amplitudes]] = True
    given = [target for target in targets if target.strength is Strength.GIVEN]
    v = np.zeros(native.nv)
    for free in (rigid,) if np.all(rigid) else (rigid, np.ones_like(rigid)):
        v = _least_energy(assembler, q, targets, momentum, np.eye(native.nv)[:, free])
        r, J = assembler.missed(given, q)
        missed = np.concatenate([native.constraint_rates(assembler.t, q, v, assembler.k), r + J @ v])
        if max_norm(missed) <= RATES_CONSISTENT * max(1.0, max_norm(v)):
            break
    return v


def _least_energy(
    assembler: SpatialAssembler, q: Vector, targets: Sequence[SpatialTarget], momentum: Vector, free: Matrix
) -> Vector:
    """The velocities (nv,) of the motions `free` (nv, n), see `spatial_velocities`."""
    native, k, t = assembler.native, assembler.k, assembler.t
    R = mass_factor(mass_matrix(native, q, k))
    v = np.zeros(native.nv)
    at_rest = native.constraint_rates(t, q, np.zeros(native.nv), k)
    demands: list[tuple[Matrix, Vector]] = [(constraint_matrix(native, t, q, k), -at_rest)]
    for strength in (Strength.GIVEN, Strength.GUESS):
        own = [target for target in targets if target.strength is strength]
        r, J = assembler.missed(own, q)
        demands.append((J, -r))
    for A, b in demands:
        if not len(A) or not free.size:
            continue
        rows = A @ free
        v = v + free @ np.linalg.lstsq(rows, b - A @ v, rcond=RANK)[0]
        free = free @ null_space(rows, rcond=RANK)
    if free.size:
        # least energy: free^T (M (v + free x) + momentum) = 0
        weighted = R @ free
        v = v - free @ np.linalg.solve(weighted.T @ weighted, free.T @ (R.T @ (R @ v) + momentum))
    return v
