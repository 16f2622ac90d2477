"""The page of a scene: bodies, joints, what was left out, its equations, the KKT matrix, results that are there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from derive.backends.source_map import source_map
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.multibody.mechanism_text import BETWEEN_BODIES
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.mechanics.terms import Reason
from derive.pipeline import Built
from derive.report.document.page import Block, Content, Heading, Page, Paragraph, Picture, table
from derive.report.notation.expressions import Notation, notation
from derive.report.notation.labels import label, row_identities
from derive.report.sections.alike_bodies import shown_once
from derive.report.sections.alike_joints import constraints_once
from derive.report.sections.beam_shapes import beam_shapes_of_scene
from derive.report.sections.code import code_blocks, targets
from derive.report.sections.files import SpecificationText, manifest_blocks, specification_blocks
from derive.report.sections.initial_state import initial_state_blocks
from derive.report.sections.instance_rows import enumeration_of_instances
from derive.report.sections.instance_values import value_blocks
from derive.report.sections.integrals import integral_blocks
from derive.report.sections.mass_matrix import SMALL as NAMED
from derive.report.sections.mass_matrix import MassPattern, mass_blocks
from derive.report.sections.mechanism import body_blocks, constraint_blocks, joint_blocks, kkt_blocks, mechanism_blocks
from derive.report.sections.modes import modes_of_scene
from derive.report.sections.moments import moment_anchors, moment_blocks, moments
from derive.report.sections.nomenclature import nomenclature_blocks
from derive.report.sections.second_order import scene_second_order_blocks
from derive.report.sections.state import state_blocks
from derive.report.sections.term_lines import definition_lines, locate_terms
from derive.report.sections.terms import row_blocks
from derive.report.sections.zeros import vanished_blocks
from derive.simulation.initial.initial_state import InitialState
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene


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
    drawing: str = "",
) -> Page:
    """The report of a scene, with its initial state, or why there is none, if that is known.

    warnings: those of a run whose pictures are among the results, where a beam leaves the range of its model. drawing:
    the SVG of a mechanism in space in its initial configuration.
    Raises TypeError when what was built is a body.
    """
    mechanism, equations, model = built.derived, built.equations, built.model
    if not isinstance(mechanism, (Mechanism, SpatialMechanism)):
        raise TypeError("this is no scene")
    spec, once = mechanism.scene, shown_once(mechanism)
    shown, joints = once.equations, constraints_once(equations.constraints, (i.name for i in mechanism.instances))
    written = notation(equations)
    code = source_map(built.files, "c")
    terms = locate_terms(equations, code)
    families = moments(shown, written)
    visible = [p for p in terms if p.term.row in {row.name for row in shown.rows}]
    blocks = (
        *mechanism_blocks(spec, drawing),
        *_results(results, warnings),
        *body_blocks(spec, model, equations),
        *beam_shapes_of_scene(spec),
        *modes_of_scene(spec),
        *joint_blocks(spec, equations),
        *specification_blocks(specification),
        *state_blocks(model, equations, written),
        *(initial_state_blocks(initial) if initial is not None else ()),
        *scene_second_order_blocks(spec),
        *nomenclature_blocks(True, _orders(spec), isinstance(spec, SpatialScene)),
        *integral_blocks(shown, written),
        *value_blocks(once, written),
        *moment_blocks(families, written, definition_lines(code)),
        *_law(once.alike),
        *row_blocks(shown, visible, written),
        *constraint_blocks(joints, written, isinstance(spec, SpatialScene)),
        *_mass(mechanism, equations, shown, written),
        *vanished_blocks(shown, written),
        *(kkt_blocks(model, model.kkt) if model.kkt is not None else ()),
        *code_blocks(code, targets(visible, moment_anchors(shown, families))),
        *manifest_blocks(built.files),
    )
    return Page(model.name, (model.doc,), blocks)


def _orders(spec: AnyScene) -> set[DisplacementOrder]:
    """The orders of the displacements of flexible bodies."""
    beams = {body.beam.order for body in spec.bodies if isinstance(body, BeamBody)}
    beams |= {body.order for body in spec.bodies if isinstance(body, SpatialBeam)}
    return beams | {body.body.order for body in spec.bodies if isinstance(body, FlexibleBody)}


def _law(alike: Mapping[str, tuple[str, ...]]) -> tuple[Block, ...]:
    text = (
        "Each body has its rows of (15), in the coordinates that it keeps. The right-hand sides are the constraint "
        "reactions of the joints: M(q) v̇ + h(t, q, v) = Gᵀ λ, with g(t, q) = 0."
    )
    if alike:
        text += (
            " Where the equations of bodies differ only in names and constants, or in the damping between the pieces "
            "of a rod, those of the first body are shown."
        )
    rows: list[list[Content]] = [[name, enumeration_of_instances(others)] for name, others in alike.items()]
    same = (table("Bodies with the same equations", ("shown", "the same for"), rows),) if alike else ()
    return (Heading("Equations of motion", "motion"), Paragraph((text,)), *same)


def _mass(
    mechanism: Mechanism | SpatialMechanism, equations: Equations, shown: Equations, written: Notation
) -> tuple[Block, ...]:
    """The mass matrix, of large scenes with the blocks of the bodies that are shown alone."""
    if len(equations.rows) <= NAMED or len(shown.rows) == len(equations.rows):
        return mass_blocks(equations, _matrix(mechanism, equations), written)
    heading, *blocks = mass_blocks(shown, _matrix(mechanism, shown), written)
    text = (
        f"M has {len(equations.rows)} rows. It is block-diagonal, with one block for each body. Where the equations "
        "of several bodies are shown once, their block is shown once as well:"
    )
    return (heading, Paragraph((text,)), *blocks)


def _matrix(mechanism: Mechanism | SpatialMechanism, equations: Equations) -> MassPattern:
    """The pattern of M, with the reasons of all of its zeros: within bodies those of the first piece, between bodies
    that they share no inertia."""
    rows = list(row_identities(equations).values())
    n = len(rows)
    mass = equations.mass
    entries = frozenset((i, j) for i in range(n) for j in range(n) if mass[i, j] != 0)
    known = {(rows[i], rows[j]): why for i, j, why in equations.mass_zeros}
    groups: dict[str, str] = {}
    first = {i.name: groups.setdefault(i.component.group, i.name) for i in mechanism.instances}
    alike = [replace(row, owner=first[row.owner]) for row in rows]
    between = Reason(identity=BETWEEN_BODIES)
    reasons: dict[tuple[int, int], Reason] = {}
    for i in range(n):
        for j in range(i + 1):
            if (i, j) not in entries:
                same = rows[i].owner == rows[j].owner
                why = known.get((alike[i], alike[j]), between) if same else between
                reasons[i, j] = reasons[j, i] = why
    return MassPattern(tuple(map(label, rows)), entries, reasons)


def _results(results: Sequence[ResultPicture], warnings: Sequence[str]) -> tuple[Block, ...]:
    if not results and not warnings:
        return ()
    doubts = (Paragraph((f"Warning of the run: {warning}.",)) for warning in warnings)
    pictures = (Picture(result.svg, f"Result {result.name}", result.name) for result in results)
    return (Heading("Results", "results"), *doubts, *pictures)
