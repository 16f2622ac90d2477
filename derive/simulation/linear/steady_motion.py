"""Steady motions of a scene: equilibria, and relative equilibria in axes that rotate at a constant speed.

In a steady motion the frames of all bodies move like one rigid body, which rotates at the speed w about a fixed point
or translates, while the deformations are constant:

    v = (d1 - w c2, d2 + w c1) for an origin (c1, c2), w for an angle, 0 for an amplitude.

Its coordinates and multipliers solve M a + h - G^T lambda = 0 and g = 0 with the velocities v(q) and the centripetal
accelerations a(q) of that field, which Newton's method finds from the initial state by the generated Jacobian.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from derive.roles import Role
from derive.runtime.native_call import Matrix, ModelError, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import constraint_matrix, coordinates_with, mass_matrix, max_norm
from derive.simulation.errors import SimulationError

ITERATIONS = 30
CONVERGED = 1e-10
"""An iteration ends Newton's method if it moves no coordinate by more than this, relative to those above 1."""
BALANCED = 1e-13
"""Out-of-balance forces below this part of the loads are rounding errors, which singular equations would amplify."""
RIGID = 1e-9
"""Velocities are those of a rigid motion if they differ from it by less than this part of the largest."""
TURN = 1.0
"""rad: the rotation after which the accelerations of a steady motion must be the same in the rotated axes."""
PAUSE = 1.0
"""s: the time after which the accelerations of a steady motion without rotation must be the same."""
SAME = 1e-6
"""Accelerations differ if their difference exceeds this part of the largest, or of those that 1 m or 1 rad cause."""
NEAR = 0.5
"""rad: a steady motion in which a frame is rotated by more than this from the guess is not the one that is sought."""
ASIDE = 1e-3
"""m, rad, and their rates times the spin: a displacement with which the accelerations must be the same as well."""


class NoSteadyMotion(SimulationError):
    """A scene has no steady motion from its initial state, or Newton's method does not reach one.

    reason: the text. advice: what is to be done, where it is long; it is behind the reason in the message.
    """

    def __init__(self, reason: str, advice: str = "") -> None:
        self.reason, self.advice = reason, advice
        super().__init__("; ".join(filter(None, (reason, advice))))


@dataclass(frozen=True, eq=False)
class SteadyMotion:
    """A state q (nq,), v (nv,) at t = 0 of a motion that is steady in axes that rotate at `spin` (rad/s).

    axes (nv, nv): the matrix that takes velocities which are constant in these axes to their time derivatives. text:
    the motion of the axes in words. rotation (3,): their angular velocity in space, rad/s; None in the plane.
    """

    q: Vector
    v: Vector
    spin: float
    axes: Matrix
    text: str
    rotation: Vector | None = None

    def __str__(self) -> str:
        """The motion in words."""
        return f"steady {self.text}"


def steady_motion(native: NativeScene, k: Vector, q: Vector, v: Vector, guess: Vector | None = None) -> SteadyMotion:
    """The steady motion near the state q (nq,), v (nv,) at t = 0, with the rigid velocities of that state.

    k: the constants (nk,) of `native.setup`. guess (nq,): where it is sought, if not at q. Raises NoSteadyMotion where
    the velocities are not those of a rigid motion, where Newton's method does not converge or goes far away, or where
    forces or drives depend on time or on the direction of the axes.
    """
    field = _rigid_field(native, q, v)
    first = q if guess is None else guess
    q = _balanced(native, k, first, field)
    turned = _turned(native, first, q, field)
    if turned.max(initial=0.0) > NEAR:
        name, angle = native.coordinates[int(np.argmax(turned))], turned.max()
        raise NoSteadyMotion(
            f"the steady motion that Newton's method finds is far from the initial state: {name} differs by "
            f'{angle:.2g} rad; give bodies a start nearer to it, or start = "equilibrium" in [scene]'
        )
    _check_steady(native, k, q, field)
    return SteadyMotion(q, field.velocities(q), field.spin, field.spin * field.E, str(field))


def _turned(native: NativeScene, first: Vector, q: Vector, field: _RigidField) -> Vector:
    """The rotations (nq,), rad, between two configurations, apart from that of the steady rotation, which all share."""
    angles, change = coordinates_with(native, Role.ROTATION), q - first
    common = (change[angles].max() + change[angles].min()) / 2 if field.spin and angles.any() else 0.0
    return np.where(angles, np.abs(change - common), 0.0)


def rotating_axes(native: NativeScene) -> Matrix:
    """The matrix E (nv, nv) of w x for the spin 1: (0, -1; 1, 0) at both coordinates of each origin."""
    E = np.zeros((native.nv, native.nv))
    for first, second in _origins(native):
        E[first, second], E[second, first] = -1.0, 1.0
    return E


def _origins(native: NativeScene) -> list[tuple[int, int]]:
    """The indices of both coordinates of the origin of each body that has them."""
    places = np.flatnonzero(coordinates_with(native, Role.TRANSLATION))
    if len(places) % 2:
        raise NoSteadyMotion("a body has one coordinate of its position alone, whose axes do not rotate")
    return [(int(a), int(b)) for a, b in zip(places[::2], places[1::2], strict=True)]


@dataclass(frozen=True, eq=False)
class _RigidField:
    """The velocities of a rigid motion, v(q) = shift + spin E q; `shift` (nv,) has the translation and angle rates."""

    shift: Vector
    spin: float
    E: Matrix

    def velocities(self, q: Vector) -> Vector:
        return np.asarray(self.shift + self.spin * self.E @ q)

    def accelerations(self, q: Vector) -> Vector:
        return np.asarray(self.spin * self.E @ self.velocities(q))

    def __str__(self) -> str:
        return f"rotation with {self.spin:.6g} rad/s" if self.spin else "translation" if self.shift.any() else "rest"


def _rigid_field(native: NativeScene, q: Vector, v: Vector) -> _RigidField:
    """The rigid motion whose velocities are v (nv,)."""
    E, angles = rotating_axes(native), coordinates_with(native, Role.ROTATION)
    spin = float(np.mean(v[angles])) if angles.any() else 0.0
    shift = np.where(angles, spin, 0.0)
    rest = v - spin * E @ q
    for part in map(list, zip(*_origins(native), strict=True)):
        shift[part] = np.mean(rest[part])
    field = _RigidField(shift, spin, E)
    off = np.abs(field.velocities(q) - v)
    if off.max(initial=0.0) > RIGID * max_norm(v):
        name = native.coordinates[int(np.argmax(off))]
        text = (
            f"the rate of {name} is not that of a rigid rotation of the whole scene, so that the motion is not steady"
        )
        raise NoSteadyMotion(f"{text}; give velocities of a rigid motion, or none")
    return field


def _balanced(native: NativeScene, k: Vector, q: Vector, field: _RigidField) -> Vector:
    """The coordinates in which the forces balance, by Newton's method; motions without stiffness change the least."""
    n = native.nq
    lam = native.solve(0.0, q, field.velocities(q), k)[1]
    for _ in range(ITERATIONS):
        v, a = field.velocities(q), field.accelerations(q)
        y, ydot = np.concatenate([q, v, lam]), np.concatenate([v, a, np.zeros(len(lam))])
        J = native.jacobian_pattern.dense(native.jacobian(0.0, y, ydot, 0.0, k))[n : 2 * n]
        M, G = mass_matrix(native, q, k), constraint_matrix(native, 0.0, q, k)
        h, gap = native.force(0.0, q, v, k), native.constraints(0.0, q, k)
        residual, load = M @ a + h - G.T @ lam, max(max_norm(M @ a), max_norm(h))
        if max_norm(residual) <= BALANCED * load and max_norm(gap) <= BALANCED * max(1.0, max_norm(q)):
            return q
        stiffness = J[:, :n] + field.spin * J[:, n : 2 * n] @ field.E + field.spin**2 * M @ field.E @ field.E
        system = np.block([[stiffness, -G.T], [G, np.zeros((len(G), len(G)))]])
        right = -np.concatenate([residual, gap])
        change = least_solution(system, right)
        q, lam = q + change[:n], lam + change[n:]
        if np.all(np.abs(change[:n]) <= CONVERGED * np.maximum(1.0, np.abs(q))):
            return q
    raise NoSteadyMotion("Newton's method does not find a steady motion near the initial state")


ROUNDING = 4 * float(np.finfo(np.float64).eps)
"""The part of the largest number of a system below which a row has rounding errors alone."""


def least_solution(system: Matrix, right: Vector) -> Vector:
    """The least solution of a system whose rows are scaled to 1, as forces and positions have different units.

    Rows of rounding errors are left out: scaled to 1, they would determine motions without stiffness.
    """
    if not (np.isfinite(system).all() and np.isfinite(right).all()):
        raise NoSteadyMotion("Newton's method leaves the states that the model describes")
    rows = np.abs(system).max(axis=1)
    some = rows > ROUNDING * rows.max(initial=0.0)
    scaled = rows[some]
    return np.asarray(np.linalg.lstsq(system[some] / scaled[:, None], right[some] / scaled, rcond=1e-13)[0])


def _check_steady(native: NativeScene, k: Vector, q: Vector, field: _RigidField) -> None:
    """Raise NoSteadyMotion if the accelerations are not those of the field, or change with time in the rotating axes.

    They must be the same in the state and beside it, since the force of a spring may vanish in the state itself.
    """
    t = TURN / abs(field.spin) if field.spin else PAUSE
    angles = coordinates_with(native, Role.ROTATION)
    Q = _rotation(native, field.spin * t)
    along = np.where(angles, 0.0, field.shift)
    centre = field.E @ along / field.spin if field.spin else np.zeros(native.nq)
    moved = centre + Q @ (q - centre) + (0.0 if field.spin else t * along)
    moved[angles] += field.spin * t
    pattern = np.where(coordinates_with(native, Role.AMPLITUDE), 0.0, np.cos(1.0 + np.arange(native.nq)))
    v, a = field.velocities(q), field.accelerations(q)
    displaced = [(q + x * pattern, v + x * (1.0 + abs(field.spin)) * pattern[::-1]) for x in (0.0, ASIDE)]
    here, beside = (accelerations_in(native, k, 0.0, *state) for state in displaced)
    scale = max(max_norm(a), max_norm(here), max_norm(beside - here) / ASIDE)
    _compare(native, here, a, scale, "is not steady")
    for (dq, dv), expected in zip(displaced, (here, beside), strict=True):
        later = accelerations_in(native, k, t, moved + Q @ (dq - q), Q @ dv)
        _compare(native, later, Q @ expected, scale, f"changes until t = {t:.3g} s")


def _rotation(native: NativeScene, angle: float) -> Matrix:
    """The matrix (nq, nq) that rotates both coordinates of each origin."""
    Q = np.eye(native.nq)
    cos, sin = math.cos(angle), math.sin(angle)
    for first, second in _origins(native):
        Q[first, first] = Q[second, second] = cos
        Q[first, second], Q[second, first] = -sin, sin
    return Q


def _compare(native: NativeScene, a: Vector, expected: Vector, scale: float, what: str) -> None:
    """Raise NoSteadyMotion if accelerations differ by more than a part of the scale; what: the text on the motion."""
    if name := differing(native.coordinates, a, expected, scale):
        raise NoSteadyMotion(
            f"the motion {what}: the acceleration of {name} is not the same in axes that move with the scene, because "
            "a force, gravity, a spring or a drive depends on time or on a direction in space"
        )


def differing(names: Sequence[str], a: Vector, expected: Vector, scale: float) -> str:
    """The name of the acceleration that differs most, by more than a part of the scale; "" if none does."""
    off = np.abs(a - expected)
    return names[int(np.argmax(off))] if off.max(initial=0.0) > SAME * scale else ""


def accelerations_in(native: NativeScene, k: Vector, t: float, q: Vector, v: Vector) -> Vector:
    """The accelerations vdot (nv,) in a state. Raises NoSteadyMotion where a requirement of the model fails there."""
    try:
        return native.solve(t, q, v, k)[0]
    except ModelError as error:
        raise NoSteadyMotion(str(error)) from None
