"""Scenes whose joints prove to be redundant, before or in their initial state: their model has to be another one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

from derive.errors import TisserandError
from derive.mechanics.bodies.displacement_fields import displacement_fields
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.runtime.native_scene import NativeScene
from derive.simulation.errors import (
    DriftTooLarge,
    DriveCannotBeFollowed,
    IntegrationStopped,
    RedundantConstraints,
    SingularConfiguration,
    TooNearDeadCentre,
)
from derive.simulation.scene_start import state_of
from derive.spec.model.planar_bodies import BeamBody, RigidBody, SceneBody
from derive.spec.model.spatial_beam import SpatialBody
from derive.spec.model.spatial_bodies import SpatialRigidBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

S = TypeVar("S", bound=AnyScene)
Result = TypeVar("Result")
IN_PLANE, IN_SPACE = 3, 6
"""The velocities of a free rigid body."""

DEPENDENT = (RedundantConstraints, SingularConfiguration)
"""The errors for constraints that depend on each other, in all states or in one."""


def refuse_dependent(scene: AnyScene, native: NativeScene) -> None:
    """Raise one of `DEPENDENT` if that is why a scene has no initial state; other faults are not looked for."""
    try:
        state_of(scene, native)
    except DEPENDENT:
        raise
    except TisserandError:
        return


def foreseen(scene: S) -> S:
    """The scene as `with_redundant_joints` first tries it: resolved if redundant joints are certain from its numbers.

    More constraints than velocities are never independent, in no state.
    """
    if scene.redundant != "auto" or not any(scene.joints):
        return scene
    excess = excess_constraints(scene)
    changed: Any = scene
    return replace(changed, redundant="resolve") if excess is not None and excess > 0 else scene


def excess_constraints(scene: AnyScene) -> int | None:
    """The number of constraints less that of velocities; None if a body does not tell how many velocities it has.

    A joint that eliminates coordinates takes as many of one as of the other.
    """
    velocities = [_velocities(body) for body in scene.bodies]
    if any(own is None for own in velocities):
        return None
    gears = 0
    if isinstance(scene, SpatialScene):
        rows = sum(len(SPATIAL_JOINTS[joint.kind].rows(joint)) for joint in scene.joints)
        gears = len(scene.gears)
    else:
        rows = sum(len(JOINTS[joint.kind].removes) for joint in scene.joints)
    return rows + gears + len(scene.drives) - sum(own for own in velocities if own is not None)


def _velocities(body: SceneBody | SpatialBody) -> int | None:
    """The number of velocities that a body adds, less that of the constraints between its pieces, if it is known."""
    match body:
        case RigidBody():
            return IN_PLANE
        case BeamBody():
            return IN_PLANE + body.pieces * len(displacement_fields(body.beam))
        case SpatialRigidBody():
            return IN_SPACE
        case _:
            return None


def with_redundant_joints(scene: S, action: Callable[[S], Result]) -> Result:
    """The result of an action with a scene; it is repeated for a model that resolves redundant joints if it needs that.

    action: generates a model of the scene that is given to it, and raises one of `DEPENDENT` where its constraints
    depend on each other. That is final if the scene says what to do about redundant joints, if a drive cannot be
    followed, or if the other model does not help. Where it is `foreseen`, the other model is the first one.
    """
    first = foreseen(scene)
    if first is not scene:
        try:
            return action(first)
        except TooNearDeadCentre:
            raise
        except (*DEPENDENT, DriftTooLarge, IntegrationStopped):
            return action(scene)  # it says why
    try:
        return action(scene)
    except DEPENDENT as error:
        if scene.redundant != "auto" or isinstance(error, DriveCannotBeFollowed):
            raise
        try:
            changed: Any = scene
            return action(replace(changed, redundant="resolve"))
        except TooNearDeadCentre:
            raise
        except (*DEPENDENT, DriftTooLarge, IntegrationStopped):
            raise error from None
