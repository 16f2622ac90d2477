"""Lines for a user on what a scene omits: masses of bodies that outputs count, and connections with the ground."""

from __future__ import annotations

from collections.abc import Iterator

from derive.mechanics.multibody.outputs.prescribed_inertia import inertia_notes
from derive.spec.model.markers import GROUND
from derive.spec.model.specification import AnyScene


def scene_notes(scene: AnyScene) -> tuple[str, ...]:
    """A line on each body without mass or inertia that an output counts, and on bodies that are unconstrained."""
    return *inertia_notes(scene), *_connection_notes(scene)


def _connection_notes(scene: AnyScene) -> Iterator[str]:
    """A line on each group of bodies without a joint or a spring to the ground, which may be a joint that is missing.

    A scene without joints and without points of the ground is one of free bodies.
    """
    if not (scene.joints or scene.ground):
        return
    groups = [{GROUND}, *({body.name} for body in scene.bodies)]
    connections = [{j.first.body, j.second.body} for j in scene.joints]
    connections += [{marker.body for marker in spring.markers} for spring in scene.springs]
    for ends in connections:
        joined = [group for group in groups if group & ends]
        groups = [group for group in groups if not group & ends] + [set().union(*joined)]
    for group in groups:
        if GROUND not in group:
            names = [body.name for body in scene.bodies if body.name in group]
            them, they = ("it", "it") if len(names) == 1 else ("them", "they")
            moves = ("falls" if scene.gravity else "moves") if they == "it" else ("fall" if scene.gravity else "move")
            yield (
                f"{', '.join(names)}: no joint and no spring connects {them} with the ground, so that {they} {moves} "
                "freely; if this is not meant, a joint is missing"
            )
