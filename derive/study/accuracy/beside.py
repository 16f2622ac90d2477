"""Scenes that have other bodies in place of those of a scene, whose models stand in the same chart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from derive.errors import Problem, SpecError
from derive.simulation.inputs import with_functions
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.models import ladder, model_scene
from derive.study.studied_scene import COMPARED, flexible_scene
from derive.study.study_options import LadderRange


def beside(scene: AnyScene, compared: AnyScene) -> AnyScene:
    """A scene with the plot and the simulation of the one that is compared. Raises SpecError if it cannot have them."""
    try:
        given: Any = with_functions(flexible_scene(scene, COMPARED.format("accuracy")), {})
        (plot,) = compared.plots
        whole: AnyScene = replace(given, plots=(replace(plot, reference=None),), simulation=compared.simulation)
        model_scene(whole, LadderModel(Shapes.RIGID))
    except SpecError as error:
        raise SpecError(tuple(Problem(p.path, f"in {scene.name}: {p.message}") for p in error.problems)) from None
    return whole


def ladders(scenes: Sequence[AnyScene], limits: LadderRange) -> list[tuple[LadderModel, ...]]:
    """The models of each scene; of the rigid models that of the first alone, and those that are the same have names.

    Raises SpecError if a scene beside the first one has none.
    """
    result: list[tuple[LadderModel, ...]] = []
    for scene in scenes:
        earlier = {model for models in result for model in models}
        own = [m for m in ladder(limits, scene) if not (earlier and m.shapes is Shapes.RIGID)]
        if not own:
            text = f"{scene.name} has no model of order {' or '.join(limits.orders)} with these numbers of shapes"
            first = "; component modes are of first order where a file has no elements" * ("first" not in limits.orders)
            raise SpecError((Problem("bodies", f"{text}{first}. Allow other orders or numbers, or leave it out"),))
        result.append(tuple(replace(m, of_scene=scene.name) if m in earlier else m for m in own))
    return result
