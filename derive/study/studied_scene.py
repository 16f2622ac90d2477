"""The scene that a study is given: with a simulation, in the plane or in space, and with beams if it needs them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

from derive.errors import Problem, SpecError
from derive.simulation.simulate import with_simulation
from derive.spec.model.planar_bodies import BeamBody, CustomBody, SceneBody
from derive.spec.model.scene import Scene
from derive.spec.model.simulation import NOT_GIVEN
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.spatial_start import NOT_GIVEN_IN_SPACE
from derive.spec.model.specification import AnyScene

S = TypeVar("S", bound=AnyScene)

COMPARED = (
    "study {} compares models of flexible bodies; see scenes/crank_slider_3.toml, and in space "
    "examples/spatial_crank_slider.toml"
)
"""The reason why a study with a name needs a flexible body."""


def planar_scene(scene: Any, needs_beam: str = "") -> Scene:
    """The planar scene, if it can be studied. Raises TypeError for what is no planar scene; see `studied_scene`."""
    if not isinstance(scene, Scene):
        raise TypeError(f"a planar scene is needed, such as derive.scene makes, not {type(scene).__name__}")
    return studied_scene(scene, needs_beam)


def flexible_scene(scene: S, reason: str) -> S:
    """The scene, if it can be studied and has a beam or a finite-element body; reason: why there has to be one.

    Raises what `studied_scene` raises.
    """
    whole = studied_scene(scene)
    if not has_flexible_body(whole):
        missing = "no beam and no finite-element body" if isinstance(whole, SpatialScene) else "no beam"
        raise SpecError((Problem("bodies", f"there is {missing} here, and {reason}"),))
    return whole


def has_flexible_body(scene: AnyScene) -> bool:
    """Whether a scene has a beam or a finite-element body, of which there are several models."""
    return any(isinstance(body, (BeamBody, SpatialBeam, FlexibleBody)) for body in scene.bodies)


def studied_scene(scene: S, needs_beam: str = "") -> S:
    """The scene, in the plane or in space, if it can be studied. needs_beam: the reason why there has to be a beam.

    Raises TypeError for what is no scene, SpecError for a scene without simulation or without the beam.
    """
    if not isinstance(scene, AnyScene):
        text = "a scene is needed, such as derive.scene and derive.spatial_scene make"
        raise TypeError(f"{text}, not {type(scene).__name__}")
    if needs_beam and not any(isinstance(body, (BeamBody, SpatialBeam)) for body in scene.bodies):
        raise SpecError((Problem("bodies", f"there is no beam here, and {needs_beam}"),))
    return with_simulation(scene)


def without_initial_values(scene: S) -> S:
    """The scene without its initial values, which its equations do not depend on."""

    def body(given: SceneBody) -> SceneBody:
        return given if isinstance(given, CustomBody) else replace(given, start=NOT_GIVEN)

    bodies = (replace(b, start=NOT_GIVEN_IN_SPACE) if isinstance(b, SpatialBody) else body(b) for b in scene.bodies)
    changes: dict[str, Any] = {
        "bodies": tuple(bodies),
        "joints": tuple(map(_without_own_start, scene.joints)),
        "drives": tuple(map(_without_own_start, scene.drives)),
    }
    of_scene: Any = scene
    result: S = replace(of_scene, **changes)
    return result


def _without_own_start(element: Any) -> Any:
    """A joint or a drive without its initial values."""
    return replace(element, start=type(element.start)())
