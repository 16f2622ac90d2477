"""The models of a ladder: one scene whose flexible bodies are rigid, or have few or many shapes of either order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import Any, TypeVar

from derive.errors import Problem, SpecError
from derive.mechanics.bodies.deflection_projection import projection
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.mechanics.multibody.outputs.registry import OUTPUTS
from derive.mechanics.multibody.space.marker_outputs import DEFLECTION, MARKER, OF_CHORD, STRESS
from derive.mechanics.multibody.space.outputs import SPATIAL_OUTPUTS
from derive.simulation.initial.deflection_remainders import remainder_lines
from derive.simulation.observables.beams import beam_bodies, shape_functions
from derive.simulation.observables.default_plots import output_columns
from derive.spec.construction.validated import validated
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.keys import KeyType
from derive.spec.model.markers import MarkerRef
from derive.spec.model.planar_bodies import BeamBody, RigidBody
from derive.spec.model.plots import ColumnCurves
from derive.spec.model.ports import SceneOutput
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_forces import SpatialForce, SpatialTorque
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import FAMILIES, MODES, ORDERS, LadderModel, Shapes, deflection_of
from derive.study.accuracy.rigid_beam import rigid_beam, rigid_loads
from derive.study.accuracy.spatial_ladder import spatial_ladder, spatial_refinements
from derive.study.accuracy.spatial_models import flexible_bodies, modelled_in_space, remainders_in_space
from derive.study.accuracy.spatial_rigid import rigid_actions
from derive.study.study_options import LadderRange

S = TypeVar("S", bound=AnyScene)


def ladder(limits: LadderRange, scene: AnyScene | None = None) -> tuple[LadderModel, ...]:
    """The models in the order of their number of coordinates, from rigid bodies on; those of a scene in space."""
    if isinstance(scene, SpatialScene):
        return spatial_ladder(scene, limits)
    return tuple(sorted(dict.fromkeys(_models(limits)), key=lambda m: (m.size, m.label)))


def _models(limits: LadderRange) -> Iterator[LadderModel]:
    yield LadderModel(Shapes.RIGID)
    for order in (ORDERS[name] for name in limits.orders):
        for modes, count in product((Shapes.SINES, *(MODES[name] for name in limits.modes)), limits.sines):
            yield LadderModel(modes, count, order, FAMILIES[modes][1].kind)
        for frame, count in product(limits.frames, limits.shapes):
            yield LadderModel(Shapes.POLYNOMIALS, count, order, frame)
        for frame, pieces in product(limits.frames, limits.pieces):
            yield LadderModel(Shapes.POLYNOMIALS, 2, order, frame, pieces)


def model_scene(scene: S, model: LadderModel) -> S:
    """The scene with its flexible bodies replaced as in a model, and with those of its outputs that it plots.

    Raises SpecError if the bodies cannot be modelled so.
    """
    plots = tuple(replace(plot, cut=None, pieces=()) for plot in scene.plots)
    whole: Any = replace(scene, plots=plots, outputs=plotted_outputs(scene))
    if isinstance(scene, SpatialScene):
        rigid = [b for b in flexible_bodies(scene) if model.of(b.name).shapes is Shapes.RIGID]
        _refuse_deformations(whole, [body.name for body in rigid])
        bodies = tuple(modelled_in_space(scene, body, model.of(body.name)) for body in scene.bodies)
        actions = [action for b in rigid if isinstance(b, SpatialBeam) for action in rigid_actions(b)]
        forces = (*scene.forces, *(action for action in actions if isinstance(action, SpatialForce)))
        torques = (*scene.torques, *(action for action in actions if isinstance(action, SpatialTorque)))
        return _checked(scene, replace(whole, bodies=bodies, forces=forces, torques=torques))
    planar = tuple(modelled(body, model.of(body.name)) if isinstance(body, BeamBody) else body for body in scene.bodies)
    beams = (body for body in beam_bodies(scene) if model.of(body.name).shapes is Shapes.RIGID)
    loads = (force for body in beams for force in rigid_loads(body))
    return _checked(scene, replace(whole, bodies=planar, forces=(*scene.forces, *loads)))


def _refuse_deformations(scene: SpatialScene, rigid: list[str]) -> None:
    """Raise SpecError if a plotted output is of the deformation or of a section of a body that is rigid."""
    for output in scene.outputs:
        for marker in deformed_markers(output, in_space=True):
            if marker.body in rigid:
                text = f"as a rigid body it has no {output.kind} at {marker}, which the plot shows"
                raise SpecError((Problem(f"bodies.{marker.body}", text),))


def deformed_markers(output: SceneOutput, in_space: bool) -> Iterator[MarkerRef]:
    """The markers of an output of what deforms: of sections of beams, of deflections without a chord, of stresses."""
    known: Any = SPATIAL_OUTPUTS if in_space else OUTPUTS
    names = [key.name for key in known[output.kind].keys if key.type is KeyType.BEAM_MARKER]
    if output.kind == STRESS or (in_space and output.kind == DEFLECTION and OF_CHORD.name not in output.values):
        names.append(MARKER.name)
    yield from (marker for name in names if isinstance(marker := output.values.get(name), MarkerRef))


def _checked(_: S, changed: Any) -> S:
    """A changed scene, checked as a file is."""
    result: S = validated(changed)
    return result


def plotted_outputs(scene: AnyScene) -> tuple[SceneOutput, ...]:
    """The outputs whose components are columns of a plot; others may need what a model does not have."""
    in_space = isinstance(scene, SpatialScene)
    quantities = (plot.quantity for plot in scene.plots)
    used = {column for of in quantities if isinstance(of, ColumnCurves) for column in (of.x, *of.y)}
    return tuple(output for output in scene.outputs if used & set(output_columns(output, in_space)))


def modelled(body: BeamBody, model: LadderModel) -> BeamBody | RigidBody:
    """A beam with a model, as a rigid body if that is rigid; see `_startable`. Raises SpecError if it is impossible."""
    if model.shapes is Shapes.RIGID:
        return rigid_beam(body)
    shapes = deflection_of(model)
    beam = replace(
        body.beam,
        ansatz=shapes.ansatz,
        frame=shapes.frame,
        orthogonal=shapes.orthogonal,
        order=model.order,
        ends=None,
    )
    return _startable(replace(body, beam=beam, pieces=model.pieces))


def _startable(body: BeamBody) -> BeamBody:
    """The beam with its initial values as a guess if its shapes do not have its initial deflection or its rate."""
    curves, shapes = (body.start.deflection, body.start.deflection_rate), assumed_shapes(body.beam.deflection)
    if any(projection(curve, shapes, body.pieces).remainder for curve in curves if curve):
        return replace(body, start=replace(body.start, guess=True))
    return body


def start_remainders(scene: AnyScene, model: LadderModel) -> tuple[str, ...]:
    """A line on each initial deflection of which a model of a scene has only the nearest that its shapes describe."""
    lines = list(remainders_in_space(scene, model.of)) if isinstance(scene, SpatialScene) else []
    for beam in beam_bodies(scene):
        body = modelled(beam, model.of(beam.name))
        rigid = isinstance(body, RigidBody)
        shapes, pieces = ((), 1) if isinstance(body, RigidBody) else (shape_functions(body), body.pieces)
        lines += remainder_lines(beam, shapes, pieces, "the rigid motion" if rigid else "the shapes")
    return tuple(lines)


def refinements(scene: AnyScene | None = None) -> tuple[LadderModel, ...]:
    """Ever finer models, of which the last two give a reference and its error.

    They are of second order, with more and more pieces, which include what a single piece neglects. In the mean frame
    the truncated terms are as good as the full ones there, and far cheaper to derive.
    """
    if isinstance(scene, SpatialScene):
        return spatial_refinements(scene)
    order = DisplacementOrder.TRUNCATED
    return tuple(LadderModel(Shapes.POLYNOMIALS, 4, order, "mean", pieces) for pieces in (1, 2, 3))
