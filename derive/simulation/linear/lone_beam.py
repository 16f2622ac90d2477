"""A planar beam alone as a scene with one body, so that it is drawn like a scene."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from derive.runtime.compiled_model import Native
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.scene import BeamBody, Scene


def beam_scene(beam: PlanarBeam) -> Scene:
    """The scene whose only body is a free beam; it has the name of the beam."""
    body = BeamBody(beam.name, replace(beam, gravity=None))
    return Scene(beam.name, ground=(), gravity=beam.gravity, bodies=(body,), joints=())


class LoneBeam(NativeScene):
    """A compiled beam under the names that it has in the scene of `beam_scene`; it has no constraints."""

    def __init__(self, native: Native, name: str) -> None:
        self.__dict__.update(native.__dict__)
        self.bodies = (name,)
        self.coordinates = tuple(f"{name}_{coordinate}" for coordinate in native.coordinates)
        self._alone = native

    def poses(self, t: float, q: ArrayLike, k: ArrayLike) -> Matrix:
        """The pose c1, c2 (m) and phi (rad) of the frame of the beam, (1, 3)."""
        return np.asarray(q, dtype=np.float64)[None, :3]

    def marker(self, name: str, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> tuple[Vector, Vector, Vector]:
        """Position, velocity and Jacobian of a marker, see `Native`; its name begins with that of the beam."""
        names = {f"{self.bodies[0]}_{marker}": marker for marker in self._alone.markers}
        return self._alone.marker(names[name], q, v, k)

    def marker_positions(self, name: str, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Matrix:
        """Positions of a marker in several states, see `Native`; its name begins with that of the beam."""
        names = {f"{self.bodies[0]}_{marker}": marker for marker in self._alone.markers}
        return self._alone.marker_positions(names[name], q, v, k)

    def constraints(self, t: float, q: ArrayLike, k: ArrayLike) -> Vector:
        """The constraints g, which are empty."""
        return np.zeros(0)

    def constraint_rates(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """The rates gdot of the constraints, which are empty."""
        return np.zeros(0)

    def project_velocity(self, t: float, q: ArrayLike, k: ArrayLike, r: ArrayLike) -> Vector:
        """The change of the velocities that constraints need (nv,): zero."""
        return np.zeros(self.nv)
