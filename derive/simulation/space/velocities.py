"""Initial velocities in space: given values are kept, guesses come next, and others adapt with the least energy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import null_space

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import constraint_matrix, mass_matrix, max_norm
from derive.simulation.configurations import velocities_with
from derive.simulation.constraints.scaling import mass_factor
from derive.simulation.initial.targets import Strength
from derive.simulation.space.assembly import SpatialAssembler
from derive.simulation.space.targets import SpatialTarget

RANK = 1e-9
"""Singular values below this part of the largest count as zero."""


MET = 1e-8
"""Given values that are missed by less than this part of the velocities are met."""


def spatial_velocities(
    assembler: SpatialAssembler, q: Vector, targets: Sequence[SpatialTarget], momentum: Vector
) -> Vector:
    """The velocities (nv,) in a configuration that meet the constraints, then given targets, then guesses.

    Bodies deform only as targets say, unless the constraints and the given targets cannot be met otherwise. What is
    left free has the least kinetic energy 1/2 v . M v + momentum . v. Demands that contradict earlier ones are met in
    the sense of least squares.
    """
    native, t = assembler.native, assembler.t
    A = constraint_matrix(native, t, q, assembler.k)
    given, guessed = (
        assembler.missed([target for target in targets if target.strength is strength], q)
        for strength in (Strength.GIVEN, Strength.GUESS)
    )
    at_rest = native.constraint_rates(t, q, np.zeros(native.nv), assembler.k)
    demands = [(A, -at_rest), *((J, -r) for r, J in (given, guessed))]
    R = mass_factor(mass_matrix(native, q, assembler.k))
    stiff = ~velocities_with(native, Role.AMPLITUDE)
    stiff[[j for target in targets for j in target.amplitudes]] = True
    if not np.all(stiff):
        v = _least_energy(np.eye(native.nv)[:, stiff], demands, R, momentum)
        missed = max((max_norm(J @ v - b) for J, b in demands[:2] if len(J)), default=0.0)
        if missed <= MET * max(1.0, max_norm(v)):
            return v
    return _least_energy(np.eye(native.nv), demands, R, momentum)


def _least_energy(free: Matrix, demands: Sequence[tuple[Matrix, Vector]], R: Matrix, momentum: Vector) -> Vector:
    """The velocities (nv,) in the columns of `free` that meet demands A v = b in their order, with least energy."""
    v = np.zeros(len(free))
    for A, b in demands:
        if not len(A) or not free.size:
            continue
        rows = A @ free
        v = v + free @ np.linalg.lstsq(rows, b - A @ v, rcond=RANK)[0]
        free = free @ null_space(rows, rcond=RANK)
    if free.size:
        # free^T (M (v + free x) + momentum) = 0
        weighted = R @ free
        v = v - free @ np.linalg.solve(weighted.T @ weighted, free.T @ (R.T @ (R @ v) + momentum))
    return v
