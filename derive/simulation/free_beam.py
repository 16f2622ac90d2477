"""A single beam as a scene, in which it is the only body, and its compiled model as that of the scene."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from derive.runtime.native_call import Matrix
from derive.runtime.native_scene import NativeScene
from derive.spec.construction import validated
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.scene import BeamBody, Scene
from derive.spec.model.simulation import NOT_GIVEN


def beam_scene(beam: PlanarBeam) -> Scene:
    """The scene of a free beam with its gravity, initial values and simulation; its body has its `body_name`.

    Raises SpecError if the initial deflection is none of its shape functions.
    """
    body = replace(beam, name=beam.body_name, gravity=None, start=NOT_GIVEN, simulation=None, plots=())
    bodies = (BeamBody(body.name, body, start=beam.start),)
    return validated(Scene(beam.name, (), beam.gravity, bodies, (), simulation=beam.simulation, plots=beam.plots))


class FreeBeam(NativeScene):
    """A compiled beam under the names that it has in the scene of `beam_scene`."""

    def __init__(self, native: NativeScene, beam: PlanarBeam) -> None:
        self.__dict__.update(native.__dict__)
        self.bodies = (beam.body_name,)
        self.coordinates = tuple(f"{beam.body_name}_{coordinate}" for coordinate in native.coordinates)
        self._alone = native

    def poses(self, t: float, q: ArrayLike, k: ArrayLike) -> Matrix:
        """The pose c1, c2 (m) and phi (rad) of the frame of the beam, (1, 3)."""
        return np.asarray(q, dtype=np.float64)[None, :3]

    def marker_positions(self, name: str, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Matrix:
        """Positions of a marker in several states, see `Native`; its name begins with that of the beam."""
        return self._alone.marker_positions(name.removeprefix(f"{self.bodies[0]}_"), q, v, k)
