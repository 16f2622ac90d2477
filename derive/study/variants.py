"""One scene in several frames, its beams cut into several numbers of pieces, and the operation counts of each."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca

from derive.errors import Problem, SpecError
from derive.ir.analysis import operations
from derive.ir.model import Model
from derive.lowering.elimination_orders import EliminationRule, work
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context, stores
from derive.lowering.flat.kkt_matrix import jacobian_entries, kkt_factors, kkt_pattern
from derive.lowering.flat.schedule import Step
from derive.mechanics.bodies.displacement_fields import displacement_fields
from derive.mechanics.bodies.reference_conditions import ConditionError
from derive.mechanics.equations import Equations
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene
from derive.spec.parsing import choices
from derive.spec.tables.beam import frame_from


@dataclass(frozen=True)
class SceneVariant:
    """A scene whose beams are cut into `pieces` each, all of them in the frame of the kind `frame`."""

    pieces: int
    frame: str
    scene: Scene


def variant(scene: Scene, pieces: int, frame: str) -> SceneVariant:
    """The scene with each beam cut into `pieces`, in the frame of the kind `frame`."""
    bodies = tuple(_in_frame(b, pieces, frame) if isinstance(b, BeamBody) else b for b in scene.bodies)
    return SceneVariant(pieces, frame, replace(scene, bodies=bodies))


def _in_frame(beam: BeamBody, pieces: int, name: str) -> BeamBody:
    """The beam that a specification with this frame gives; a beam in this frame keeps its shape functions.

    Raises SpecError if its ansatz does not fit the frame.
    """
    frame = frame_from(choices.frame_kind(name), None)
    if frame == beam.beam.frame:
        return replace(beam, pieces=pieces)
    changed = replace(beam.beam, frame=frame, orthogonal=frame.kind == "mean")
    try:
        displacement_fields(changed)
    except ConditionError as error:
        path = f"bodies.{beam.name}.ansatz"
        raise SpecError(tuple(Problem(path, f"in the frame {name}: {text}") for text in error.problems)) from None
    return replace(beam, pieces=pieces, beam=changed)


@dataclass(frozen=True)
class OperationCounts:
    """Counts of one scene; non-zeros (`mass`, `kkt`) are structural, of both triangles.

    fill: the fill-in of LDL^T in one triangle. flops: the operations of LDL^T, if no entry is known before run time.
    factorise: those of LDL^T in the generated code, which computes what depends on parameters alone in setup. force,
    accel: those of these kernels, in which a sine counts as one.
    """

    coordinates: int
    multipliers: int
    mass: int
    kkt: int
    fill: int
    flops: int
    factorise: int
    force: int
    accel: int


def operation_counts(
    equations: Equations, model: Model, elimination: EliminationRule = EliminationRule.SAFE
) -> OperationCounts:
    """The counts of the expanded equations of a scene, and of their model, which is lowered with this elimination."""
    context = Context(equations, elimination, model.proximal)
    factors = kkt_factors(context, context.symbols(context.t, context.q))
    return OperationCounts(
        coordinates=len(context.rows),
        multipliers=len(context.multipliers),
        mass=context.mass_pattern().full_nnz,
        kkt=kkt_pattern(context).full_nnz,
        fill=factors.fill,
        flops=work(kkt_pattern(context), factors.order),
        factorise=_generated(context),
        force=model.kernel("force").operations,
        accel=model.kernel("accel").operations,
    )


def _generated(context: Context) -> int:
    """The operations of a kernel that computes L and D, minus those of one that computes the entries of M and G."""
    symbols = context.symbols(context.t, context.q)
    values = [symbols(context.equations.mass[entry]) for entry in context.mass_pattern().entries]
    values += jacobian_entries(context, symbols).values()
    entries = _operations(context, symbols, values)
    symbols = context.symbols(context.t, context.q)
    factors = kkt_factors(context, symbols)
    values = [*factors.pivots, *factors.inverses, *(x for column in factors.lower.values() for _, x in column)]
    return _operations(context, symbols, values) - entries


def _operations(context: Context, symbols: Symbols, values: list[ca.SX]) -> int:
    sections = context.sections(symbols, Step("A", "", "values", stores("A", values)))
    return sum(operations(statement) for section in sections for statement in section.body)
