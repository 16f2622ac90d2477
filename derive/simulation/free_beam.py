"""A single beam as a scene, in which it is the only body."""

from __future__ import annotations

from dataclasses import replace

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
