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
from derive.simulation.constraints.scaling import SINGULAR, in_mass_metric, mass_factor
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
"""The weight of defaults of positions beside guesses, and beside the deformation of bodies."""
FURTHER = (1.5, 3.0)
"""rad: further changes of rotations, from which other ways of closing a mechanism are found."""
NEAR = 0.5
"""rad: a mechanism whose bodies have their guessed rotations up to this is closed in the way that is meant."""
ITERATIONS = 50
LARGEST_STEP = 0.3
"""rad, and part of the size: the largest change in one iteration."""
NEWTON_STEPS, NEWTON_CONVERGED = 12, 1e-14
SMALL_STEP, SMALLEST_STEP = 1e-3, 1e-13
"""Steps up to the first are left to the polishing, which steps up to the second do not need."""


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

    def kinematics(self, q: Vector, moving: bool = False) -> Kinematics:
        """The poses in a configuration (nq,); with `moving`, also how drives change them."""
        return Kinematics(self.native, self.k, self.t, q, self.size, moving)

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
        closed: list[tuple[_Fit, Vector, tuple[Misfit, ...]]] = []
        for start in _starts(native, guess):
            state, misfits = _closest(assembler, start, given, free)
            if not state.converged:
                open_states.append(state)
                continue
            if deformed:
                check_deformation(state.q)
            if max_norm(np.array([misfit.relative for misfit in misfits])) <= ROUNDING:
                kept = WithTargets(assembler, [replace(misfit.target, value=misfit.value) for misfit in misfits])
                fit = _Fit(assembler, kept, _adapting(targets, deformed), free)
                q = fit.fitted(state.q)
                closed.append((fit, q, tuple(misfit for misfit in misfits if abs(misfit.relative) > EXACT)))
                if _is_near(assembler, targets, q):
                    break
            else:
                missed.append(misfits)
        if closed:
            fit, q, corrected = min(closed, key=lambda each: _distance(assembler, targets, each[1]))
            q = fit.polished(q)
            return Assembly(q, corrected, max_norm(native.constraints(assembler.t, q, assembler.k)), deformed)
        if missed:
            raise contradiction(min(missed, key=lambda of: max(abs(misfit.relative) for misfit in of)), "positions")
    best = min(open_states, key=lambda state: state.error)
    raise InconsistentInitialState("positions", unmet_constraints(native, best.g, CONSISTENT), assembler.t)


def _starts(native: NativeScene, guess: Vector) -> Iterator[Vector]:
    """The guess, and guesses with rotations changed, from which bars that lie in one line can be assembled."""
    yield guess
    for angle in (*PERTURBATIONS, *FURTHER):
        yield perturbed(native, guess, angle, np.ones(native.nq, dtype=bool))


def _is_near(assembler: Assembler, targets: Sequence[Target], q: Vector) -> bool:
    """Whether all bodies have about the rotation that is given or guessed, so that no other assembly is nearer."""
    rotations = [target for target in targets if target.angular]
    return all(abs(misfit.relative) <= NEAR for misfit in assembler.misfits(rotations, q))


def _distance(assembler: Assembler, targets: Sequence[Target], q: Vector) -> tuple[float, float]:
    """How far guesses and defaults are missed; of mirror images, the one with rotations to the left comes first."""
    misfits = assembler.misfits([target for target in targets if target.strength is not Strength.GIVEN], q)
    squares = sum(_weight(misfit.target) ** 2 * misfit.relative**2 for misfit in misfits)
    return round(squares, 9), -round(sum(misfit.relative for misfit in misfits if misfit.target.angular), 6)


def _weight(target: Target) -> float:
    """That of a target in the sum of squares."""
    return DEFAULT_WEIGHT if target.strength is Strength.DEFAULT and target.amplitude is None else 1.0


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
            fit = _Fit(assembler, native, given, free)
            q = fit.polished(fit.fitted(state.q))
            return ClosestState(q, native.constraints(t, q, k)), assembler.misfits(given, q)
    return state, ()


def _adapting(targets: Sequence[Target], deformed: bool) -> list[Target]:
    """The guesses and defaults; of deformations only if they have to change."""
    soft = (target for target in targets if target.strength is not Strength.GIVEN)
    return [target for target in soft if deformed or target.amplitude is None]


@dataclass(frozen=True, eq=False)
class _Fit:
    """Targets (n) that are fitted on the constraints of a system, by the coordinates that are `free`.

    The method of Gauss and Newton converges linearly where targets remain missed, so that the last digits are those of
    a root of its step.
    """

    assembler: Assembler
    system: Constraints
    targets: Sequence[Target]
    free: Mask

    def fitted(self, q: Vector) -> Vector:
        """The configuration near q (nq,) that misses the targets least, up to SMALL_STEP."""
        step = self.step(q)
        for _ in range(ITERATIONS):
            length = self.length(step)
            if length <= SMALL_STEP:
                break
            step = step * min(1.0, LARGEST_STEP / length)
            before, trial = self.missed(q), q
            for halving in range(12):
                trial = self.on_constraints(q + 0.5**halving * step)
                if self.missed(trial) <= before:
                    break
            q = trial
            step = self.step(q)
        return q

    def missed(self, q: Vector) -> float:
        """The weighted root of the sum of squares by which the targets are missed."""
        return float(np.linalg.norm(self._linearised(q)[0]))

    def tangent(self, q: Vector) -> Matrix:
        """(nq, f): motions of unit kinetic energy that the constraints allow."""
        k, t, free = self.assembler.k, self.assembler.t, self.free
        R = mass_factor(mass_matrix(self.system, q, k)[np.ix_(free, free)])
        rows = in_mass_metric(constraint_matrix(self.system, t, q, k)[:, free], R)
        norms = np.linalg.norm(rows, axis=1)
        scaled = rows / np.where(norms > 0.0, norms, 1.0)[:, None]
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

    def polished(self, q: Vector) -> Vector:
        """The configuration near q in which the Gauss-Newton step vanishes."""
        step = self.step(q)
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
        """The configuration next to q that meets the constraints, by Newton's method if it converges."""
        k, t, free = self.assembler.k, self.assembler.t, self.free
        R = mass_factor(mass_matrix(self.system, q, k)[np.ix_(free, free)])
        moved = q.copy()
        for _ in range(NEWTON_STEPS):
            g = self.system.constraints(t, moved, k)
            if max_norm(g) <= NEWTON_CONVERGED * max(1.0, max_norm(moved)):
                return moved
            rows = in_mass_metric(constraint_matrix(self.system, t, moved, k)[:, free], R)
            moved[free] -= solve_triangular(R, np.linalg.lstsq(rows, g, rcond=SINGULAR)[0])
        return closest_state(self.system, k, t, q, free).q

    def _linearised(self, q: Vector) -> tuple[Vector, Matrix]:
        """How far the targets are missed (n,), weighted, and its derivatives (n, nq)."""
        kinematics = self.assembler.kinematics(q)
        values, gradients = np.zeros(len(self.targets)), np.zeros((len(self.targets), len(q)))
        for i, target in enumerate(self.targets):
            linear, weight = target.function(kinematics), _weight(target) / self.assembler.unit(target)
            values[i], gradients[i] = weight * (linear.value - target.value), weight * linear.gradient
        return values, gradients
