"""Assembly: the configuration that meets the joints and drives, keeps what is given, and adapts the rest.

Distances are measured in poses of bodies, with lengths divided by the size of the scene, and not in the coordinates
that a scene keeps, on which the result therefore does not depend.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import null_space, solve_triangular
from scipy.optimize import root

from derive.ir.patterns import Pattern, pattern
from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import (
    Constraints,
    Mask,
    constraint_matrix,
    coordinates_with,
    mass_matrix,
    max_norm,
)
from derive.simulation.constraints.closest_state import CONSISTENT, ClosestState, closest_state
from derive.simulation.constraints.scaling import SINGULAR, in_mass_metric, mass_factor, typical_row_norms
from derive.simulation.errors import InconsistentInitialState
from derive.simulation.initial.consistent_state import PERTURBATIONS, perturbed, unmet_constraints
from derive.simulation.initial.contradictions import Misfit, contradiction
from derive.simulation.initial.kinematics import Kinematics
from derive.simulation.initial.targets import Strength, Target

ROUNDING = 1e-3
"""rad, and part of the size of the scene: given values that contradict each other by no more are corrected."""
EXACT = 1e-10
"""rad, and part of the size: differences below this are not worth a message."""
DEFAULT_WEIGHT = 1e-3
"""The weight of defaults beside guesses."""
ITERATIONS = 50
LARGEST_STEP = 0.3
"""rad, and part of the size: the largest change in one iteration."""
SMALL_STEP, SMALLEST_STEP = 1e-3, 1e-13
"""Below the first an iteration needs no line search and may be accelerated, below the second it is over."""


@dataclass(frozen=True, eq=False)
class Assembly:
    """A configuration q (nq,) on the constraints. misfits: given values that are corrected; error: the largest |g| (m,
    rad); deformed: whether deformations had to change from those that are given or guessed."""

    q: Vector
    misfits: tuple[Misfit, ...]
    error: float
    deformed: bool


@dataclass(frozen=True, eq=False)
class Assembler:
    """A scene to be assembled at the time t (s): its kernels, the constants k (nk,) and its size (m)."""

    native: NativeScene
    k: Vector
    t: float
    size: float

    def kinematics(self, q: Vector) -> Kinematics:
        """The poses in a configuration (nq,)."""
        return Kinematics(self.native, self.k, self.t, q, self.size)

    def unit(self, target: Target) -> float:
        """What counts as 1 of a target: 1 rad, or the size of the scene (m)."""
        return 1.0 if target.angular else self.size

    def misfits(self, targets: Sequence[Target], q: Vector) -> tuple[Misfit, ...]:
        """The targets with the values that they have in a configuration."""
        kinematics = self.kinematics(q)
        values = ((target, target.function(kinematics).value) for target in targets)
        return tuple(Misfit(target, value, (value - target.value) / self.unit(target)) for target, value in values)


class WithTargets:
    """The constraints of a compiled scene, and that targets have their values."""

    def __init__(self, assembler: Assembler, targets: Sequence[Target]) -> None:
        native = assembler.native
        self._assembler, self._native, self._targets = assembler, native, tuple(targets)
        self.nq, self.roles, self.mass_pattern = native.nq, native.roles, native.mass_pattern
        rows = native.nlambda + len(targets)
        self.constraint_pattern: Pattern = pattern(rows, self.nq, {(i, j) for i in range(rows) for j in range(self.nq)})

    def mass(self, q: Vector, k: Vector) -> Vector:
        """Values of the lower triangle of M."""
        return self._native.mass(q, k)

    def constraints(self, t: float, q: Vector, k: Vector) -> Vector:
        """g, and how far the targets are missed (m, rad)."""
        kinematics = self._assembler.kinematics(q)
        missed = [target.function(kinematics).value - target.value for target in self._targets]
        return np.concatenate([self._native.constraints(t, q, k), missed])

    def constraint_jacobian(self, t: float, q: Vector, k: Vector) -> Vector:
        """Values of the derivatives, by columns."""
        kinematics = self._assembler.kinematics(q)
        gradients = [target.function(kinematics).gradient for target in self._targets]
        return np.vstack([constraint_matrix(self._native, t, q, k), *gradients]).T.ravel()


def assemble(
    assembler: Assembler, guess: Vector, targets: Sequence[Target], check_deformation: Callable[[Vector], None]
) -> Assembly:
    """The configuration that keeps the given targets, and adapts to guesses and defaults what they leave free.

    guess: coordinates (nq,) from which the iteration begins. Bodies deform only where the joints cannot be met
    otherwise; check_deformation raises an error if they deform too far in a configuration (nq,).

    Raises SpecError with the given values that contradict each other by more than rounding, InconsistentInitialState
    with the constraints that cannot be met.
    """
    native = assembler.native
    given = [target for target in targets if target.strength is Strength.GIVEN]
    amplitudes = coordinates_with(native, Role.AMPLITUDE)
    amplitudes[[target.amplitude for target in given if target.amplitude is not None]] = False
    straight = ~amplitudes
    missed: list[tuple[Misfit, ...]] = []
    open_states: list[ClosestState] = []
    for free in (straight, np.ones_like(straight)) if np.any(amplitudes) else (straight,):
        deformed = free is not straight
        for start in _starts(native, guess):
            state, misfits = _closest(assembler, start, given, free)
            if not state.converged:
                open_states.append(state)
                continue
            if deformed:
                check_deformation(state.q)
            if max_norm(np.array([misfit.relative for misfit in misfits])) <= ROUNDING:
                kept = [replace(misfit.target, value=misfit.value) for misfit in misfits]
                q = _adapted(assembler, state.q, kept, targets, free, deformed)
                error = max_norm(native.constraints(assembler.t, q, assembler.k))
                return Assembly(q, tuple(m for m in misfits if abs(m.relative) > EXACT), error, deformed)
            missed.append(misfits)
        if missed:
            raise contradiction(min(missed, key=lambda of: max(abs(misfit.relative) for misfit in of)), "positions")
    best = min(open_states, key=lambda state: state.error)
    raise InconsistentInitialState("positions", unmet_constraints(native, best.g, CONSISTENT), assembler.t)


def _starts(native: NativeScene, guess: Vector) -> Iterator[Vector]:
    """The guess, and guesses with rotations changed, from which bars that lie in one line can be assembled."""
    yield guess
    for angle in PERTURBATIONS:
        yield perturbed(native, guess, angle, np.ones(native.nq, dtype=bool))


def _closest(
    assembler: Assembler, start: Vector, given: Sequence[Target], free: Mask
) -> tuple[ClosestState, tuple[Misfit, ...]]:
    """A configuration that misses the given targets least, on the constraints if there is one next to the start."""
    k, t, native = assembler.k, assembler.t, assembler.native
    state = closest_state(WithTargets(assembler, given), k, t, start, free)
    if state.converged:
        return state, tuple(Misfit(target, target.value, 0.0) for target in given)
    for begin in (state.q, start):
        state = closest_state(native, k, t, begin, free)
        if state.converged:
            q = _fitted(assembler, native, state.q, given, free)
            return ClosestState(q, native.constraints(t, q, k)), assembler.misfits(given, q)
    return state, ()


def _adapted(
    assembler: Assembler, q: Vector, kept: Sequence[Target], targets: Sequence[Target], free: Mask, deformed: bool
) -> Vector:
    """The configuration nearest to guesses and defaults among those on the constraints that keep what is given."""
    soft = [
        target for target in targets if target.strength is not Strength.GIVEN and (deformed or target.amplitude is None)
    ]
    return _fitted(assembler, WithTargets(assembler, kept), q, soft, free)


def _fitted(assembler: Assembler, system: Constraints, q: Vector, targets: Sequence[Target], free: Mask) -> Vector:
    """The configuration near q (nq,) on the constraints of a system that misses targets least: by Gauss and Newton.

    Where targets remain missed the convergence is linear; the last digits are those of a root of the Gauss-Newton step.
    """
    fit = _Fit(assembler, system, targets, free)
    step = fit.step(q)
    for _ in range(ITERATIONS):
        length = fit.length(step)
        if length <= SMALL_STEP:
            break
        step = step * min(1.0, LARGEST_STEP / length)
        before, trial = fit.missed(q), q
        for halving in range(12):
            trial = fit.on_constraints(q + 0.5**halving * step)
            if fit.missed(trial) <= before:
                break
        q = trial
        step = fit.step(q)
    return fit.root(q, step)


@dataclass(frozen=True, eq=False)
class _Fit:
    """Targets (n) that are fitted on the constraints of a system, by the coordinates that are `free`."""

    assembler: Assembler
    system: Constraints
    targets: Sequence[Target]
    free: Mask

    def missed(self, q: Vector) -> float:
        """The weighted root of the sum of squares by which the targets are missed."""
        return float(np.linalg.norm(self._linearised(q)[0]))

    def tangent(self, q: Vector) -> Matrix:
        """(nq, f): motions of unit kinetic energy that the constraints allow."""
        k, t, free = self.assembler.k, self.assembler.t, self.free
        R = mass_factor(mass_matrix(self.system, q, k)[np.ix_(free, free)])
        norms = typical_row_norms(self.system, k, t, q, R, free)
        scaled = in_mass_metric(constraint_matrix(self.system, t, q, k)[:, free], R) / norms[:, None]
        allowed = null_space(scaled, rcond=SINGULAR) if len(scaled) else np.eye(int(np.sum(free)))
        result = np.zeros((len(q), allowed.shape[1]))
        result[free] = solve_triangular(R, allowed)
        return result

    def step(self, q: Vector) -> Vector:
        """The Gauss-Newton step (nq,) along the constraints."""
        missed, gradients = self._linearised(q)
        tangent = self.tangent(q)
        if not tangent.size or not len(missed):
            return np.zeros_like(q)
        return np.asarray(tangent @ np.linalg.lstsq(gradients @ tangent, -missed, rcond=1e-9)[0])

    def root(self, q: Vector, step: Vector) -> Vector:
        """The configuration near q in which the Gauss-Newton step vanishes."""
        if self.length(step) <= SMALLEST_STEP:
            return q
        tangent = self.tangent(q)
        inverse = np.linalg.pinv(tangent)

        def displaced(y: Vector) -> Vector:
            return self.on_constraints(q + tangent @ y)

        result = root(lambda y: inverse @ self.step(displaced(y)), inverse @ step, method="hybr", tol=1e-14)
        return displaced(result.x)

    def length(self, step: Vector) -> float:
        """The largest change in a step (nq,): a rotation (rad), or a displacement as a part of the size."""
        angles = coordinates_with(self.system, Role.ROTATION)
        return max(max_norm(step[angles]), max_norm(step[~angles]) / self.assembler.size)

    def on_constraints(self, q: Vector) -> Vector:
        """The configuration next to q that meets the constraints."""
        return closest_state(self.system, self.assembler.k, self.assembler.t, q, self.free).q

    def _linearised(self, q: Vector) -> tuple[Vector, Matrix]:
        """How far the targets are missed (n,), weighted, and its derivatives (n, nq)."""
        kinematics = self.assembler.kinematics(q)
        values, gradients = np.zeros(len(self.targets)), np.zeros((len(self.targets), len(q)))
        for i, target in enumerate(self.targets):
            linear, weight = target.function(kinematics), 1.0 / self.assembler.unit(target)
            weight *= DEFAULT_WEIGHT if target.strength is Strength.DEFAULT else 1.0
            values[i], gradients[i] = weight * (linear.value - target.value), weight * linear.gradient
        return values, gradients
