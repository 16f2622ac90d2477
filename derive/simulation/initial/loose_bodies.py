"""A scene taken apart: each of its bodies moves on its own, in the shape that it has in a configuration."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from derive.mechanics.multibody.bodies.beam import piece_name
from derive.mechanics.symbols import Family, Identity
from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import coordinates_with
from derive.simulation.initial.assembler import Assembler
from derive.simulation.initial.joint_functions import Function
from derive.simulation.initial.kinematics import Kinematics, Linear
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene


@dataclass(frozen=True, eq=False)
class LoosePoses(Kinematics):
    """Poses of bodies that joints do not hold, with derivatives by the displacements x (m,) of the bodies.

    loose (bodies, 3), changes (bodies, 3, m): the poses and their derivatives; of_coordinates (nq, m): those of q by x.
    """

    loose: Matrix
    changes: Matrix
    of_coordinates: Matrix

    @cached_property
    def poses(self) -> Matrix:
        """The given poses (bodies, 3)."""
        return self.loose

    @cached_property
    def gradients(self) -> Matrix:
        """The given derivatives of the poses (bodies, 3, m)."""
        return self.changes

    def constant(self, value: float) -> Linear:
        """A constant."""
        return Linear(value, np.zeros(self.changes.shape[-1]), 0.0)

    def chained(self, gradient: Vector) -> Vector:
        """The derivatives (m,) of a scalar from those by the coordinates (nq,)."""
        return np.asarray(gradient @ self.of_coordinates)


class LooseBodies:
    """The bodies of a scene as rigid ones, with the deformations of a configuration q (nq,).

    A displacement x (3 n,) of the n bodies has two components of each, as parts of the size of the scene, and an angle.
    """

    def __init__(self, scene: Scene, assembler: Assembler, q: Vector) -> None:
        self._assembler, self._q = assembler, q
        self._poses = assembler.kinematics(q).poses
        self._rows: list[list[int]] = []
        self._coordinates: list[list[list[int]]] = []
        native = assembler.native
        for body in scene.bodies:
            beam = isinstance(body, BeamBody)
            names = [piece_name(body, k) for k in range(body.pieces)] if isinstance(body, BeamBody) else [body.name]
            self._rows.append([native.bodies.index(name) for name in names])
            # The markers of a beam follow from its coordinates, all of which it has.
            self._coordinates.append([_coordinates(native.coordinates, name) if beam else [] for name in names])
        self.size = 3 * len(scene.bodies)

    def at(self, x: Vector) -> LoosePoses:
        """The bodies displaced by x (3 n,)."""
        at = self._assembler
        poses, q = self._poses.copy(), self._q.copy()
        changes, of_coordinates = np.zeros((*poses.shape, self.size)), np.zeros((len(q), self.size))
        for body, (dx, dy, angle) in enumerate(x.reshape(-1, 3)):
            rows = self._rows[body]
            origin, cos, sin = self._poses[rows[0], :2], np.cos(angle), np.sin(angle)
            arms = (self._poses[rows, :2] - origin) @ np.array([[cos, sin], [-sin, cos]])
            poses[rows, :2] = origin + at.size * np.array([dx, dy]) + arms
            poses[rows, 2] += angle
            for row, arm, columns in zip(rows, arms, self._coordinates[body], strict=True):
                own = np.array([[at.size, 0.0, -arm[1]], [0.0, at.size, arm[0]], [0.0, 0.0, 1.0]])
                changes[row, :, 3 * body : 3 * body + 3] = own
                if columns:
                    q[columns] = poses[row]
                    of_coordinates[columns, 3 * body : 3 * body + 3] = own
        return LoosePoses(at.native, at.k, at.t, q, at.size, False, poses, changes, of_coordinates)

    def displacements(self, q: Vector) -> Vector:
        """The displacements x (3 n,) of the bodies in a configuration (nq,); for a beam, that of its first piece."""
        at = self._assembler
        first = [rows[0] for rows in self._rows]
        moved = (at.kinematics(q).poses - self._poses)[first] / np.array([at.size, at.size, 1.0])
        return np.asarray(moved.ravel())

    def deformation_rates(self, functions: Sequence[Function], v: Vector) -> Vector:
        """The rates (m,) of functions due to the deformations at v (nv,) alone."""
        kinematics = self._assembler.kinematics(self._q)
        deforming = np.where(coordinates_with(self._assembler.native, Role.AMPLITUDE), v, 0.0)
        linears = (function(kinematics) for function in functions)
        return np.array([float(linear.gradient @ deforming) + linear.drift for linear in linears])


def _coordinates(names: Sequence[str], piece: str) -> list[int]:
    """The numbers of the coordinates c1, c2 and phi of a piece of a beam."""
    of_frame = ((Family.TRANSLATION, 1), (Family.TRANSLATION, 2), (Family.ANGLE,))
    return [names.index(Identity(family, components=tuple(k), owner=piece).shown) for family, *k in of_frame]
