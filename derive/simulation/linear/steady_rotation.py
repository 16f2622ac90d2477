"""Steady rotation of a scene in space: a motion that is at rest in axes that rotate at a constant rate.

With the velocities v(q) and the accelerations W v(q) of such a motion (`rotating_field.py`), the coordinates and the
multipliers solve M W v + h - G^T lambda = 0 and g = 0. Newton's method finds them from the initial state, by the
generated iteration matrix. The axes are those of the velocities that the scene gives.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import constraint_matrix, mass_matrix, max_norm
from derive.simulation.configurations import (
    ROTATION,
    attitudes,
    difference,
    displaced,
    normalised,
    rate_matrix,
    velocities_with,
)
from derive.simulation.linear.rotating_field import RotatingField
from derive.simulation.linear.steady_motion import (
    ASIDE,
    BALANCED,
    CONVERGED,
    PAUSE,
    TURN,
    NoSteadyMotion,
    SteadyMotion,
    accelerations_in,
    differing,
    least_solution,
)

ITERATIONS = 100
LARGEST_STEP = 0.3
"""rad, and part of the size: the largest change in one iteration."""
NEAR = 1.0
"""rad: a steady rotation in which a body is rotated by more than this from the guess is not the one that is sought."""
ANGLES = 65
"""The number of configurations along one turn of the axes with which a steady rotation is compared."""


def steady_rotation(native: NativeScene, k: Vector, q: Vector, field: RotatingField, size: float) -> SteadyMotion:
    """The steady rotation with the velocities of a field, next to the configuration q (nq,), which meets the joints.

    k: the constants (nk,) of `native.setup`. size: of the scene, m. Raises NoSteadyMotion where Newton's method does
    not converge or goes far away, or where forces or joints depend on time or on directions that do not rotate along.
    """
    balanced = _balanced(native, k, q, field, size)
    turned = _turned(native, q, balanced, field)
    if turned.max(initial=0.0) > NEAR:
        name, angle = native.velocities[int(np.argmax(turned))], turned.max()
        raise NoSteadyMotion(
            f"the steady rotation that Newton's method finds is far from the initial state: a rotation along {name} by "
            f"{angle:.2g} rad; give bodies a start nearer to it"
        )
    _check_steady(native, k, balanced, field)
    return SteadyMotion(balanced, field.velocities(balanced), field.spin, field.axes, field.text(size), field.rotation)


def _turned(native: NativeScene, q: Vector, balanced: Vector, field: RotatingField) -> Vector:
    """The rotations (nv,), rad, from a configuration q (nq,) to the balanced one, apart from the motion itself.

    In a steady rotation all configurations that the motion passes are alike, and so are those in which a body that
    spins, or a joint that turns at a constant rate, has another angle.
    """
    times = np.linspace(0.0, 2 * np.pi / field.spin, ANGLES) if field.spin else (0.0,)
    every = (_aside(native, field.later(q, t), balanced, field) for t in times)
    return min(every, key=lambda rotations: float(rotations.max(initial=0.0)))


def _aside(native: NativeScene, q: Vector, balanced: Vector, field: RotatingField) -> Vector:
    """The rotations (nv,), rad, between two configurations, without those about the axes of spins of their own."""
    result = np.where(velocities_with(native, Role.ROTATION), difference(native, q, balanced), 0.0)
    turning = field.own != 0.0
    for _, j in attitudes(native):
        block = slice(j, j + ROTATION)
        spin, turning[block] = field.own[block], False
        if spin.any():
            result[block] -= spin * (spin @ result[block]) / (spin @ spin)
    return np.where(turning, 0.0, np.abs(result))


@dataclass(frozen=True, eq=False)
class Balance:
    """The forces in a configuration that moves with a field: f = M W v + h without reactions, and the loads in it."""

    force: Vector
    load: float
    G: Matrix

    @property
    def multipliers(self) -> Vector:
        """The multipliers (nlambda,) that balance the forces best."""
        return np.asarray(np.linalg.lstsq(self.G.T, self.force, rcond=None)[0])

    @property
    def rest(self) -> float:
        """The largest force that no multipliers balance, as a part of the loads."""
        return max_norm(self.force - self.G.T @ self.multipliers) / self.load if self.load > 0.0 else 0.0


def balance(native: NativeScene, k: Vector, q: Vector, field: RotatingField) -> Balance:
    """The forces in a configuration q (nq,) that moves with a field."""
    v = field.velocities(q)
    inertial, h = mass_matrix(native, q, k) @ field.axes @ v, native.force(0.0, q, v, k)
    return Balance(inertial + h, max(max_norm(inertial), max_norm(h)), constraint_matrix(native, 0.0, q, k))


def _balanced(native: NativeScene, k: Vector, q: Vector, field: RotatingField, size: float) -> Vector:
    """The configuration in which the forces balance, by Newton's method; motions without stiffness change the least."""
    n, nv, W = native.nq, native.nv, field.axes
    angles = velocities_with(native, Role.ROTATION)
    lam = balance(native, k, q, field).multipliers
    for _ in range(ITERATIONS):
        at, v = balance(native, k, q, field), field.velocities(q)
        residual, gap = at.force - at.G.T @ lam, native.constraints(0.0, q, k)
        if max_norm(residual) <= BALANCED * at.load and max_norm(gap) <= BALANCED * max(1.0, size):
            return q
        y = np.concatenate([q, v, lam])
        ydot = np.concatenate([native.rates(q, v, k), W @ v, np.zeros(len(lam))])
        J = native.jacobian_pattern.dense(native.jacobian(0.0, y, ydot, 0.0, k))[n : n + nv]
        D = field.gradient(q)
        stiffness = J[:, :n] @ rate_matrix(native, q, k) + (J[:, n : n + nv] + mass_matrix(native, q, k) @ W) @ D
        system = np.block([[stiffness, -at.G.T], [at.G, np.zeros((len(lam), len(lam)))]])
        change = least_solution(system, -np.concatenate([residual, gap]))
        moved = change[:nv]
        length = max(max_norm(moved[angles]), max_norm(moved[~angles]) / size)
        part = min(1.0, LARGEST_STEP / length) if length > 0.0 else 1.0
        q, lam = normalised(native, displaced(native, q, part * moved)), lam + part * change[nv:]
        if length <= CONVERGED:
            return q
    raise NoSteadyMotion("Newton's method does not find a steady rotation near the initial state")


def _check_steady(native: NativeScene, k: Vector, q: Vector, field: RotatingField) -> None:
    """Raise NoSteadyMotion if the accelerations are not those of the field, or change with time in the rotating axes.

    They must be the same in the state and beside it, since the force of a spring may vanish in the state itself. They
    are compared with those that the forces would cause without joints as well, since forces that balance each other on
    a body that joints hold leave rounding errors.
    """
    v, G = field.velocities(q), constraint_matrix(native, 0.0, q, k)
    pattern = np.where(velocities_with(native, Role.AMPLITUDE), 0.0, np.cos(1.0 + np.arange(native.nv)))
    aside, faster = (x - np.linalg.lstsq(G, G @ x, rcond=None)[0] for x in (pattern, pattern[::-1]))
    rate = 1.0 + max(field.rates, default=0.0)

    def accelerations(t: float, x: float) -> Vector:
        """The accelerations at the time t of the state that is displaced by x and has rotated along since then."""
        beside = displaced(native, q, x * aside)
        return accelerations_in(native, k, t, field.later(beside, t), field.carried(v + x * rate * faster, t))

    here, beside = accelerations(0.0, 0.0), accelerations(0.0, ASIDE)
    expected = field.axes @ v
    free = np.asarray(np.linalg.solve(mass_matrix(native, q, k), balance(native, k, q, field).force), dtype=np.float64)
    scale = max(max_norm(expected), max_norm(here), max_norm(beside - here) / ASIDE, max_norm(free))
    _compare(native, here, expected, scale, "is not steady")
    for t in sorted({TURN / rate for rate in field.rates} or {PAUSE}):
        for x, first in ((0.0, here), (ASIDE, beside)):
            later = accelerations(t, x)
            _compare(native, field.carried(later, -t), first, scale, f"changes until t = {t:.3g} s")


def _compare(native: NativeScene, a: Vector, expected: Vector, scale: float, what: str) -> None:
    """Raise NoSteadyMotion if accelerations differ by more than a part of the scale; what: the text on the motion."""
    if name := differing(native.velocities, a, expected, scale):
        raise NoSteadyMotion(
            f"the rotation {what}: the time derivative of {name} is not the same in axes that rotate with the scene, "
            "because a force, gravity, a spring, a joint, a drive, or a body that spins about an axis of which it is "
            "not symmetric, depends on time or on a direction in space"
        )
