"""The fit of targets on constraints: the configuration that misses guesses and defaults least."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space, solve_triangular

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import (
    Constraints,
    Mask,
    constraint_matrix,
    coordinates_with,
    mass_matrix,
    max_norm,
)
from derive.simulation.constraints.closest_state import closest_state
from derive.simulation.constraints.scaling import SINGULAR, in_mass_metric, mass_factor
from derive.simulation.initial.assembler import Assembler
from derive.simulation.initial.kinematics import Linear
from derive.simulation.initial.targets import Strength, Target

DEFAULT_WEIGHT = 1e-3
"""The weight of defaults of positions beside guesses, and beside the deformation of bodies."""
ITERATIONS = 50
LARGEST_STEP = 0.3
"""rad, and part of the size: the largest change in one iteration."""
NEWTON_STEPS, NEWTON_CONVERGED = 12, 1e-14
FAST = 0.5
"""The factor by which each step of a fit that converges fast enough is shorter than the one before."""
SMALL_STEP, SMALLEST_STEP = 1e-3, 1e-13
"""Steps up to the first are left to the polishing, which steps up to the second do not need."""


def weight(target: Target) -> float:
    """The weight of a target in the sum of squares."""
    return DEFAULT_WEIGHT if target.strength is Strength.DEFAULT and target.amplitude is None else 1.0


@dataclass(frozen=True, eq=False)
class TargetFit:
    """Targets (n) that are fitted on the constraints of a system, by the coordinates that are `free`.

    The method of Gauss and Newton converges linearly where targets remain missed; where it does so slowly, the last
    digits are those of a root of its step.
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
        kinematics = self.assembler.values(q)
        return float(np.linalg.norm([self._deviation(target, target.function(kinematics)) for target in self.targets]))

    def tangent(self, q: Vector) -> Matrix:
        """The motions (nq, f) of unit kinetic energy that the constraints allow."""
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
        """The configuration near q in which the Gauss-Newton step vanishes; q where no step is short, far from such."""
        step = self.step(q)
        if self.length(step) > LARGEST_STEP:
            return q
        for _ in range(ITERATIONS):
            if self.length(step) <= SMALLEST_STEP:
                return q
            trial = self.on_constraints(q + step)
            after = self.step(trial)
            if self.length(after) > FAST * self.length(step):
                break
            q, step = trial, after
        tangent = self.tangent(q)
        inverse = np.linalg.pinv(tangent)

        def displaced(y: Vector) -> Vector:
            return self.on_constraints(q + tangent @ y)

        from scipy.optimize import root

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
        """The weighted deviations of the targets from their values (n,), and their derivatives (n, nq)."""
        kinematics = self.assembler.kinematics(q)
        values, gradients = np.zeros(len(self.targets)), np.zeros((len(self.targets), len(q)))
        for i, target in enumerate(self.targets):
            linear = target.function(kinematics)
            values[i], gradients[i] = self._deviation(target, linear), self._factor(target) * linear.gradient
        return values, gradients

    def _deviation(self, target: Target, linear: Linear) -> float:
        return self._factor(target) * (linear.value - target.value)

    def _factor(self, target: Target) -> float:
        return weight(target) / self.assembler.unit(target)
