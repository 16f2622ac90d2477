"""The flexible bodies of a scene, in the plane or in space, which the models of a ladder replace."""

from __future__ import annotations

from derive.simulation.observables.beams import beam_bodies
from derive.spec.model.planar_bodies import BeamBody, RigidBody
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import LadderModel
from derive.study.accuracy.models import modelled
from derive.study.accuracy.spatial_models import flexible_bodies, modelled_in_space

Flexible = BeamBody | SpatialBeam | FlexibleBody
"""A body that models of a ladder replace."""


def flexible_members(scene: AnyScene) -> tuple[Flexible, ...]:
    """The bodies of a scene that models replace: beams, in space finite-element bodies as well."""
    return flexible_bodies(scene) if isinstance(scene, SpatialScene) else beam_bodies(scene)


def flexible_nouns(scene: AnyScene) -> tuple[str, str]:
    """The nouns for one, and for several, of the flexible bodies of a scene."""
    return ("flexible body", "flexible bodies") if isinstance(scene, SpatialScene) else ("beam", "beams")


def modelled_member(scene: AnyScene, body: Flexible, model: LadderModel) -> BeamBody | RigidBody | SpatialBody:
    """A flexible body of a scene with a model. Raises SpecError if it cannot have it."""
    if isinstance(body, BeamBody):
        return modelled(body, model)
    assert isinstance(scene, SpatialScene)
    return modelled_in_space(scene, body, model)
