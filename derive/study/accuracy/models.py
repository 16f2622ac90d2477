"""The models of a ladder: one scene whose beams are rigid, or have few or many shapes, of first or second order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from fractions import Fraction
from itertools import product
from typing import Any, assert_never

from derive.mechanics.bodies.deflection_projection import projection
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.simulation.initial.deflection_remainders import remainder_lines
from derive.simulation.observables.beams import beam_bodies, shape_functions
from derive.simulation.observables.default_plots import output_columns
from derive.spec.construction import validated
from derive.spec.model.beam_parts import FamilyKind, Frame, Polynomial, ShapeFamily
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.plots import ColumnCurves
from derive.spec.model.ports import SceneOutput
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.scene import BeamBody, RigidBody, Scene
from derive.spec.parsing import choices
from derive.spec.tables.beam import frame_from
from derive.study.accuracy.rigid_beam import rigid_beam, rigid_loads
from derive.study.study_options import LadderRange
from derive.study.table import columns
from derive.terminal import beam_count


class Shapes(Enum):
    """The kind of the shape functions of the beams."""

    RIGID = "rigid"
    """The beams are rigid bodies."""
    POLYNOMIALS = "polynomials"
    """Polynomials of rising degree in a floating frame."""
    SINES = "sines"
    """Half sine waves in the chord frame: the natural modes of a beam between pins."""
    FREE_FREE = "free-free modes"
    """Natural modes of a free beam, in the mean frame."""
    CLAMPED_FREE = "clamped-free modes"
    """Natural modes of a beam that is clamped at its left end, in the tangent frame there."""


FAMILIES: dict[Shapes, tuple[FamilyKind, Frame]] = {
    Shapes.SINES: ("pinned", Frame("chord")),
    Shapes.FREE_FREE: ("free-free", Frame("mean")),
    Shapes.CLAMPED_FREE: ("clamped-free", Frame("tangent", Fraction(-1))),
}
"""The natural modes that are used as shapes, and the frame whose conditions they fulfil."""

MODES = {"free-free": Shapes.FREE_FREE, "clamped-free": Shapes.CLAMPED_FREE}
"""Natural modes beside the half sine waves by their names in a command."""

ORDERS = {
    "first": DisplacementOrder.FIRST_ORDER,
    "truncated": DisplacementOrder.TRUNCATED,
    "full": DisplacementOrder.FULL,
}
"""The orders of displacements by their names in a command."""


@dataclass(frozen=True)
class LadderModel:
    """The model of the beams of a scene: the order and the kind of shapes, their number, the frame, the pieces.

    beams: models of the beams by their names, where they differ; the other fields are then those of the finest.
    """

    shapes: Shapes
    count: int = 0
    order: DisplacementOrder = DisplacementOrder.FIRST_ORDER
    frame: str = "mean"
    pieces: int = 1
    beams: tuple[tuple[str, LadderModel], ...] = ()

    def of(self, beam: str) -> LadderModel:
        """The model of a beam."""
        return dict(self.beams).get(beam, self)

    @property
    def size(self) -> int:
        """The coordinates of a beam without its joints; a rigid one counts as none."""
        return self.pieces * (3 * (self.count > 0) + self.count)

    @property
    def kind(self) -> tuple[object, ...]:
        """The key that models share of which one has the shapes of the other and more."""
        return self.shapes, self.order, self.frame, self.pieces

    @property
    def label(self) -> str:
        """The text of the model: 2 beams, P2 to P4, full; crank: rigid; rod: 1 sine, first."""
        if self.beams:
            groups: dict[str, list[str]] = {}
            for name, model in self.beams:
                groups.setdefault(model.label, []).append(name)
            return "; ".join(f"{', '.join(names)}: {label}" for label, names in groups.items())
        match self.shapes:
            case Shapes.RIGID:
                return "rigid"
            case Shapes.SINES:
                text = f"{self.count} sine{'s' * (self.count > 1)}"
            case Shapes.FREE_FREE | Shapes.CLAMPED_FREE:
                text = f"{self.count} {self.shapes.value if self.count > 1 else self.shapes.value.removesuffix('s')}"
            case Shapes.POLYNOMIALS:
                text = f"{beam_count(self.pieces)}, {self._polynomials}"
                text += f", {self.frame}" if self.frame != "mean" else ""
            case _ as never:
                assert_never(never)
        return f"{text}, {next(name for name, order in ORDERS.items() if order is self.order)}"

    @property
    def _polynomials(self) -> str:
        """The text of polynomials: P2 to P4 in the mean frame (Legendre polynomials), elsewhere their number."""
        if self.frame != "mean":
            return f"{self.count} shapes"
        names = [f"P{n}" for n in (2, self.count + 1)]
        return names[0] if self.count == 1 else ", ".join(names) if self.count == 2 else " to ".join(names)


MODEL_COLUMNS = columns("model", "order", "shapes", "number_of_shapes", "beams", "frame")
"""The columns of the tables of ladders that describe a model."""


def model_row(model: LadderModel, label: str) -> tuple[Any, ...]:
    """The values of `MODEL_COLUMNS`, with the text that names the model."""
    return label, model.order.value, model.shapes.value, model.count, model.pieces, model.frame


def ladder(limits: LadderRange) -> tuple[LadderModel, ...]:
    """The models in the order of their number of coordinates, from rigid beams on."""
    return tuple(sorted(dict.fromkeys(_models(limits)), key=lambda m: (m.size, m.label)))


def mixed(beams: Mapping[str, LadderModel]) -> LadderModel:
    """The model of a scene with the given models of the beams, by their names."""
    models = tuple(beams.values())
    if all(model == models[0] for model in models):
        return models[0]
    return replace(max(models, key=lambda m: m.size), beams=tuple(beams.items()))


def _models(limits: LadderRange) -> Iterator[LadderModel]:
    yield LadderModel(Shapes.RIGID)
    for order in (ORDERS[name] for name in limits.orders):
        for modes, count in product((Shapes.SINES, *(MODES[name] for name in limits.modes)), limits.sines):
            yield LadderModel(modes, count, order, FAMILIES[modes][1].kind)
        for frame, count in product(limits.frames, limits.shapes):
            yield LadderModel(Shapes.POLYNOMIALS, count, order, frame)
        for frame, pieces in product(limits.frames, limits.pieces):
            yield LadderModel(Shapes.POLYNOMIALS, 2, order, frame, pieces)


def model_scene(scene: Scene, model: LadderModel) -> Scene:
    """The scene with all its beams replaced as in a model, and with those of its outputs that it plots.

    Raises SpecError if the beams cannot be modelled so.
    """
    if isinstance(scene, SpatialScene):
        from derive.spec.model.spatial_beam import SpatialBeam
        return replace(scene, bodies=tuple(replace(b, order=model.order) if isinstance(b, SpatialBeam) else b for b in scene.bodies))
    bodies = tuple(modelled(body, model.of(body.name)) if isinstance(body, BeamBody) else body for body in scene.bodies)
    plots = tuple(replace(plot, cut=None, pieces=()) for plot in scene.plots)
    rigid = (body for body in beam_bodies(scene) if model.of(body.name).shapes is Shapes.RIGID)
    forces = (*scene.forces, *(force for body in rigid for force in rigid_loads(body)))
    return validated(replace(scene, bodies=bodies, plots=plots, outputs=plotted_outputs(scene), forces=forces))


def plotted_outputs(scene: Scene) -> tuple[SceneOutput, ...]:
    """The outputs whose components are columns of a plot; others may need what a model does not have."""
    quantities = (plot.quantity for plot in scene.plots)
    used = {column for of in quantities if isinstance(of, ColumnCurves) for column in (of.x, *of.y)}
    return tuple(output for output in scene.outputs if used & set(output_columns(output)))


def modelled(body: BeamBody, model: LadderModel) -> BeamBody | RigidBody:
    """A beam with a model, as a rigid body if that is rigid; see `_startable`. Raises SpecError if it is impossible."""
    if model.shapes is Shapes.RIGID:
        return rigid_beam(body)
    ansatz: tuple[Polynomial, ...] | ShapeFamily
    if model.shapes in FAMILIES:
        family, frame = FAMILIES[model.shapes]
        ansatz = ShapeFamily(family, model.count)
    else:
        frame = _frame(model.frame)
        ansatz = tuple(tuple(Fraction(int(i == n)) for i in range(n + 1)) for n in range(model.count + 2))
    orthogonal = frame.kind == "mean" and model.shapes is Shapes.POLYNOMIALS
    beam = replace(body.beam, ansatz=ansatz, frame=frame, orthogonal=orthogonal, order=model.order, ends=None)
    return _startable(replace(body, beam=beam, pieces=model.pieces))


def _startable(body: BeamBody) -> BeamBody:
    """The beam with its initial values as a guess if its shapes do not have its initial deflection or its rate."""
    curves, shapes = (body.start.deflection, body.start.deflection_rate), assumed_shapes(body.beam.deflection)
    if any(projection(curve, shapes, body.pieces).remainder for curve in curves if curve):
        return replace(body, start=replace(body.start, guess=True))
    return body


def start_remainders(scene: Scene, model: LadderModel) -> tuple[str, ...]:
    """A line on each initial deflection of which a model of a scene has only the nearest that its shapes describe."""
    lines: list[str] = []
    for beam in beam_bodies(scene):
        body = modelled(beam, model.of(beam.name))
        rigid = isinstance(body, RigidBody)
        shapes, pieces = ((), 1) if isinstance(body, RigidBody) else (shape_functions(body), body.pieces)
        lines += remainder_lines(beam, shapes, pieces, "the rigid motion" if rigid else "the shapes")
    return tuple(lines)


def _frame(name: str) -> Frame:
    """A frame by its name in a command; a tangent frame is at the left end."""
    kind = choices.frame_kind(name)
    return frame_from(kind, Fraction(-1) if kind == "tangent" else None)


def refinements() -> tuple[LadderModel, ...]:
    """Ever finer models, of which the last two give a reference and its error.

    They are of second order, with more and more pieces, which include what a single piece neglects. In the mean frame
    the truncated terms are as good as the full ones there, and far cheaper to derive.
    """
    order = DisplacementOrder.TRUNCATED
    return tuple(LadderModel(Shapes.POLYNOMIALS, 4, order, "mean", pieces) for pieces in (1, 2, 3))
