"""Markers with the stresses that outputs of a scene ask for."""

from __future__ import annotations

from dataclasses import replace

from derive.mechanics.bodies.modal_body import ModalFrame
from derive.mechanics.multibody.space.stress_outputs import stressed_markers
from derive.reduction.modal_stresses import marker_stresses
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene


def with_stresses(scene: SpatialScene, body: FlexibleBody, frames: tuple[ModalFrame, ...]) -> tuple[ModalFrame, ...]:
    """The markers of a body with their stresses by unit amplitudes, where outputs need these. Raises SpecError."""
    asked = {marker.marker for marker in stressed_markers(scene) if marker.body == body.name}
    return tuple(
        replace(frame, stresses=marker_stresses(body.body, marker)) if marker.name in asked else frame
        for marker, frame in zip(body.markers, frames, strict=True)
    )
