"""Faults of columns that plots or conditions use and that no trajectory of the specification has.

Which coordinates and multipliers there are is known when the equations are derived, as joints eliminate some. What a
scene cannot have in any case is refused when it is read.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator

from derive.errors import quoted
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.outputs.registry import OUTPUTS
from derive.spec.checks.name_clashes import RATES, coordinate_names
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import ShapeFamily
from derive.spec.model.instances import joined, rate_name
from derive.spec.model.planar_bodies import BeamBody, RigidBody
from derive.spec.model.plots import ColumnCurves, Plot
from derive.spec.model.scene import Scene
from derive.spec.model.specification import Specification
from derive.spec.parsing.condition import condition
from derive.spec.parsing.faults import Fault, did_you_mean, names_text
from derive.spec.parsing.parser import ExpressionError


def column_faults(spec: Specification) -> Iterator[Fault]:
    """Faults of columns of plots and of the condition `until` that no trajectory of a specification can have."""
    possible = possible_columns(spec)
    if possible is None:
        return
    yield from missing_columns(spec.plots, possible, f"columns may be {names_text(possible)}")
    if spec.simulation is not None and spec.simulation.until is not None:
        try:
            condition(spec.simulation.until, possible)
        except ExpressionError as error:
            yield Fault(("simulation", "until"), str(error))


def missing_columns(plots: Iterable[Plot], known: Collection[str], otherwise: str) -> Iterator[Fault]:
    """Faults of plots with columns that are not `known`. otherwise: the hint if no known column has a similar name."""
    for plot in plots:
        if isinstance(plot.quantity, ColumnCurves):
            for key, names in (("x", (plot.quantity.x,)), ("y", plot.quantity.y)):
                for name in names:
                    if name not in known:
                        near = did_you_mean(name, known, otherwise)
                        yield Fault(("plots", plot.name, key), f"there is no column {quoted(name)}{near}")


def possible_columns(spec: Specification) -> tuple[str, ...] | None:
    """All columns that a trajectory may have, in their order; None where they are not known before the derivation."""
    if isinstance(spec, PlanarBeam):
        return ("t", *_of_states(_of_beam(spec.body_name, spec, {1})))
    if not isinstance(spec, Scene) or any(not isinstance(body, RigidBody | BeamBody) for body in spec.bodies):
        return None
    coordinates: list[str] = []
    multipliers: list[str] = []
    for body in spec.bodies:
        if isinstance(body, BeamBody):
            counts = {body.pieces, *(n for plot in spec.plots if plot.cut == body.name for n in plot.pieces)}
            coordinates += _of_beam(body.name, body.beam, counts)
            cuts = range(1, max(counts))
            multipliers += (
                joined(body.name, "cut", str(k), weld.label) for k in cuts for weld in JOINTS["weld"].removes
            )
        else:
            coordinates += coordinate_names(body.name, 0)
    for joint in spec.joints:
        multipliers += (joined(joint.name, multiplier.label) for multiplier in JOINTS[joint.kind].removes)
    drives = [drive.name for drive in spec.drives]
    inputs = (f"u_{rate_name(each.name, rate)}" for each in spec.inputs for rate in RATES)
    outputs = (joined(output.name, label) for output in spec.outputs for label in OUTPUTS[output.kind].labels)
    reactions = (f"lambda_{name}" for name in (*multipliers, *drives))
    return ("t", *drives, *_of_states(coordinates), *reactions, *inputs, *outputs)


def _of_beam(name: str, beam: PlanarBeam, counts: Collection[int]) -> list[str]:
    """The coordinates of a beam in each of some numbers of pieces; none of them is a displacement along a guide."""
    shapes = beam.ansatz.count if isinstance(beam.ansatz, ShapeFamily) else len(beam.ansatz)
    shapes += len(beam.axial.ansatz) if beam.axial else 0
    whole = [name] if 1 in counts else []
    pieces = [f"{name}_{k}" for k in range(1, max(counts) + 1)] if max(counts) > 1 else []
    names = ((piece, name) for piece in (*whole, *pieces) for name in coordinate_names(piece, shapes))
    return [name for piece, name in names if name != f"{piece}_s"]


def _of_states(coordinates: Collection[str]) -> Iterator[str]:
    """The names of coordinates, and of their rates."""
    for rate in RATES[:2]:
        yield from (f"{name}{rate}" for name in coordinates)
