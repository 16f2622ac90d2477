"""The comparison of a beam in the mean frame and in the frame of a point, side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from derive.ir.model import Model
from derive.lowering.flat import lower
from derive.mechanics.bodies import beam
from derive.mechanics.bodies.reference_conditions import ConditionError
from derive.mechanics.equations import Equations
from derive.report.document.formula import Equation
from derive.report.document.page import Block, Columns, Content, EquationBlock, Heading, Paragraph, Picture, table
from derive.report.notation.expressions import Notation
from derive.report.sections.frame import paper_numbers
from derive.report.sections.mass_matrix import MassPattern, mass_matrix, picture
from derive.report.sections.terms import expansion, written_row
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import Frame

MOST_SUMMANDS = 40
"""Summands of the equations in a frame that are shown."""

OTHERS = (Frame("mean"), Frame("point", Fraction(0)))


@dataclass(frozen=True)
class Variant:
    """A beam in one of its frames."""

    spec: PlanarBeam
    equations: Equations
    model: Model

    @property
    def title(self) -> str:
        """The frame in words."""
        return frame_title(self.spec.frame)


def frame_title(frame: Frame) -> str:
    """A frame in words."""
    return f"{frame.kind} frame" + (f" at ξ = {frame.at}" if frame.at is not None else "")


def variants(spec: PlanarBeam, equations: Equations, model: Model) -> tuple[Variant, ...]:
    """The beam as it is specified, and in the mean frame and that of its middle, whichever it is not in.

    A frame that the ansatz does not fit is left out.
    """
    kinds = {spec.frame.kind}
    result = [Variant(spec, equations, model)]
    for frame in OTHERS:
        if frame.kind not in kinds:
            changed = replace(spec, frame=frame, orthogonal=frame.kind == "mean")
            try:
                other = beam.derive(changed).expanded()
            except ConditionError:
                continue
            result.append(Variant(changed, other, lower.lower(other)))
    return tuple(result)


def frames_blocks(result: Sequence[Variant], notation: Notation) -> tuple[Block, ...]:
    """Patterns, equations and counts side by side."""
    if len(result) < 2:
        return ()
    matrices = [mass_matrix(v.model, v.equations) for v in result]
    against = " against ".join(f"{m.count} in the {v.title}" for v, m in zip(result, matrices, strict=True))
    columns = tuple((_picture(v, m), *_equations(v, notation)) for v, m in zip(result, matrices, strict=True))
    return (
        Heading("In another frame", "frames"),
        Paragraph((f"This is the same beam with the same ansatz. Non-zeros of the mass matrix: {against}.",)),
        Columns(columns),
        _counts(result),
    )


def _picture(variant: Variant, matrix: MassPattern) -> Picture:
    text = f"{variant.title}: {matrix.count}"
    return Picture(picture(matrix, reasons=False), f"Mass matrix in the {text} entries", text)


def _counts(result: Sequence[Variant]) -> Block:
    rows: list[list[Content]] = [
        ["terms of (15) that remain", *(len(v.equations.terms) for v in result)],
        ["terms of (15) that vanish", *(len(v.equations.vanished) for v in result)],
        ["entries of the mass matrix", *(v.model.pattern("mass", "M").full_nnz for v in result)],
        ["entries of the iteration matrix", *(len(v.model.pattern("jacobian", "jac").rowidx) for v in result)],
    ]
    for name, text in OPERATIONS.items():
        rows.append([f"operations: {text}", *(v.model.kernel(name).operations for v in result)])
    head = ("", *(v.title for v in result))
    return table("The beam in its frames", head, rows, "l" + "r" * len(result))


OPERATIONS = {
    "setup": "setup, once for each set of parameters",
    "mass": "mass matrix",
    "force": "forces",
    "mass_force": "mass matrix and forces",
    "accel": "accelerations",
    "jacobian": "iteration matrix",
}


def _equations(variant: Variant, notation: Notation) -> tuple[Block, ...]:
    """The rows of a frame, written out, where they are short enough."""
    written = expansion(variant.equations)
    rows = [(row.name, written_row(variant.equations, row.name, written, notation)) for row in variant.equations.rows]
    total = sum(len(parts) for _, parts in rows)
    if total > MOST_SUMMANDS:
        return (Paragraph((f"Expanded in the coordinates, its equations of motion have {total} summands.",)),)
    numbers = paper_numbers(variant.spec)
    number = numbers.motion if numbers else ""
    last = len(rows) - 1
    lines = (
        Equation(notation.variation(name), parts, ":", number if k == last else "")
        for k, (name, parts) in enumerate(rows)
    )
    return (EquationBlock(tuple(lines)),)
