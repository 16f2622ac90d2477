"""Initial velocities: given values are kept, and the others adapt with the least kinetic energy.

A mechanism that is set into motion by impulses at the points whose velocities are prescribed has the least kinetic
energy of all motions with these velocities (Kelvin's theorem).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space, solve_triangular

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import Mask, constraint_matrix, coordinates_with, mass_matrix, max_norm
from derive.simulation.constraints.closest_state import RATES_CONSISTENT, unmet_constraints
from derive.simulation.constraints.redundancy import check_constraints
from derive.simulation.constraints.scaling import SINGULAR, in_mass_metric, mass_factor, typical_row_norms
from derive.simulation.errors import InconsistentInitialState
from derive.simulation.initial.assembler import Assembler
from derive.simulation.initial.assembly import EXACT, ROUNDING
from derive.simulation.initial.contradictions import Conflict, Misfit, contradiction
from derive.simulation.initial.targets import Strength, Target

INDEPENDENT = 1e-9
"""Singular values of targets below this part of the largest count as zero."""


@dataclass(frozen=True, eq=False)
class Velocities:
    """Velocities v (nv,) that meet the constraints. misfits: given values that are corrected; error: the largest |gdot|
    (m/s, rad/s); deforming: whether rates of deformations had to change from those that are given."""

    v: Vector
    misfits: tuple[Misfit, ...]
    error: float
    deforming: bool


def velocities(
    assembler: Assembler,
    q: Vector,
    targets: Sequence[Target],
    momentum: Vector,
    conflict: Callable[[Vector, Sequence[Target]], Conflict],
) -> Velocities:
    """The velocities in the configuration q (nq,) that keep the given targets; guesses come next, then least energy.

    momentum: the generalised momentum (nv,) at v = 0, which bodies on moving supports have: the kinetic energy is
    1/2 v . M v + momentum . v and a constant. Bodies deform only if the constraints cannot be met otherwise. conflict:
    finds the joints, drives and given targets that contradict each other, near velocities (nv,).

    Raises SpecError with the given values that contradict each other by more than rounding, InconsistentInitialState
    with the constraints that cannot be met.
    """
    native, k, t = assembler.native, assembler.k, assembler.t
    given = [target for target in targets if target.strength is Strength.GIVEN]
    amplitudes = coordinates_with(native, Role.AMPLITUDE)
    amplitudes[[target.amplitude for target in targets if target.amplitude is not None]] = False
    missed: list[tuple[tuple[Misfit, ...], Vector]] = []
    v = np.zeros(native.nv)
    if not targets and not np.any(momentum) and not np.any(native.constraint_rates(t, q, v, k)):
        return Velocities(v, (), 0.0, False)
    for free in (~amplitudes, np.ones_like(amplitudes)) if np.any(amplitudes) else (~amplitudes,):
        problem = _Linear(assembler, q, free, momentum)
        v = problem.solution(given, [target for target in targets if target.strength is Strength.GUESS])
        error = max_norm(native.constraint_rates(t, q, v, k))
        if not error <= RATES_CONSISTENT * max(1.0, max_norm(v)):
            continue
        misfits = problem.misfits(given, v)
        if max_norm(np.array([misfit.relative for misfit in misfits])) <= ROUNDING:
            corrected = tuple(misfit for misfit in misfits if abs(misfit.relative) > EXACT)
            return Velocities(v, corrected, error, bool(np.all(free)) and bool(np.any(amplitudes)))
        missed.append((misfits, v))
    if missed:
        misfits, v = min(missed, key=lambda of: max(abs(misfit.relative) for misfit in of[0]))
        raise contradiction(misfits, "velocities", conflict(v, given))
    check_constraints(native, k, t, q)
    unmet = unmet_constraints(native, native.constraint_rates(t, q, v, k))
    raise InconsistentInitialState("velocities", unmet, t, conflict(v, given).text)


class _Linear:
    """Linear least squares in the velocities x = R v of the coordinates that are `free`, one target after the other."""

    def __init__(self, assembler: Assembler, q: Vector, free: Mask, momentum: Vector) -> None:
        native, k, t = assembler.native, assembler.k, assembler.t
        self.assembler, self.q, self.free, self.momentum = assembler, q, free, momentum[free]
        self.kinematics = assembler.kinematics(q, moving=True)
        self.R = mass_factor(mass_matrix(native, q, k)[np.ix_(free, free)])
        norms = typical_row_norms(native, k, t, q, self.R, free)
        self.rows = in_mass_metric(constraint_matrix(native, t, q, k)[:, free], self.R) / norms[:, None]
        self.norms = norms

    def solution(self, given: Sequence[Target], guessed: Sequence[Target]) -> Vector:
        """The velocities v (nv,): constraints come first, then given targets, guesses, and the least kinetic energy."""
        native, k, t = self.assembler.native, self.assembler.k, self.assembler.t
        v = np.zeros(native.nv)
        for _ in range(2):  # the second time against rounding errors
            rates = native.constraint_rates(t, self.q, v, k) / self.norms
            v[self.free] += self._in_coordinates(_least_squares(self.rows, -rates, SINGULAR)) if rates.size else 0.0
        allowed = null_space(self.rows, rcond=SINGULAR) if len(self.rows) else np.eye(len(self.R))
        for targets in (given, guessed):
            rows, missed = self._targets(targets, v)
            if not len(rows) or not allowed.size:
                continue
            v[self.free] += self._in_coordinates(allowed @ _least_squares(rows @ allowed, -missed, INDEPENDENT))
            allowed = allowed @ null_space(rows @ allowed, rcond=INDEPENDENT)
        if allowed.size:
            impulse = self.R @ v[self.free] + solve_triangular(self.R, self.momentum, trans="T")
            v[self.free] -= self._in_coordinates(allowed @ (allowed.T @ impulse))
        return v

    def misfits(self, targets: Sequence[Target], v: Vector) -> tuple[Misfit, ...]:
        """The targets with the rates that they have, relative to the largest velocity."""
        linears = [target.function(self.kinematics) for target in targets]
        rates = [float(linear.gradient @ v) + linear.drift for linear in linears]
        units = [self.assembler.unit(target) for target in targets]
        sizes = [abs(target.value) / unit for target, unit in zip(targets, units, strict=True)]
        largest = max(self.kinematics.largest_rate(v), *sizes, 0.0)
        return tuple(
            Misfit(target, rate, (rate - target.value) / unit / (largest or 1.0))
            for target, rate, unit in zip(targets, rates, units, strict=True)
        )

    def _targets(self, targets: Sequence[Target], v: Vector) -> tuple[Matrix, Vector]:
        """The rows (n, free) of targets in x, and how far v misses them, with lengths as parts of the size."""
        rows, missed = np.zeros((len(targets), len(self.R))), np.zeros(len(targets))
        for i, target in enumerate(targets):
            linear, unit = target.function(self.kinematics), self.assembler.unit(target)
            rows[i] = linear.gradient[self.free] / unit
            missed[i] = (float(linear.gradient @ v) + linear.drift - target.value) / unit
        return in_mass_metric(rows, self.R), missed

    def _in_coordinates(self, x: Vector) -> Vector:
        return np.asarray(solve_triangular(self.R, x))


def _least_squares(rows: Matrix, right: Vector, independent: float) -> Vector:
    return np.asarray(np.linalg.lstsq(rows, right, rcond=independent)[0])
