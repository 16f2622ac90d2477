"""The page of a body: from its specification to its equations of motion, its code, and how to call it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import assert_never

from derive.backends.source_map import source_map
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import IndexedEquations
from derive.pipeline import Built
from derive.report.document.formula import FormulaRow, Name, NumberToken, OperatorToken
from derive.report.document.page import Block, Heading, Math, Page, Paragraph, Text
from derive.report.notation.expressions import Notation, notation
from derive.report.sections.beam_shapes import beam_shape_picture
from derive.report.sections.code import code_blocks, operation_blocks, targets
from derive.report.sections.files import SpecificationText, calling_blocks, manifest_blocks, specification_blocks
from derive.report.sections.frame import (
    beam_subtitle,
    frame_blocks,
    mode_frame_blocks,
    node_frame_blocks,
    paper_numbers,
)
from derive.report.sections.frame_comparison import frames_blocks, variants
from derive.report.sections.integrals import integral_blocks
from derive.report.sections.kinematics import beam_kinematics_blocks, space_kinematics_blocks
from derive.report.sections.mass_matrix import mass_blocks, mass_matrix
from derive.report.sections.modes import mode_blocks
from derive.report.sections.moments import moment_anchors, moment_blocks, moments
from derive.report.sections.nomenclature import nomenclature_blocks
from derive.report.sections.state import state_blocks
from derive.report.sections.stretching import stretching_blocks
from derive.report.sections.term_lines import definition_lines, locate_terms
from derive.report.sections.terms import row_blocks
from derive.report.sections.zeros import vanished_blocks
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.body import BodyFrame, NodalBody, SymbolicBody
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_scene import SpatialScene


def model_page(built: Built, specification: SpecificationText) -> Page:
    """The report of a body. Raises TypeError for a scene, which has a page of its own."""
    equations, model = built.equations, built.model
    written = notation(equations)
    code = source_map(built.files, "c")
    terms = locate_terms(equations, code)
    families = moments(equations, written)
    of_kind = _of_kind(built, written)
    matrix = mass_matrix(model, equations)
    blocks = (
        *specification_blocks(specification),
        *state_blocks(model, equations, written),
        *nomenclature_blocks(False, [equations.body.order] if equations.body else ()),
        *of_kind.kinematics,
        *of_kind.frame,
        *integral_blocks(equations, written),
        *moment_blocks(families, written, definition_lines(code)),
        *_motion(equations),
        *row_blocks(equations, terms, written, of_kind.number),
        *mass_blocks(equations, matrix, written),
        *vanished_blocks(equations, written),
        *of_kind.comparison,
        *operation_blocks(equations, model),
        *code_blocks(code, targets(terms, moment_anchors(equations, families))),
        *calling_blocks(model),
        *manifest_blocks(built.files),
    )
    return Page(model.name, of_kind.subtitle, blocks)


@dataclass(frozen=True)
class _OfKind:
    """The parts of the page that depend on the kind of the body.

    number: that of the equations of motion in the paper. comparison: the equations in other frames.
    """

    subtitle: Text
    kinematics: tuple[Block, ...]
    frame: tuple[Block, ...]
    number: str = ""
    comparison: tuple[Block, ...] = ()


def _of_kind(built: Built, written: Notation) -> _OfKind:
    spec, equations, model = built.spec, built.equations, built.model
    match spec:
        case PlanarBeam():
            numbers = paper_numbers(spec)
            return _OfKind(
                beam_subtitle(spec),
                beam_kinematics_blocks(spec, written),
                (*frame_blocks(spec), *stretching_blocks(spec), beam_shape_picture(spec)),
                numbers.motion if numbers else "",
                frames_blocks(variants(spec, equations, model), written),
            )
        case NodalBody():
            frame = (*node_frame_blocks(spec), *mode_blocks(spec))
            return _OfKind((model.doc,), space_kinematics_blocks(equations, written), frame)
        case SymbolicBody():
            frame = mode_frame_blocks(BodyFrame(spec.frame))
            return _OfKind((model.doc,), space_kinematics_blocks(equations, written), frame)
        case Scene() | SpatialScene():
            raise TypeError("a scene has a page of its own")
        case _ as never:
            assert_never(never)


def _motion(equations: Equations) -> tuple[Block, ...]:
    """The introduction to the rows of the equations of motion."""
    loops = " There is one row for each shape i." if isinstance(equations, IndexedEquations) else ""
    law = FormulaRow(
        (Name("M", style="tensor"), Name("v", 1, style="vector"), OperatorToken("+"), Name("h", style="vector"))
    )
    return (
        Heading("Equations of motion", "motion"),
        Paragraph(
            (
                "The virtual work of the inertia forces and the variation of the strain energy vanish together for "
                "every virtual displacement. The factor of each variation is one equation of motion, ",
                Math(FormulaRow((law, OperatorToken("="), NumberToken("0")))),
                ". Each term links to the line of the generated C that computes it, and each line links to its terms."
                f"{loops}",
            )
        ),
    )
