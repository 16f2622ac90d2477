"""The flexible bodies of a scene in space as the models of a ladder have them: beams, finite-element bodies, or rigid.

Finite-element bodies are tried with component modes, which are computed from their stiffness matrix; where the files
have none, with the modes that these contain.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction

from derive.errors import Problem, SpecError
from derive.mechanics.bodies.section_fields import section_shapes
from derive.reduction.component_modes import static_mode_count
from derive.reduction.eigen import max_elastic_modes
from derive.reduction.integrals import canonical_csr
from derive.reduction.interface import RIGID_MOTIONS
from derive.reduction.mode_selection import with_selected_modes
from derive.simulation.space.bent_beams import initial_curves, remainders_of
from derive.spec.model.beam_parts import Polynomial
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.tables.body import interface_markers
from derive.study.accuracy.ladder_model import COMPONENT_MODES, STATIC, LadderModel, Shapes, deflection_of
from derive.study.accuracy.spatial_rigid import rigid_in_space


def flexible_bodies(scene: SpatialScene) -> tuple[SpatialBeam | FlexibleBody, ...]:
    """The bodies of a scene in space that models of a ladder replace: beams and finite-element bodies."""
    return tuple(body for body in scene.bodies if isinstance(body, (SpatialBeam, FlexibleBody)))


def modelled_in_space(scene: SpatialScene, body: SpatialBody, model: LadderModel) -> SpatialBody:
    """A body with a model, if it is flexible and the model is one of such bodies. Raises SpecError if it cannot be."""
    if not isinstance(body, (SpatialBeam, FlexibleBody)) or not can_have(scene, body, model):
        return body
    if body.start.amplitudes or body.start.amplitude_rates:
        text = "models have other shapes, to which these amplitudes do not belong; leave them out"
        raise SpecError((Problem(f"bodies.{body.name}.start", text),))
    if model.shapes is Shapes.RIGID:
        return rigid_in_space(body)
    if isinstance(body, SpatialBeam):
        return _startable(_beam(body, model))
    return _component_modes(scene, body, model)


def _beam(body: SpatialBeam, model: LadderModel) -> SpatialBeam:
    """A beam whose shapes are those of a model in both planes."""
    shapes = deflection_of(model)
    lateral = body.lateral and (None if body.lateral.bending_stiffness is None else replace(body.lateral, ansatz=None))
    torsion = body.torsion
    if torsion is not None and model.torsion is not None:
        torsion = replace(torsion, ansatz=twists(model.torsion)) if model.torsion else None
    return replace(
        body,
        ansatz=shapes.ansatz,
        frame=shapes.frame,
        orthogonal=shapes.orthogonal,
        order=model.order,
        ends=None,
        lateral=lateral,
        torsion=torsion,
        pieces=model.pieces,
    )


def _startable(body: SpatialBeam) -> SpatialBeam:
    """The beam with its initial values as a guess if its shapes do not have its initial curves."""
    if any(curve.nearest.remainder for curve in initial_curves(body)):
        return replace(body, start=replace(body.start, guess=True))
    return body


def remainders_in_space(scene: SpatialScene, models: Callable[[str], LadderModel]) -> Iterator[str]:
    """A line on each initial curve of which a model has only the nearest that it describes; models: by bodies."""
    for body in scene.bodies:
        if isinstance(body, SpatialBeam):
            model = models(body.name)
            rigid = model.shapes is Shapes.RIGID
            yield from remainders_of(body if rigid else _beam(body, model), rigid)


def twists(count: int) -> tuple[Polynomial, ...]:
    """The ansatz of torsion xi, xi^2, ..., of that many polynomials."""
    return tuple((Fraction(0),) * power + (Fraction(1),) for power in range(1, count + 1))


def _component_modes(scene: SpatialScene, body: FlexibleBody, model: LadderModel) -> FlexibleBody:
    """A finite-element body with modes of the kind of a model."""
    kind, held = COMPONENT_MODES[model.shapes], interface(scene, body) if model.shapes in STATIC else ()
    count = mode_count(scene, body, model)
    markers = interface_markers(held, body.markers, body.body.data)
    own = replace(body.body, component_modes=kind, interface=held, interface_markers=markers, modes=count)
    own = replace(own, order=model.order)
    return replace(body, body=own)


def interface(scene: SpatialScene, body: FlexibleBody) -> tuple[str, ...]:
    """The markers that hold a body: those that it names as its interface, otherwise those of its joints."""
    ends = {end.marker for joint in scene.joints for end in (joint.first, joint.second) if end.body == body.name}
    return body.body.interface or tuple(marker.name for marker in body.markers if marker.name in ends)


def mode_count(scene: SpatialScene, body: FlexibleBody, model: LadderModel) -> int:
    """The number of modes of a finite-element body with a model, static ones of its interface included."""
    if model.shapes not in STATIC:
        return model.count
    held = interface_markers(interface(scene, body), body.markers, body.body.data)
    return model.count + static_mode_count(str(COMPONENT_MODES[model.shapes]), held)


def can_have(scene: SpatialScene, body: SpatialBeam | FlexibleBody, model: LadderModel) -> bool:
    """Whether a model is one of such a body, and its data suffice for it."""
    if isinstance(body, SpatialBeam) or model.shapes is Shapes.RIGID:
        return model.shapes not in COMPONENT_MODES
    if model.shapes not in COMPONENT_MODES or model.count > most_modes(scene, body, model.shapes):
        return False
    data, given = body.body.data, model.shapes is Shapes.GIVEN
    if not _has_order(body, model.order, given):
        return False
    if given:
        return data.modes is not None
    if data.stiffness is None or (model.shapes in STATIC and not _is_held(scene, body)):
        return False
    return model.order is DisplacementOrder.FIRST_ORDER or mode_count(scene, body, model) > 0


def _has_order(body: FlexibleBody, order: DisplacementOrder, given: bool) -> bool:
    """Whether a body has modes of an order: truncated by the files, if its modes are given, or by its elements."""
    data, own = body.body.data, body.body.data.has_geometric_stiffness and given
    stiffens = own or data.gives_geometric_stiffness
    return order is DisplacementOrder.FIRST_ORDER or (order is DisplacementOrder.TRUNCATED and stiffens)


def _is_held(scene: SpatialScene, body: FlexibleBody) -> bool:
    """Whether the interface of a body may hold it: a set of nodes does, and so do three nodes that are on no line."""
    held = interface_markers(interface(scene, body), body.markers, body.body.data)
    return any(len(marker.nodes) > 1 for marker in held) or len(held) > 2


def most_modes(scene: SpatialScene, body: FlexibleBody, shapes: Shapes) -> int:
    """The largest number of modes of a kind, beside static ones, that the nodes or the files of a body have."""
    data = body.body.data
    if shapes is Shapes.GIVEN:
        return 0 if data.modes is None else len(data.modes)
    elastic = max_elastic_modes(canonical_csr(data.mass), RIGID_MOTIONS, body.body.rigid_sets)
    return elastic - mode_count(scene, body, LadderModel(shapes))


def coordinates(body: SpatialBody) -> int:
    """The number of coordinates of a body without joints; a quaternion counts as three."""
    if isinstance(body, SpatialBeam):
        return body.pieces * (RIGID_MOTIONS + len(section_shapes(body)))
    if not isinstance(body, FlexibleBody):
        return RIGID_MOTIONS
    own, given = with_selected_modes(body.body).modes, body.body.data.modes
    return RIGID_MOTIONS + (own if isinstance(own, int) else 0 if given is None else len(given))
