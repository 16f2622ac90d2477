"""The page of a scene: bodies, joints, what was left out, its equations, the KKT matrix, results that are there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from derive.backends.source_map import source_map
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.multibody.bodies.beam import piece_name
from derive.mechanics.multibody.mechanism_text import BETWEEN_BODIES
from derive.mechanics.symbols import identity
from derive.mechanics.terms import Reason
from derive.pipeline import Built
from derive.report.document.page import Block, Heading, Page, Paragraph, Picture
from derive.report.notation.expressions import notation
from derive.report.notation.labels import label, row_identities
from derive.report.sections.code import code_blocks, targets
from derive.report.sections.files import SpecificationText, manifest_blocks, specification_blocks
from derive.report.sections.initial_state import initial_state_blocks
from derive.report.sections.integrals import integral_blocks
from derive.report.sections.mass_matrix import MassPattern, mass_blocks
from derive.report.sections.mechanism import body_blocks, constraint_blocks, joint_blocks, kkt_blocks, mechanism_blocks
from derive.report.sections.moments import moment_anchors, moment_blocks, moments
from derive.report.sections.nomenclature import nomenclature_blocks
from derive.report.sections.second_order import scene_second_order_blocks
from derive.report.sections.state import state_blocks
from derive.report.sections.term_lines import definition_lines, locate_terms
from derive.report.sections.terms import row_blocks
from derive.report.sections.zeros import vanished_blocks
from derive.simulation.initial.initial_state import InitialState
from derive.spec.model.scene import BeamBody, Scene


@dataclass(frozen=True)
class ResultPicture:
    """A picture of a simulation or a study of this scene: its name and its SVG."""

    name: str
    svg: str


def scene_page(
    built: Built,
    specification: SpecificationText,
    results: Sequence[ResultPicture] = (),
    initial: InitialState | str | None = None,
    warnings: Sequence[str] = (),
) -> Page:
    """The report of a scene, with its initial state, or why there is none, if that is known.

    warnings: those of a run whose pictures are among the results, where a beam leaves the range of its model.
    Raises TypeError when what was built is a body.
    """
    spec, equations, model = built.spec, built.equations, built.model
    if not isinstance(spec, Scene) or isinstance(equations, IndexedEquations) or model.kkt is None:
        raise TypeError("this is no scene")
    written = notation(equations)
    code = source_map(built.files, "c")
    terms = locate_terms(equations, code)
    shown = _of_first_pieces(spec, equations)
    families = moments(shown, written)
    visible = [p for p in terms if p.term.row in {row.name for row in shown.rows}]
    blocks = (
        *mechanism_blocks(spec),
        *_results(results, warnings),
        *body_blocks(spec, model, equations),
        *joint_blocks(spec, equations),
        *specification_blocks(specification),
        *state_blocks(model, equations, written),
        *(initial_state_blocks(initial) if initial is not None else ()),
        *scene_second_order_blocks(spec),
        *nomenclature_blocks(True, {body.beam.order for body in spec.bodies if isinstance(body, BeamBody)}),
        *integral_blocks(equations, written),
        *moment_blocks(families, written, definition_lines(code)),
        *_law(spec),
        *row_blocks(shown, visible, written),
        *constraint_blocks(equations, written),
        *mass_blocks(equations, _matrix(spec, equations), written),
        *vanished_blocks(shown, written),
        *kkt_blocks(model, model.kkt),
        *code_blocks(code, targets(visible, moment_anchors(shown, families))),
        *manifest_blocks(built.files),
    )
    return Page(model.name, (model.doc,), blocks)


def _other_pieces(spec: Scene) -> tuple[str, ...]:
    """The names of the pieces of rods after the first, which have the same equations."""
    rods = (body for body in spec.bodies if isinstance(body, BeamBody))
    return tuple(piece_name(rod, k) for rod in rods for k in range(1, rod.pieces))


def _of_first_pieces(spec: Scene, equations: Equations) -> Equations:
    """The equations without those of pieces that are like the first of their rod."""
    others = _other_pieces(spec)
    kept = tuple(row for row in equations.rows if identity(row.v).owner not in others)
    names = {row.name for row in kept}
    return replace(
        equations,
        rows=kept,
        terms=tuple(term for term in equations.terms if term.row in names),
        definitions=tuple(d for d in equations.definitions if identity(d.symbol).owner not in others),
    )


def _law(spec: Scene) -> tuple[Block, ...]:
    cut = [f"{b.name}_1" for b in spec.bodies if isinstance(b, BeamBody) and b.pieces > 1]
    alike = f" Of rods that are cut, the first piece is shown ({', '.join(cut)}); the others are alike." if cut else ""
    text = (
        "Each body has its rows of (15), in the coordinates that it keeps; what stands there is not zero, but what the "
        f"joints exert: M(q) v̇ + h(t, q, v) = Gᵀ λ, with g(t, q) = 0.{alike}"
    )
    return (Heading("Equations of motion", "motion"), Paragraph((text,)))


def _matrix(spec: Scene, equations: Equations) -> MassPattern:
    """The pattern of M, with the reasons of all of its zeros: within bodies those of the first piece, between bodies
    that they share no inertia."""
    rows = list(row_identities(equations).values())
    n = len(rows)
    mass = equations.mass
    entries = frozenset((i, j) for i in range(n) for j in range(n) if mass[i, j] != 0)
    known = {(rows[i], rows[j]): why for i, j, why in equations.mass_zeros}
    firsts = dict(_firsts(spec))
    alike = [replace(row, owner=firsts.get(row.owner, row.owner)) for row in rows]
    between = Reason(identity=BETWEEN_BODIES)
    reasons: dict[tuple[int, int], Reason] = {}
    for i in range(n):
        for j in range(i + 1):
            if (i, j) not in entries:
                same = rows[i].owner == rows[j].owner
                why = known.get((alike[i], alike[j]), between) if same else between
                reasons[i, j] = reasons[j, i] = why
    return MassPattern(tuple(map(label, rows)), entries, reasons)


def _firsts(spec: Scene) -> Iterator[tuple[str, str]]:
    for rod in spec.bodies:
        if isinstance(rod, BeamBody):
            for k in range(1, rod.pieces):
                yield piece_name(rod, k), piece_name(rod, 0)


def _results(results: Sequence[ResultPicture], warnings: Sequence[str]) -> tuple[Block, ...]:
    if not results and not warnings:
        return ()
    doubts = (Paragraph((f"The run warns: {warning}.",)) for warning in warnings)
    pictures = (Picture(result.svg, f"Result {result.name}", result.name) for result in results)
    return (Heading("Results", "results"), *doubts, *pictures)
