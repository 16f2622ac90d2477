"""Lines on models that a search leaves out: those that the bodies of a scene do not have, and what nothing watches."""

from __future__ import annotations

from collections.abc import Iterator

from derive.simulation.validity.bending_planes import spatial_beams
from derive.simulation.validity.monitoring_outputs import is_monitored
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import Shapes
from derive.study.accuracy.modelled_bodies import flexible_members
from derive.study.choice.modes_of_bodies import ModesOfBodies


def untried(scene: AnyScene, modes: ModesOfBodies) -> tuple[str, ...]:
    """The lines on what is not tried, and not checked, in a scene in space; planar beams have all models."""
    if not isinstance(scene, SpatialScene):
        return ()
    return tuple(_lines(scene, modes))


def _lines(scene: SpatialScene, modes: ModesOfBodies) -> Iterator[str]:
    for body in flexible_members(scene):
        if isinstance(body, SpatialBeam):
            rigid = [name for name, part in (("twist", body.torsion), ("stretch", body.axial)) if part is None]
            if rigid:
                yield f"{body.name} does not {' or '.join(rigid)}, as its table has no stiffness against it"
        elif isinstance(body, FlexibleBody):
            yield from _of_modes(body, modes)
    if not (spatial_beams(scene) and is_monitored(scene)):
        yield "no monitor watches these bodies: errors are those that are measured"


def _of_modes(body: FlexibleBody, modes: ModesOfBodies) -> Iterator[str]:
    """The lines on a finite-element body."""
    kinds = modes.kinds(body)
    if kinds == (Shapes.GIVEN,):
        why = "which alone have geometric stiffness" if body.body.second_order else "as these have no stiffness matrix"
        yield f"{body.name} has the modes of its files, {why}"
    for (name, kind), why in modes.refusals.items():
        if name == body.name:
            yield f"{name} has no {kind.value}: {why}"
    yield f"{body.name}: errors are those of its modes; what finer elements would change is not known"
    if modes.order(body) is DisplacementOrder.FIRST_ORDER:
        yield f"{body.name} has modes of first order alone: a load along it does not change its stiffness"
