"""Assembly in space: the configuration that meets the joints, keeps what is given, and comes near to guesses.

Changes are those of `configurations`: three for each rotation. Distances are measured in poses of bodies.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space

from derive.ir.patterns import Pattern, pattern
from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import constraint_matrix, max_norm
from derive.simulation.configurations import QUATERNION, Mask, blocks, displaced, velocities_with
from derive.simulation.constraints.closest_state import CONSISTENT, ClosestState, closest_state, perturbed
from derive.simulation.initial.targets import Strength
from derive.simulation.space.poses import SpatialPoses
from derive.simulation.space.targets import SpatialTarget

PERTURBATIONS = (0.0, 0.05, 0.2, 0.5, 1.5, 3.0)
"""Perturbations (rad) of a guess from which the iteration does not converge."""
ITERATIONS = 60
SMALL = 1e-12
LARGEST = 0.3
"""rad, and part of the size: the largest change in one step of the fit."""
RANK = 1e-9
DECREASE = 1e-12
"""The least relative decrease of deviations in a step, after which the fit goes on."""
SLOW = 1e-3
"""The same where bodies deform, which lets many configurations come about as near to the guesses."""
HALVINGS = 12


@dataclass(frozen=True, eq=False)
class SpatialAssembler:
    """A scene to be assembled at the time t (s): its kernels, the constants k (nk,) and its size (m)."""

    native: NativeScene
    k: Vector
    t: float
    size: float

    def poses(self, q: Vector) -> SpatialPoses:
        """The poses in a configuration."""
        return SpatialPoses(self.native, self.k, self.t, q, self.size)

    def missed(self, targets: Sequence[SpatialTarget], q: Vector) -> tuple[Vector, Matrix]:
        """The deviations (n,) of targets in rad and in sizes of the scene, and their derivatives (n, nv)."""
        poses = self.poses(q)
        parts = [(target, *target.linearised(poses)[:2]) for target in targets]
        scales = [1.0 if target.angular else self.size for target, _, _ in parts]
        values = [r / scale for (_, r, _), scale in zip(parts, scales, strict=True)]
        rows = [J / scale for (_, _, J), scale in zip(parts, scales, strict=True)]
        if not parts:
            return np.zeros(0), np.zeros((0, self.native.nv))
        return np.concatenate(values), np.vstack(rows)


class WithSpatialTargets:
    """The constraints of a compiled scene, and the constraints that targets have their values."""

    def __init__(self, assembler: SpatialAssembler, targets: Sequence[SpatialTarget]) -> None:
        native = assembler.native
        self._assembler, self._native, self._targets = assembler, native, tuple(targets)
        self.nq, self.nv, self.roles = native.nq, native.nv, native.roles
        self.mass_pattern = native.mass_pattern
        rows = native.nlambda + sum(_size(target) for target in targets)
        self.constraint_pattern: Pattern = pattern(rows, self.nv, {(i, j) for i in range(rows) for j in range(self.nv)})
        self._last: tuple[bytes, tuple[Vector, Matrix]] | None = None

    def mass(self, q: Vector, k: Vector) -> Vector:
        """Values of the lower triangle of M."""
        return self._native.mass(q, k)

    def constraints(self, t: float, q: Vector, k: Vector) -> Vector:
        """The constraints g, and the deviations of the targets from their values."""
        return np.concatenate([self._native.constraints(t, q, k), self._missed(q)[0]])

    def constraint_jacobian(self, t: float, q: Vector, k: Vector) -> Vector:
        """Values of the derivatives of `constraints` by the velocities, by columns."""
        return np.vstack([constraint_matrix(self._native, t, q, k), self._missed(q)[1]]).T.ravel()

    def _missed(self, q: Vector) -> tuple[Vector, Matrix]:
        """The deviations of the targets and their derivatives, computed once for both of an iteration."""
        if self._last is None or self._last[0] != q.tobytes():
            self._last = q.tobytes(), self._assembler.missed(self._targets, q)
        return self._last[1]


def _size(target: SpatialTarget) -> int:
    """The number of components of a target; a quaternion is compared by a vector of three."""
    return len(target.values) if target.amplitudes or not target.angular or len(target.values) == 1 else 3


@dataclass(frozen=True, eq=False)
class SpatialAssembly:
    """The result: the state of the iteration, with all given values if `kept`, and whether deformations changed."""

    state: ClosestState
    kept: bool
    deformed: bool


def assembled(assembler: SpatialAssembler, guess: Vector, targets: Sequence[SpatialTarget]) -> SpatialAssembly:
    """The configuration next to a guess (nq,) that meets the joints and the given targets, and comes near to guesses.

    Where there is none, the result is not converged; where there is one only without the given targets, not `kept`.
    """
    native, k, t = assembler.native, assembler.k, assembler.t
    given = [target for target in targets if target.strength is Strength.GIVEN]
    soft = [target for target in targets if target.strength is not Strength.GIVEN]
    rigid = ~velocities_with(native, Role.AMPLITUDE)
    given_amplitudes = [j for target in given for j in target.amplitudes]
    rigid[given_amplitudes] = True
    masks = (rigid,) if np.all(rigid) else (rigid, np.ones_like(rigid))
    best: ClosestState | None = None
    for system, kept in ((WithSpatialTargets(assembler, given), True), (native, False)):
        for free in masks:
            closed = []
            for angle in PERTURBATIONS:
                start = perturbed(native, guess, angle, rigid) if angle else guess
                state = closest_state(system, k, t, start, free)
                if not state.converged:
                    best = state if kept and (best is None or state.error < best.error) else best
                    continue
                near = _fitted(assembler, system, soft, state.q, free, free is not rigid)
                q = _unwound(assembler, system, soft, guess, near)
                fitted = ClosestState(q, native.constraints(t, q, k))
                closed.append((float(np.linalg.norm(assembler.missed(soft, q)[0])), fitted))
                if angle == 0.0 or free is not rigid:  # rigid bodies may be closed in ways that are far apart
                    break
            if closed:
                nearest = min(closed, key=lambda each: each[0])[1]
                return SpatialAssembly(nearest, kept, free is not rigid)
        if not given:
            break
    assert best is not None
    return SpatialAssembly(ClosestState(best.q, native.constraints(t, best.q, k)), False, False)


def _fitted(
    assembler: SpatialAssembler,
    system: WithSpatialTargets | NativeScene,
    soft: Sequence[SpatialTarget],
    q: Vector,
    free: Mask,
    deforming: bool,
) -> Vector:
    """The configuration near q on the constraints of a system that misses soft targets least, by Gauss-Newton steps.

    deforming: whether bodies deform to meet the constraints.
    """
    if not soft:
        return q
    native, k, t = assembler.native, assembler.k, assembler.t
    before, fewest = float("inf"), 0
    least = SLOW if deforming else DECREASE
    for _ in range(ITERATIONS):
        r, J = assembler.missed(soft, q)
        error = float(np.linalg.norm(r))
        if not error < before * (1 - least):
            break
        before = error
        step = _step(constraint_matrix(system, t, q, k)[:, free], r, J[:, free])
        length = max_norm(step)
        if length <= SMALL:
            break
        change = np.zeros(native.nv)
        change[free] = step * min(1.0, LARGEST / length)
        for halving in range(fewest, HALVINGS):
            trial = closest_state(system, k, t, displaced(native, q, 0.5**halving * change), free)
            if trial.converged and np.linalg.norm(assembler.missed(soft, trial.q)[0]) <= error:
                q, fewest = trial.q, max(0, halving - 1)
                break
        else:
            break
    return q


def _unwound(
    assembler: SpatialAssembler,
    system: WithSpatialTargets | NativeScene,
    soft: Sequence[SpatialTarget],
    guess: Vector,
    q: Vector,
) -> Vector:
    """The configuration q without whole turns against the guess, which steps of an iteration may make.

    Where constraints or targets count turns, as those of a screw do, they stay. Signs of quaternions are those of the
    guess.
    """

    def missed(of: Vector) -> float:
        values = (system.constraints(assembler.t, of, assembler.k), assembler.missed(soft, of)[0])
        return max(max_norm(part) for part in values)

    for i, _, role in blocks(assembler.native):
        trial = q.copy()
        if role is Role.QUATERNION and q[i : i + QUATERNION] @ guess[i : i + QUATERNION] < 0:
            trial[i : i + QUATERNION] *= -1
        elif role is Role.ROTATION and (turns := round((q[i] - guess[i]) / (2 * np.pi))):
            trial[i] -= 2 * np.pi * turns
        else:
            continue
        if missed(trial) <= missed(q) + CONSISTENT:
            q = trial
    return q


def _step(G: Matrix, r: Vector, J: Matrix) -> Vector:
    """The step that the constraints allow and after which the deviations are least, to first order."""
    tangent = null_space(G, rcond=RANK) if len(G) else np.eye(J.shape[1])
    if not tangent.size:
        return np.zeros(J.shape[1])
    return np.asarray(tangent @ np.linalg.lstsq(J @ tangent, -r, rcond=RANK)[0])
