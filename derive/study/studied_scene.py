"""The scene that the function of a study is given: planar, with a simulation, and with beams where they matter."""

from __future__ import annotations

from typing import Any

from derive.errors import Problem, SpecError
from derive.simulation.observables.beams import beam_bodies
from derive.simulation.simulate import with_simulation
from derive.spec.model.scene import Scene

COMPARED = "study {} compares models of beams; see scenes/crank_slider_3.toml"
"""The reason why a study with a name needs a beam."""


def studied_scene(scene: Any, needs_beam: str = "") -> Scene:
    """The scene, if it can be studied. needs_beam: the reason why there has to be a beam.

    Raises TypeError for what is no planar scene, SpecError for a scene without simulation or without the beam.
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"a planar scene is needed, such as derive.scene makes, not {type(scene).__name__}")
    if needs_beam and not beam_bodies(scene):
        raise SpecError((Problem("bodies", f"there is no beam here, and {needs_beam}"),))
    return with_simulation(scene)
