"""The places of a body in space that keeps all its coordinates, as flexible bodies do, in the state of its scene.

Its coordinates follow each other: the position of its origin, its quaternion, and its amplitudes. So do its velocities:
that of its origin, its angular velocity in its own axes, and the rates of its amplitudes.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from derive.mechanics.symbols import amplitude_of
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.configurations import COMPONENTS, QUATERNION, ROTATION, Named, rotation_matrix

RIGID = COMPONENTS + ROTATION
"""The velocities of a body without modes."""
POSE = COMPONENTS + QUATERNION
"""The coordinates of a body without modes."""


@dataclass(frozen=True)
class FreeBody:
    """A body with this number of modes whose first coordinate and first velocity have these numbers."""

    modes: int
    coordinate: int = 0
    velocity: int = 0

    @property
    def position(self) -> slice:
        """The coordinates of the origin."""
        return slice(self.coordinate, self.coordinate + COMPONENTS)

    @property
    def quaternion(self) -> slice:
        """The coordinates of the rotation."""
        return slice(self.coordinate + COMPONENTS, self.coordinate + POSE)

    @property
    def amplitudes(self) -> slice:
        """The coordinates of the modes."""
        return slice(self.coordinate + POSE, self.coordinate + POSE + self.modes)

    @property
    def translation(self) -> slice:
        """The velocities of the origin."""
        return slice(self.velocity, self.velocity + COMPONENTS)

    @property
    def rotation(self) -> slice:
        """The components of the angular velocity."""
        return slice(self.velocity + COMPONENTS, self.velocity + RIGID)

    @property
    def rigid(self) -> slice:
        """The velocities of the motion without deformation."""
        return slice(self.velocity, self.velocity + RIGID)

    @property
    def rates(self) -> slice:
        """The velocities of the modes."""
        return slice(self.velocity + RIGID, self.velocity + RIGID + self.modes)

    def axes(self, q: Vector) -> Matrix:
        """The axes of the body (3, 3) as columns, in the inertial frame, in a state q (nq,) of the scene."""
        quaternion = q[self.quaternion]
        return rotation_matrix(quaternion / np.linalg.norm(quaternion))


def flexible_body(name: str, native: Named) -> FreeBody | None:
    """The places of a flexible body of a scene; None if it has no modes."""
    first = amplitude_of(name, 1).shown
    if first not in native.coordinates:
        return None
    modes = next(i for i in itertools.count(1) if amplitude_of(name, i + 1).shown not in native.coordinates)
    velocity = native.velocities.index(amplitude_of(name, 1, 1).shown)
    return FreeBody(modes, native.coordinates.index(first) - POSE, velocity - RIGID)
