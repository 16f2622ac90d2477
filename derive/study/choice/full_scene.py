"""The scene that full models can be derived of."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from derive.simulation.observables.motion import si_value
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene


def without_rotary_inertia(scene: AnyScene) -> AnyScene:
    """The scene without rotary inertia of masses attached to a beam that stretches, which full models do not have."""
    if isinstance(scene, SpatialScene):
        return scene
    return replace(scene, bodies=tuple(_lean(body) if isinstance(body, BeamBody) else body for body in scene.bodies))


def _lean(body: BeamBody) -> BeamBody:
    if body.beam.axial is None or not any(si_value(mass.inertia) for mass in body.beam.masses):
        return body
    masses = tuple(replace(mass, inertia=Fraction(0)) for mass in body.beam.masses)
    return replace(body, beam=replace(body.beam, masses=masses))
