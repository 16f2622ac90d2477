"""Configurations and their small changes: coordinates q, of which quaternions have four, and changes like velocities.

A change (nv,) has a rotation vector of three components, in the frame of the body, where q has a quaternion; in the
plane it is a change of the coordinates. Iterations and perturbations change configurations through this module alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector

Mask = NDArray[np.bool_]


class Configured(Protocol):
    """A compiled scene or body whose coordinates have roles."""

    nq: int
    nv: int
    roles: tuple[Role, ...]


class Named(Configured, Protocol):
    """A compiled scene or body whose coordinates and velocities have names."""

    coordinates: tuple[str, ...]
    velocities: tuple[str, ...]


QUATERNION, ROTATION, COMPONENTS = 4, 3, 3
"""The numbers of coordinates and of velocities of a rotation in space, and of components of a position."""


def velocity_roles(native: Configured) -> tuple[Role, ...]:
    """The role of the coordinate that belongs to each velocity (nv,); an angular velocity in space is a ROTATION."""
    if native.nq == native.nv:
        return native.roles
    result: list[Role] = []
    for _, _, role in blocks(native):
        result += [Role.ROTATION] * ROTATION if role is Role.QUATERNION else [role]
    return tuple(result)


def velocities_with(native: Configured, *roles: Role) -> Mask:
    """The mask (nv,) of the velocities of coordinates with one of these roles; of quaternions the role is ROTATION."""
    return np.array([role in roles for role in velocity_roles(native)], dtype=bool)


def displaced(native: Configured, q: Vector, change: Vector) -> Vector:
    """The configuration q (nq,) after a change (nv,), of any size: rotations turn about their vector."""
    if native.nq == native.nv:
        return np.asarray(q + change)
    result = np.array(q, dtype=np.float64)
    for i, j, role in blocks(native):
        if role is Role.QUATERNION:
            result[i : i + QUATERNION] = turned(q[i : i + QUATERNION], change[j : j + ROTATION])
        else:
            result[i] += change[j]
    return result


def difference(native: Configured, first: Vector, second: Vector) -> Vector:
    """The change (nv,) that leads from one configuration (nq,) to another; rotations by the smaller angle."""
    if native.nq == native.nv:
        return np.asarray(second - first)
    result = np.zeros(native.nv)
    for i, j, role in blocks(native):
        if role is Role.QUATERNION:
            result[j : j + ROTATION] = rotation_vector(
                quaternion_product(conjugate(first[i : i + QUATERNION]), second[i : i + QUATERNION])
            )
        else:
            result[j] = second[i] - first[i]
    return result


def normalised(native: Configured, q: Vector) -> Vector:
    """Coordinates (nq,) with quaternions of length 1; those without one as they are."""
    if native.nq == native.nv:
        return q
    result = np.array(q, dtype=np.float64)
    for i, _, role in blocks(native):
        if role is Role.QUATERNION:
            result[i : i + QUATERNION] /= np.linalg.norm(result[i : i + QUATERNION])
    return result


class Moving(Configured, Protocol):
    """A compiled scene or body whose coordinates have rates."""

    def rates(self, q: Vector, v: Vector, k: Vector) -> Vector:
        """The rates qdot (nq,) of the coordinates, linear in v."""


def rate_matrix(native: Moving, q: Vector, k: Vector) -> Matrix:
    """The matrix Z (nq, nv) of qdot = Z v, which takes small changes to those of the coordinates."""
    if native.nq == native.nv:
        return np.eye(native.nv)
    return np.column_stack([native.rates(q, unit, k) for unit in np.eye(native.nv)])


def origins(native: Configured) -> tuple[tuple[int, int], ...]:
    """The first coordinate and the first velocity of each origin of a body in space."""
    translations = [(i, j) for i, j, role in blocks(native) if role is Role.TRANSLATION]
    return tuple(translations[::COMPONENTS])


def attitudes(native: Configured) -> tuple[tuple[int, int], ...]:
    """The first coordinate and the first velocity of each quaternion."""
    return tuple((i, j) for i, j, role in blocks(native) if role is Role.QUATERNION)


def velocity_names(native: Named) -> tuple[str, ...]:
    """The names of the elements of a change: in the plane those of the coordinates, in space those of velocities."""
    return native.coordinates if native.nq == native.nv else native.velocities


def blocks(native: Configured) -> Iterator[tuple[int, int, Role]]:
    """The first coordinate and the first velocity of each coordinate, or quaternion, with its role."""
    i, j = 0, 0
    while i < native.nq:
        role = native.roles[i]
        yield i, j, role
        rotation = role is Role.QUATERNION
        i, j = i + (QUATERNION if rotation else 1), j + (ROTATION if rotation else 1)


# ---- quaternions, scalar first ----


def quaternion_product(p: Vector, q: Vector) -> Vector:
    """The product of two quaternions."""
    (a, b, c, d), (e, f, g, h) = np.asarray(p).tolist(), np.asarray(q).tolist()  # faster than arrays
    product = (a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g)
    return np.array((*product, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e))


def conjugate(p: Vector) -> Vector:
    """The quaternion of the inverse rotation."""
    return np.array([p[0], *(-p[1:])])


def turned(p: Vector, rotation: Vector) -> Vector:
    """The quaternion of a frame after a rotation about a vector (rad) that is given in this frame; of unit length."""
    x, y, z = np.asarray(rotation).tolist()
    angle = math.hypot(x, y, z)
    small = math.sin(angle / 2) / angle if angle else 0.5
    result = quaternion_product(p, np.array((math.cos(angle / 2), small * x, small * y, small * z)))
    return np.asarray(result / math.hypot(*result.tolist()))


def rotation_vector(p: Vector) -> Vector:
    """The vector (3,) of the rotation of a quaternion by at most pi."""
    p = p if p[0] >= 0 else -p
    sine = float(np.linalg.norm(p[1:]))
    angle = 2 * np.arctan2(sine, p[0])
    return np.asarray(p[1:] * (angle / sine if sine > 0 else 2.0))


def rotation_matrix(p: Vector) -> Matrix:
    """The rotation matrix of a unit quaternion."""
    e0, e = p[0], p[1:]
    return np.asarray((e0**2 - e @ e) * np.eye(3) + 2 * np.outer(e, e) + 2 * e0 * skew(e))


def skew(v: Vector) -> Matrix:
    """The matrix of v x."""
    a, b, c = v
    return np.array([[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]])


def quaternion_of(Q: Matrix) -> Vector:
    """The unit quaternion of a rotation matrix, with a scalar that is not negative."""
    K = np.array(
        [
            [Q.trace(), Q[2, 1] - Q[1, 2], Q[0, 2] - Q[2, 0], Q[1, 0] - Q[0, 1]],
            [0, Q[0, 0] - Q[1, 1] - Q[2, 2], Q[0, 1] + Q[1, 0], Q[0, 2] + Q[2, 0]],
            [0, 0, Q[1, 1] - Q[0, 0] - Q[2, 2], Q[1, 2] + Q[2, 1]],
            [0, 0, 0, Q[2, 2] - Q[0, 0] - Q[1, 1]],
        ]
    )
    p = np.linalg.eigh(K, UPLO="U")[1][:, -1]
    return np.asarray(p if p[0] >= 0 else -p)
