"""Redundant and singular constraints: those that depend on others in every state, or in one state alone, by name."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import null_space, solve_triangular

from derive.lowering.redundancy import dependences
from derive.roles import Role
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import ConstrainedSystem, constraint_matrix, mass_matrix, max_norm, rounding
from derive.simulation.configurations import displaced, velocities_with, velocity_names
from derive.simulation.constraints.certificates import DEFINITE, independent, moves_mass
from derive.simulation.constraints.neighbouring_states import neighbouring_states
from derive.simulation.constraints.scaling import SINGULAR, Spectrum, mass_factor, spectrum
from derive.simulation.errors import InextensibleBeam, MasslessMotion, RedundantConstraints, SingularConfiguration

DependenceError = RedundantConstraints | SingularConfiguration | InextensibleBeam
"""The errors for constraints that depend on each other."""
CONTRADICTION = 1e-6
"""Accelerations miss constraints that contradict each other by more than this part of the terms of a constraint, whose
factors are at least as large (m, rad)."""
SHORT = 1e-4
"""s: the time over which the motion of all bodies is seen, for the size of their accelerations."""


def check_constraints(native: ConstrainedSystem, k: Vector, t: float, q: Vector, drives: Sequence[str] = ()) -> None:
    """Raise an error if multipliers or accelerations of the consistent configuration q (nq,) at t (s) are not unique.

    The multipliers need not be unique where the system is `proximal`; but a beam whose ends are both
    fixed along its axis would be kept straight, since deflections change its length to second order. The errors are
    those of `dependence`, for the same drives, and MasslessMotion: the constraints allow a motion that moves no mass.
    """
    if independent(native, k, t, q):
        return  # it takes for granted that all motions have mass
    error = dependence(native, k, t, q, drives)
    if error is not None and (not native.proximal or isinstance(error, InextensibleBeam)):
        raise error
    _check_mass(native, k, t, q)


def check_accelerations(native: NativeScene, k: Vector, t: float, q: Vector, v: Vector) -> None:
    """Raise the error of `dependence` if the motion is not determined in the state q (nq,), v (nv,) at t (s).

    Constraints may contradict each other, or a mechanism may be at rest in a singular position, from which it can go on
    in several ways. A system that is not `proximal` has been refused by `check_constraints`. Constraints that no
    coordinate takes part in have been tried where they were derived, and what is left of their accelerations is that of
    rounded numbers.
    """
    if not native.proximal or independent(native, k, t, q):
        return
    error, G = dependence(native, k, t, q), constraint_matrix(native, t, q, k)
    if error is None:
        return
    vdot = native.accel(t, q, v, k)
    gamma, R = native.constraint_bias(t, q, v, k), mass_factor(mass_matrix(native, q, k))
    free = solve_triangular(R, solve_triangular(R, native.force(t, q, v, k), trans="T"))
    size = (np.abs(G) + CONTRADICTION) @ (np.abs(vdot) + np.abs(free)) + np.abs(gamma)
    limit = CONTRADICTION * (size + 1e-6 * np.max(size)) + rounding(q) * _accelerations(native, k, t, q, v)
    met_by_coordinates = np.isin(np.arange(native.nlambda), native.constraint_pattern.rowidx)
    if np.any((np.abs(G @ vdot - gamma) > limit)[met_by_coordinates]):
        raise error
    if isinstance(error, SingularConfiguration):
        rows = [name in error.multipliers for name in native.multipliers]
        if not np.any(np.abs(G[rows]) @ np.abs(v)):
            raise error


def _accelerations(native: NativeScene, k: Vector, t: float, q: Vector, v: Vector) -> float:
    """The size (m/s^2, rad/s^2) of accelerations of bodies in a state, also of those that drives prescribe.

    It is that of centripetal ones where all velocities are constant. Functions of time need not be defined before t.
    """
    poses = [native.poses(t + s, displaced(native, q, s * v), k) for s in (0.0, SHORT, 2 * SHORT)]
    speeds = (poses[1] - poses[0]) / SHORT
    changes = (poses[2] - 2 * poses[1] + poses[0]) / SHORT**2
    size = max(max_norm(v), max_norm(speeds)) ** 2 + max_norm(changes)
    return size if np.isfinite(size) else 0.0


def dependence(
    native: ConstrainedSystem, k: Vector, t: float, q: Vector, drives: Sequence[str] = ()
) -> DependenceError | None:
    """The error for constraints that depend on each other in the consistent configuration q (nq,) at t (s), if any.

    drives: names of multipliers that are released to reach neighbouring states. Constraints that depend on each other
    in q and in all neighbouring states are redundant (RedundantConstraints); those that do so in q alone make it a
    dead centre (SingularConfiguration), unless those of rigid bodies in place of beams do so in all states
    (InextensibleBeam). A mechanism that cannot move at all has redundant constraints.
    """
    singular = spectrum(native, k, t, q)
    if singular.rank == native.nlambda:
        return None
    around = [spectrum(native, k, time, state) for time, state in neighbouring_states(native, k, t, q, drives)]
    best = max(around, key=lambda s: (s.rank, s.smallest), default=singular)
    if best.rank < native.nlambda:
        return RedundantConstraints(dependences(best.scaled, best.rank, native.multipliers))
    multipliers = involved(singular, native.multipliers)
    if held_along_beams(native, k, t, q, drives):
        return InextensibleBeam(t, multipliers, native.in_space)
    return SingularConfiguration(t, singular.smallest, multipliers)


def held_along_beams(
    native: ConstrainedSystem, k: Vector, t: float, q: Vector, drives: Sequence[str] = (), limit: float = SINGULAR
) -> bool:
    """Whether constraints that depend on each other in q resist the extension of beams rather than a motion of bodies.

    Then the mechanism whose deformations are locked is no more singular in q than in all neighbouring states.
    limit: singular values up to it count as zero.
    """
    rigid = ~velocities_with(native, Role.AMPLITUDE)
    if np.all(rigid):
        return False

    def independent_ones(time: float, state: Vector) -> int:
        return int(np.sum(spectrum(native, k, time, state, rigid).values > limit))

    around = (independent_ones(*state) for state in neighbouring_states(native, k, t, q, drives, rigid))
    return max(around, default=0) <= independent_ones(t, q)


def involved(singular: Spectrum, names: Sequence[str], limit: float = SINGULAR) -> tuple[str, ...]:
    """The names of multipliers with a share above 1 % in singular values up to `limit`, or in the smallest one."""
    return tuple(name for name, share in zip(names, singular.participation(limit), strict=True) if share > 0.01)


def _check_mass(native: ConstrainedSystem, k: Vector, t: float, q: Vector) -> None:
    """Raise MasslessMotion if a motion that the constraints allow has no kinetic energy."""
    if moves_mass(native, k, q):
        return
    M, G = mass_matrix(native, q, k), constraint_matrix(native, t, q, k)
    size = np.sqrt(np.where(np.diag(M) > 0, np.diag(M), np.median(np.diag(M)) or 1.0))
    allowed = null_space(G / size) if len(G) else np.eye(native.nv)
    if not allowed.size:
        return
    values, vectors = np.linalg.eigh(allowed.T @ (M / np.outer(size, size)) @ allowed)
    if values[0] < DEFINITE:
        motion = np.abs(allowed @ vectors[:, 0])
        names = velocity_names(native)
        raise MasslessMotion([n for n, x in zip(names, motion, strict=True) if x > 0.01 * motion.max()])
