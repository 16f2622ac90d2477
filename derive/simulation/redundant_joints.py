"""Scenes whose joints prove to be redundant when their initial state is known: their model has to be another one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

from derive.errors import TisserandError
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
from derive.spec.model.specification import AnyScene

S = TypeVar("S", bound=AnyScene)
Result = TypeVar("Result")

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


def with_redundant_joints(scene: S, action: Callable[[S], Result]) -> Result:
    """The result of an action with a scene; it is repeated for a model that resolves redundant joints if it needs that.

    action: generates a model of the scene that is given to it, and raises one of `DEPENDENT` where its constraints
    depend on each other. That is final if the scene says what to do about redundant joints, if a drive cannot be
    followed, or if the other model does not help.
    """
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
