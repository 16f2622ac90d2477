"""The axes in which a scene in space rotates steadily, by the velocities that it gives.

The angular velocity is along gravity, if there is gravity. First all bodies move along with the axes; where their
velocities do not permit this, or do not balance, rigid bodies with an axis of symmetry may spin about it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from derive.mechanics.prescribed_motion import drive_motion
from derive.mechanics.symbols import Family, Identity
from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import constraint_matrix, mass_matrix, max_norm
from derive.simulation.configurations import attitudes, origins, skew, velocities_with
from derive.simulation.drive_jumps import rate_at
from derive.simulation.initial.targets import Strength
from derive.simulation.linear.rotating_field import RotatingField
from derive.simulation.linear.steady_motion import NoSteadyMotion
from derive.simulation.linear.steady_rotation import balance
from derive.simulation.observables.motion import si_value
from derive.simulation.space.poses import SpatialPoses
from derive.simulation.space.targets import SpatialTarget
from derive.spec.model.spatial_bodies import SpatialRigidBody
from derive.spec.model.spatial_scene import SpatialScene

MET = 1e-8
"""The part of the largest velocity by which a rotation may miss the velocities that are given."""
RANK = 1e-9
"""Singular values below this part of the largest count as zero."""
SYMMETRIC = 1e-9
"""Moments of inertia that differ by less than this part are equal."""
STEADY = 1e-9
"""Forces that are out of balance by less than this part of the loads belong to a steady state."""
UNITS = ("m/s", "rad/s")
"""The units of the velocity and of the angular velocity of a body."""
AXES = 6
"""The numbers that the motion of the axes has: W and u."""


def rotating_axes_of(
    scene: SpatialScene, poses: SpatialPoses, rates: Sequence[SpatialTarget], v: Vector
) -> RotatingField:
    """The field of the steady rotation that has the velocities which a scene gives, in a configuration on its joints.

    rates: the targets of velocities. v (nv,): the velocities of the initial state, from which values come that are not
    given; about its angular momentum free bodies that spin precess. Raises NoSteadyMotion with what the best rotation
    misses.
    """
    native, fields, first = poses.native, [], ""
    for spins, basis in _candidates(scene, poses, v):
        fit = _Fit(scene, poses, spins)
        field, missed, what = fit.field(basis, rates, v)
        first = first or f"{what[0]} misses it by {missed:.4g} {what[1]}"
        if missed <= MET * max(1.0, max_norm(field.velocities(poses.q))):
            if balance(native, poses.k, poses.q, field).rest <= STEADY:
                return field
            fields.append(field)
    if fields:
        return fields[0]
    assert first
    direction = " about the direction of gravity" if _gravity(scene) is not None else ""
    raise NoSteadyMotion(
        f"the velocities of the initial state are not those of a rotation of the whole scene{direction}: {first}",
        "give velocities of a rotation, to rigid bodies with an axis of symmetry also a spin about that axis, or "
        f"none{_driven(scene, poses.t)}",
    )


def _driven(scene: SpatialScene, t: float) -> str:
    """The advice about drives that move at a time (s)."""
    moving = [drive.name for drive in scene.drives if rate_at(drive_motion(drive), t) != 0.0]
    if not moving:
        return ""
    which, gives = ("drive", "gives") if len(moving) == 1 else ("drives", "give")
    return (
        f". The {which} {', '.join(moving)} {gives} velocities as well: a mechanism whose parts move in different "
        "ways has no steady motion unless its drives stand still"
    )


def _gravity(scene: SpatialScene) -> Vector | None:
    """The direction of gravity; None without gravity."""
    if scene.gravity is None:
        return None
    g = np.array([si_value(x) for x in scene.gravity])
    return g / np.linalg.norm(g) if g.any() else None


@dataclass(frozen=True, eq=False)
class _Spin:
    """An axis (3,) in the frame of a body, by its number, about which it may spin."""

    body: int
    axis: Vector


def _candidates(scene: SpatialScene, poses: SpatialPoses, v: Vector) -> Iterator[tuple[tuple[_Spin, ...], Matrix]]:
    """The bodies that may spin, and a basis (6 + spins, n) of the motions of the axes and of the spins."""
    gravity = _gravity(scene)
    yield (), _basis(None if gravity is None else -gravity, 0)
    if spins := tuple(_spins(scene, poses)):
        about = -gravity if gravity is not None else _angular_momentum(scene, poses, v)
        if about is not None:
            yield spins, _basis(about, len(spins))


def _basis(about: Vector | None, spins: int) -> Matrix:
    """The basis of rotations about a direction, or about any one, with any motion of the origin and any spins."""
    rotations = np.eye(3) if about is None else about[:, None]
    result = np.zeros((AXES + spins, rotations.shape[1] + 3 + spins))
    result[:3, : rotations.shape[1]] = rotations
    result[3:, rotations.shape[1] :] = np.eye(3 + spins)
    return result


def _spins(scene: SpatialScene, poses: SpatialPoses) -> Iterator[_Spin]:
    """The rigid bodies that keep a rotation, or turn in a joint, with the axes about which they may spin."""
    native = poses.native
    M, of = mass_matrix(native, poses.q, poses.k), {body.name: body for body in scene.bodies}
    turning = dict(attitudes(native))
    angles = velocities_with(native, Role.ROTATION)
    for number, name in enumerate(native.bodies):
        columns = np.flatnonzero(angles & np.any(poses.twists[number, 3:] != 0.0, axis=0))
        if not isinstance(of[name], SpatialRigidBody):
            continue
        if (own := Identity(Family.ANGLE, derivative=1, owner=name).shown) in native.velocities:
            axis = poses.twists[number, 3:, native.velocities.index(own)]
            yield _Spin(number, axis / np.linalg.norm(axis))
        elif len(columns) == 3 and columns[0] in turning.values():
            values, vectors = np.linalg.eigh(M[np.ix_(columns, columns)])
            equal = np.abs(np.diff(values)) <= SYMMETRIC * values[-1]
            if equal.sum() == 1:
                yield _Spin(number, vectors[:, 2 if equal[0] else 0])


def _angular_momentum(scene: SpatialScene, poses: SpatialPoses, v: Vector) -> Vector | None:
    """The direction of the angular momentum about the centre of mass of bodies that nothing connects to the ground."""
    fit, unit = _Fit(scene, poses, ()), np.eye(AXES)
    if max_norm(fit.unmet(unit).ravel()) > RANK * max(1.0, poses.size):
        return None
    M = mass_matrix(poses.native, poses.q, poses.k)
    turns, moves = fit.A[:, :3], fit.A[:, 3:AXES]
    mass = moves[:, 0] @ M @ moves[:, 0]
    coupling = moves.T @ M @ turns / mass  # that of the centre x: e_i . (e_k x x)
    twice = np.array(
        [coupling[1, 2] - coupling[2, 1], coupling[2, 0] - coupling[0, 2], coupling[0, 1] - coupling[1, 0]]
    )
    momentum = turns.T @ M @ v - np.cross(twice / 2, moves.T @ M @ v)
    size = float(np.linalg.norm(momentum))
    return momentum / size if size > 0.0 else None


class _Fit:
    """The velocities v = A y + b of the motion y = [W; u; spins] of the axes, and what they miss.

    The twists of all bodies that have coordinates are P v + drifts; they should be those of the axes, D y.
    """

    def __init__(self, scene: SpatialScene, poses: SpatialPoses, spins: Sequence[_Spin]) -> None:
        native, self.poses, self.spins = poses.native, poses, tuple(spins)
        count, bodies = AXES + len(spins), len(native.bodies)
        P, d = poses.twists.reshape(6 * bodies, native.nv), poses.drifts.ravel()
        D = np.zeros((6 * bodies, count))
        for number in range(bodies):
            c, Q = poses.values[number, :3], poses.values[number, 3:].reshape(3, 3)
            D[6 * number : 6 * number + 3, :3] = -skew(c)
            D[6 * number : 6 * number + 3, 3:AXES] = np.eye(3)
            D[6 * number + 3 : 6 * number + 6, :3] = Q.T
        for i, spin in enumerate(spins):
            D[6 * spin.body + 3 : 6 * spin.body + 6, AXES + i] = spin.axis
        still = velocities_with(native, Role.AMPLITUDE)
        inverse = np.zeros((native.nv, len(P)))
        inverse[~still] = np.linalg.pinv(P[:, ~still], rcond=RANK)
        self.A, self.b = inverse @ D, -inverse @ d
        self.moving = np.repeat(np.any(P.reshape(bodies, -1) != 0.0, axis=1), 6)
        self.driven = np.repeat(np.any(d.reshape(bodies, -1) != 0.0, axis=1), 6)
        self.residual, self.offset = P @ self.A - D, P @ self.b + d
        G = constraint_matrix(native, poses.t, poses.q, poses.k)
        at_rest = native.constraint_rates(poses.t, poses.q, np.zeros(native.nv), poses.k)
        self.joints, self.of_joints = G @ self.A, G @ self.b + at_rest

    def unmet(self, y: Matrix) -> Matrix:
        """The deviations of motions of the axes (6 + spins, n) from those of joints, and of bodies with coordinates."""
        return np.vstack([self.residual[self.moving] @ y, self.joints @ y])

    def field(
        self, basis: Matrix, rates: Sequence[SpatialTarget], v: Vector
    ) -> tuple[RotatingField, float, tuple[str, str]]:
        """The best motion of the axes in a basis, with the largest miss, and what misses it in which unit.

        Joints come first, then rates that are given and guessed, bodies that drives move, and the velocities v (nv,).
        """
        native, poses = self.poses.native, self.poses
        names = [(f"body {native.bodies[i // 6]}", UNITS[i % 6 // 3]) for i in np.flatnonzero(self.moving)]
        names += [(name, " or ".join(UNITS)) for name in native.multipliers]
        demands = [(self.unmet(basis), -np.concatenate([self.offset[self.moving], self.of_joints]), names)]
        for strength in (Strength.GIVEN, Strength.GUESS):
            own = [target for target in rates if target.strength is strength]
            parts = [target.linearised(poses)[:2] for target in own]
            if own:
                rows, values = (np.concatenate([part[i] for part in parts]) for i in (1, 0))
                paths = [(t.path, t.unit) for t, (r, _) in zip(own, parts, strict=True) for _ in r]
                demands.append((rows @ self.A @ basis, -values - rows @ self.b, paths))
        carried = ~self.moving
        turning = carried & self.driven
        carried = turning if turning.any() else carried  # what stands on the ground tells nothing of the axes
        demands.append((self.residual[carried] @ basis, -self.offset[carried], []))
        demands.append((self.A @ basis, v - self.b, []))
        z, free = np.zeros(basis.shape[1]), np.eye(basis.shape[1])
        for rows, values, _ in demands:
            z, free = _nearest(rows, values, z, free)
        missed, what = 0.0, ("", "")
        strict = demands[: 1 + any(target.strength is Strength.GIVEN for target in rates)]
        for rows, values, of in strict:
            off = np.abs(rows @ z - values)
            if off.max(initial=0.0) > missed:
                missed, what = float(off.max()), of[int(np.argmax(off))]
        return self._field(basis @ z), missed, what

    def _field(self, y: Vector) -> RotatingField:
        """The field of a motion of the axes."""
        native, v = self.poses.native, self.A @ y + self.b
        own, rotation = np.array(v), y[:3]
        for _, j in origins(native):
            own[j : j + 3] = 0.0
        for _, j in attitudes(native):
            own[j : j + 3] = 0.0
            number = next(n for n in range(len(native.bodies)) if self.poses.twists[n, 3, j] != 0.0)
            for spin, rate in zip(self.spins, y[AXES:], strict=True):
                if spin.body == number:
                    own[j : j + 3] = rate * spin.axis
        return RotatingField(native, rotation, y[3:AXES], own)


def _nearest(rows: Matrix, values: Vector, z: Vector, free: Matrix) -> tuple[Vector, Matrix]:
    """The vector z, changed along the free directions so that rows z comes next to values, and what is free then."""
    if not rows.size or not free.size:
        return z, free
    U, sizes, Vt = np.linalg.svd(rows @ free)
    rank = int(np.sum(sizes > RANK * max(1.0, float(np.linalg.norm(rows, 2)))))  # rows may be rounding errors
    step = (U.T @ (values - rows @ z))[:rank] / sizes[:rank]
    return z + free @ Vt[:rank].T @ step, free @ Vt[rank:].T
