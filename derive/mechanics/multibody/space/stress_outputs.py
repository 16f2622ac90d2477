"""The markers at which outputs of a scene in space ask for stresses."""

from __future__ import annotations

from collections.abc import Iterator

from derive.errors import Problem
from derive.mechanics.multibody.space.marker_outputs import STRESS
from derive.spec.model.markers import MarkerRef
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene


def stressed_markers(scene: SpatialScene) -> dict[MarkerRef, str]:
    """The markers at which outputs ask for stresses, and the name of one of these outputs."""
    of_kind = [output for output in scene.outputs if output.kind == STRESS]
    return {marker: output.name for output in of_kind if isinstance(marker := output.values["marker"], MarkerRef)}


def bodies_without_stresses(scene: SpatialScene) -> Iterator[Problem]:
    """Yield faults of stresses at markers of bodies whose files have no elements with materials."""
    bodies = {b.name for b in scene.bodies if isinstance(b, FlexibleBody) and b.body.data.has_stresses}
    for marker, output in stressed_markers(scene).items():
        if marker.body not in bodies:
            text = f"stresses come from elements with materials, which {marker.body} does not have"
            known = f"bodies with stresses are {', '.join(sorted(bodies))}" if bodies else "no body of the scene does"
            yield Problem(f"outputs.{output}.marker", f"{text}; {known}")
