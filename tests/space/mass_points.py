"""Bodies as material points with masses: a rigid body has six, a flexible one its nodes.

The six points of a rigid body lie on three lines through its centre of mass, in pairs, such that their second moments
are those of the inertia tensor. The nodes of a flexible body move by its modes; their mass matrix may couple them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

import numpy as np
from decimal_vectors import ONE, ZERO, Array, cholesky, identity, zeros
from written_scene import Numbers, Table, rotation


@dataclass(frozen=True, eq=False)
class MarkerFrame:
    """A marker in the frame of its body: x + sum shapes alpha, rotated by sum turns alpha and then by `rotation`.

    position (3,); shapes (N, 3); turns (N, 3), None where a marker has no rotation; rotation (3, 3); second (N, N, 3);
    second_turns (N, N, 3), the second derivatives of the rotation vector.
    """

    position: Array
    rotation: Array
    shapes: Array
    turns: Array | None
    second: Array | None = None
    second_turns: Array | None = None

    def at(self, amplitudes: Array) -> Array:
        """The position of the marker in the frame of its body."""
        return moved(self.position, self.shapes, self.second, amplitudes)

    def turn(self, amplitudes: Array) -> Array:
        """The rotation vector of the marker in the frame of its body."""
        assert self.turns is not None
        return moved(zeros(3), self.turns, self.second_turns, amplitudes)


@dataclass(frozen=True, eq=False)
class PointBody:
    """Material points X (P, 3) with modes (N, P, 3), of which `masses` (P, P) is the mass matrix; linear elasticity.

    origin (3,): the point of the body whose inertial position is among its coordinates; cubic (N, N, N): the factors of
    products of three amplitudes in the strain energy; preload (N,): those of single ones.
    """

    name: str
    masses: Array
    points: Array
    modes: Array
    stiffness: Array
    damping: Array
    markers: Mapping[str, MarkerFrame]
    second: Array | None = None
    cubic: Array | None = None
    preload: Array | None = None

    @property
    def n(self) -> int:
        """The number of modes."""
        return len(self.modes)

    def strain(self, a: Array) -> Decimal:
        """The strain energy at amplitudes."""
        linear = ZERO if self.preload is None else self.preload @ a
        third = ZERO if self.cubic is None else ((self.cubic @ a) @ a) @ a
        return Decimal(linear + a @ self.stiffness @ a / 2 + third)

    def other_forces(self, a: Array) -> list[Array]:
        """The derivatives of what is not quadratic in the strain energy, by amplitudes."""
        result = [] if self.preload is None else [self.preload]
        if self.cubic is not None:
            turned = (np.moveaxis(self.cubic, k, 0) for k in range(3))
            result += [(of @ a) @ a for of in turned]
        return result

    def deformed(self, amplitudes: Array) -> Array:
        """X + sum Phi_i alpha_i + 1/2 sum Psi_ij alpha_i alpha_j (P, 3)."""
        return moved(self.points, self.modes, self.second, amplitudes)


def moved(points: Array, modes: Array, second: Array | None, amplitudes: Array) -> Array:
    """Points displaced by modes, and to second order by `second` (N, N, ...), the second derivatives."""
    result = points
    for i, alpha in enumerate(amplitudes):
        result = result + alpha * modes[i]
        for j, beta in enumerate(amplitudes) if second is not None else ():
            result = result + alpha * beta * second[i, j] / 2
    return result


def rigid_points(mass: Decimal, centre: Array, inertia: Array) -> tuple[Array, Array]:
    """Masses (6,) and positions (6, 3) with this mass, centre of mass and inertia tensor (3, 3) about it."""
    moments = (inertia[0, 0] + inertia[1, 1] + inertia[2, 2]) / 2 * identity(3) - inertia  # int r r dm
    arms = cholesky(moments) * (Decimal(3) / mass).sqrt()
    points = [centre + sign * arms[:, k] for k in range(3) for sign in (ONE, -ONE)]
    return np.array([mass / 6] * 6, dtype=object), np.array(points, dtype=object)


def inertia_tensor(six: Array) -> Array:
    """The symmetric tensor of Jxx, Jyy, Jzz, Jxy, Jxz, Jyz."""
    xx, yy, zz, xy, xz, yz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], dtype=object)


def rigid_body(name: str, table: Table, value: Numbers) -> PointBody:
    """A rigid body as the scene has it, its frame at its origin."""
    masses, points = zeros(0), zeros(0, 3)
    if "mass" in table:
        mass = value(table["mass"])
        centre = value.vector(table.get("centre", (0, 0, 0)))
        inertia = inertia_tensor(value.vector(table["inertia"])) if "inertia" in table else zeros(3, 3)
        masses, points = rigid_points(mass, centre, inertia)
    none = zeros(0, len(points), 3)
    markers = {marker: rigid_marker(of, value) for marker, of in table.get("markers", {}).items()}
    return PointBody(
        name, np.diag(masses) if len(masses) else zeros(0, 0), points, none, zeros(0, 0), zeros(0, 0), markers
    )


def rigid_marker(of: Any, value: Numbers) -> MarkerFrame:
    """A marker of a rigid body or of the ground: a position, or a table with a position and a rotation."""
    position, turned = (of["at"], of.get("rotation")) if isinstance(of, Mapping) else (of, None)
    return MarkerFrame(value.vector(position), rotation(turned), zeros(0, 3), zeros(0, 3))
