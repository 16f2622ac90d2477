"""The simulated scene of a specification: for a single body it is the scene around this body."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from derive.errors import Problem, SpecError
from derive.runtime.native_call import Matrix
from derive.runtime.native_scene import NativeScene
from derive.spec.construction.validated import validated
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.body import NodalBody, SymbolicBody
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene
from derive.spec.model.simulation import NOT_GIVEN
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene, Specification


def simulated(spec: Specification, lacking: str = "there is nothing to simulate with") -> AnyScene | NodalBody:
    """The scene or the body in space that is simulated: of a single beam its scene.

    lacking: what a symbolic body lacks. Raises SpecError for one, and TypeError for anything but a specification.
    """
    match spec:
        case Scene() | SpatialScene() | NodalBody():
            return spec
        case PlanarBeam():
            return beam_scene(spec)
        case SymbolicBody():
            text = (
                f"all numbers of this body are parameters, so that {lacking}: give the body by its nodes, as a beam or "
                "as a scene; or build it, and set its parameters in a program of your own"
            )
            raise SpecError((Problem("", text),), spec.name)
        case _:
            what = f"a scene, a beam or a body given by nodes is needed, not {type(spec).__name__}"
            raise TypeError(f"{what}; read its file with derive.read(...)")


def surroundings(spec: AnyScene | NodalBody) -> AnyScene:
    """The scene in which a specification moves, with all pieces of beams: a body in space alone is in an empty one."""
    if isinstance(spec, (Scene, SpatialScene)):
        return in_pieces(spec)
    return Scene(spec.name, (), None, (), (), simulation=spec.simulation, plots=spec.plots)


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
        self._alone, self._markers = native, {f"{beam.body_name}_{marker}": marker for marker in native.markers}
        self.markers = tuple(self._markers)

    def poses(self, t: float, q: ArrayLike, k: ArrayLike) -> Matrix:
        """The pose c1, c2 (m) and phi (rad) of the frame of the beam, (1, 3)."""
        return np.asarray(q, dtype=np.float64)[None, :3]

    def marker_positions(self, name: str, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Matrix:
        """Positions of a marker in several states, see `Native`; its name begins with that of the beam."""
        return self._alone.marker_positions(self._markers[name], q, v, k)
