"""A single beam as a scene, in which it is the only body."""

from __future__ import annotations

from dataclasses import replace

from derive.spec.construction import validated
from derive.spec.model.body import PlanarBeam
from derive.spec.model.scene import BeamBody, Scene
from derive.spec.model.simulation import NOT_GIVEN

BEAM, OTHERWISE = "beam", "rod"
"""The name of the body, and another one for a specification that is called so itself."""


def beam_scene(beam: PlanarBeam) -> Scene:
    """The scene of a free beam with its gravity, initial values and simulation; its body is called "beam".

    Raises SpecError if the initial deflection is none of its shape functions.
    """
    name = BEAM if beam.name.lower() != BEAM else OTHERWISE
    body = replace(beam, name=name, gravity=None, start=NOT_GIVEN, simulation=None, plots=())
    bodies = (BeamBody(name, body, start=beam.start),)
    return validated(Scene(beam.name, (), beam.gravity, bodies, (), simulation=beam.simulation, plots=beam.plots))
