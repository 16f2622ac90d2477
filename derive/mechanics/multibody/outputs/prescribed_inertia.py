"""Bodies whose motion is prescribed, so that they need neither mass nor inertia, and the outputs that count these."""

from __future__ import annotations

from derive.mechanics.multibody.bodies.registry import BODIES
from derive.mechanics.multibody.outputs.registry import output_type
from derive.spec.model.scene import Scene


def inertia_notes(scene: Scene) -> tuple[str, ...]:
    """A line on each body of a mechanism without mass or inertia, if an output counts them: as 0.

    The motion of such a body is prescribed; `derive` refuses it otherwise.
    """
    if not any(output_type(output.kind).counts_inertia for output in scene.outputs):
        return ()
    bodies = ((body.name, BODIES[body.kind].missing(body)) for body in scene.bodies)
    return tuple(
        f"{name}: {' and '.join(missing)}: not given -> 0 in energies, powers, reactions and forces of drives; its "
        "motion is prescribed and does not depend on them"
        for name, missing in bodies
        if missing
    )
