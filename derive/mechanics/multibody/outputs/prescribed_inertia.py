"""Bodies whose motion is prescribed, so that they need neither mass nor inertia, and the outputs that count these."""

from __future__ import annotations

from collections.abc import Iterator

from derive.mechanics.multibody.bodies.registry import BODIES
from derive.mechanics.multibody.outputs.registry import output_type
from derive.mechanics.multibody.space.bodies import SPATIAL_BODIES
from derive.mechanics.multibody.space.outputs import SPATIAL_OUTPUTS
from derive.spec.model.scene import Scene
from derive.spec.model.specification import AnyScene


def inertia_notes(scene: AnyScene) -> tuple[str, ...]:
    """A line on each body of a mechanism without mass or inertia, if an output counts them: as 0.

    The motion of such a body is prescribed; `derive` refuses it otherwise.
    """
    planar = isinstance(scene, Scene)
    kinds = (output.kind for output in scene.outputs)
    if not any((output_type(kind) if planar else SPATIAL_OUTPUTS[kind]).counts_inertia for kind in kinds):
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
