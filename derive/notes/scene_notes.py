"""Lines for a user on what a scene omits: masses of bodies that outputs count, and connections with the ground."""

from __future__ import annotations

from collections.abc import Iterator

from derive.mechanics.multibody.bodies.registry import BODIES
from derive.mechanics.multibody.outputs.registry import output_type
from derive.mechanics.multibody.space.bodies import SPATIAL_BODIES
from derive.mechanics.multibody.space.outputs import spatial_output_type
from derive.spec.model.markers import GROUND
from derive.spec.model.scene import Scene
from derive.spec.model.specification import AnyScene


def scene_notes(scene: AnyScene) -> tuple[str, ...]:
    """A line on each body without mass or inertia that an output counts, and on bodies that are unconstrained."""
    return *_inertia_notes(scene), *_connection_notes(scene)


def _inertia_notes(scene: AnyScene) -> tuple[str, ...]:
    """A line on each body of a mechanism without mass or inertia, if an output counts them: as 0.

    The motion of such a body is prescribed; `derive` refuses it otherwise.
    """
    planar = isinstance(scene, Scene)
    kinds = (output.kind for output in scene.outputs)
    if not any((output_type(kind) if planar else spatial_output_type(kind)).counts_inertia for kind in kinds):
        return ()
    bodies = _missing(scene)
    return tuple(
        f"{name}: {' and '.join(missing)}: not given -> 0 in energies, powers, reactions and forces of drives; its "
        "motion is prescribed and does not depend on them"
        for name, missing in bodies
        if missing
    )


def _missing(scene: AnyScene) -> Iterator[tuple[str, tuple[str, ...]]]:
    """The keys that each body lacks; finite-element bodies have their mass."""
    types = BODIES if isinstance(scene, Scene) else SPATIAL_BODIES
    for body in scene.bodies:
        if body.kind in types:
            yield body.name, types[body.kind].missing(body)


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
                f"{', '.join(names)}: no joint and no spring connects {them} with the ground, so {they} {moves} "
                "freely; add a joint if this is not intended"
            )
