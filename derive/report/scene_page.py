"""The page of a scene: bodies, joints, what was left out, its equations, the KKT matrix, results that are there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from derive.artifacts import File
from derive.ir.model import Kkt, Model
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.assembly import BETWEEN_BODIES
from derive.mechanics.multibody.components import piece_name
from derive.pipeline import Built
from derive.report.document.formula import Equation, Name
from derive.report.document.page import Block, Code, Details, Heading, Page, Paragraph, Picture
from derive.report.document.page import Equations as Lines
from derive.report.document.tables import Said, table
from derive.report.notation.expressions import Notation, notation
from derive.report.sections.code import code_blocks, targets
from derive.report.sections.integrals import integral_blocks
from derive.report.sections.mass_matrix import Matrix, mass_blocks
from derive.report.sections.moments import moment_anchors, moment_blocks, moments
from derive.report.sections.provenance import Text, manifest_blocks, specification_blocks
from derive.report.sections.source import sources
from derive.report.sections.state import state_blocks
from derive.report.sections.term_lines import definition_lines, places
from derive.report.sections.terms import row_blocks
from derive.report.sections.zeros import vanished_blocks
from derive.spec.model.body import Parameter, Quantity
from derive.spec.model.scene import BeamBody, MarkerRef, Scene, SceneBody
from derive.visual.kkt_matrix import kkt_picture

COUNTED = (
    "mass_force",
    "constraints",
    "constraint_jacobian",
    "accel",
    "solve",
    "project_velocity",
    "residual",
    "jacobian",
)
"""Functions whose operations are told."""

MANY = 24
"""Constraints that are shown; others are folded."""


@dataclass(frozen=True)
class Result:
    """A picture of a simulation or a study of this scene: its name and its SVG."""

    name: str
    svg: str


def scene_page(built: Built, specification: Text, results: Sequence[Result] = ()) -> Page:
    """The report of a scene. Raises TypeError when what was built is a body."""
    spec, equations, model = built.spec, built.equations, built.model
    if not isinstance(spec, Scene) or not isinstance(equations, Equations) or model.kkt is None:
        raise TypeError("this is no scene")
    written = notation(equations)
    code = sources(f"{model.name}.c", _text(built.files, ".c"), model.name)
    terms = places(equations, model, code)
    shown = _of_first_pieces(spec, equations)
    families = moments(shown, written)
    visible = [p for p in terms if p.term.row in {row.name for row in shown.rows}]
    blocks = (
        *specification_blocks(specification),
        *_bodies(spec, model),
        *_joints(spec, model),
        *state_blocks(model, written),
        *integral_blocks(equations, written),
        *moment_blocks(families, written, definition_lines(code)),
        *_law(spec),
        *row_blocks(shown, visible, written),
        *_constraints(equations, written),
        *mass_blocks(equations, _matrix(spec, equations), written),
        *vanished_blocks(shown, written),
        *_kkt(model, model.kkt),
        *_results(results),
        *code_blocks(code, targets(visible, moment_anchors(shown, families))),
        *manifest_blocks(built.files),
    )
    return Page(model.name, model.doc, blocks)


def _text(files: Sequence[File], ending: str) -> str:
    return next(file.text for file in files if file.path.endswith(ending))


def _other_pieces(spec: Scene) -> tuple[str, ...]:
    """The pieces of rods behind the first, which are like it."""
    rods = (body for body in spec.bodies if isinstance(body, BeamBody))
    return tuple(piece_name(rod, k) for rod in rods for k in range(1, rod.pieces))


def _of_first_pieces(spec: Scene, equations: Equations) -> Equations:
    """The equations without those of pieces that are like the first of their rod."""
    others = tuple(f"{name}_" for name in _other_pieces(spec))
    return replace(
        equations,
        rows=tuple(row for row in equations.rows if not row.name.startswith(others)),
        terms=tuple(term for term in equations.terms if not term.row.startswith(others)),
        definitions=tuple(d for d in equations.definitions if not d.symbol.name.startswith(others)),
    )


def _bodies(spec: Scene, model: Model) -> tuple[Block, ...]:
    reasons = {out.what: out.reason for out in model.left_out}
    rows: list[list[Said]] = [["ground", "the inertial base", "", "0", reasons.get("ground", "")]]
    for body in spec.bodies:
        kept = [q.name for q in model.coordinates if q.name.startswith(f"{body.name}_")]
        rows.append([body.name, _kind(body), _weight(body), str(len(kept)), reasons.get(body.name, "")])
    others: list[list[Said]] = [[out.what, out.reason] for out in model.left_out if out.what not in _names(spec)]
    found: list[Block] = [
        Heading("Bodies", "bodies"),
        Paragraph((f"A {model.doc}. Nothing is modelled that the scene does not need.",)),
        table("Bodies", ("body", "is", "", "coordinates", "what was left out"), rows, "lllrl"),
    ]
    return (*found, table("Left out besides", ("what", "because"), others)) if others else tuple(found)


def _names(spec: Scene) -> set[str]:
    return {"ground", *(body.name for body in spec.bodies)}


def _kind(body: SceneBody) -> str:
    if not isinstance(body, BeamBody):
        return "rigid"
    cut = f" in {body.pieces} pieces" if body.pieces > 1 else ""
    return f"flexible{cut}, {body.beam.frame.kind} frame"


def _weight(body: SceneBody) -> str:
    if isinstance(body, BeamBody):
        beam = body.beam
        return f"{_said(beam.mass)} kg, {_said(beam.length)} m, EI {_said(beam.bending_stiffness)} N m²"
    if body.mass is None:
        return ""
    return f"{_said(body.mass)} kg" + (f", {_said(body.inertia)} kg m²" if body.inertia is not None else "")


def _said(quantity: Quantity) -> str:
    return quantity.symbol if isinstance(quantity, Parameter) else f"{float(quantity):g}"


def _joints(spec: Scene, model: Model) -> tuple[Block, ...]:
    rows: list[list[Said]] = []
    for joint in spec.joints:
        drive = next((d.name for d in spec.drives if d.joint == joint.name), "")
        own = [m.name for m in model.multipliers if _belongs(m.name, joint.name) or m.name == drive]
        exerted = ", ".join(own) or "it takes coordinates away"
        rows.append([joint.name, joint.kind, _place(joint.first), _place(joint.second), drive, exerted])
    cuts = [m.name for m in model.multipliers if not any(m.name in str(row[-1]).split(", ") for row in rows)]
    multipliers: list[list[Said]] = [[Code(m.name), m.unit, m.doc] for m in model.multipliers]
    what = table("", ("multiplier", "unit", "constraint"), multipliers)
    return (
        Heading("Joints", "joints"),
        Paragraph(
            (
                "A multiplier is the force, along the inertial axes, or the torque that a joint exerts on its ",
                "second body; on the first it exerts the opposite.",
                f" Where rods are cut there are {len(cuts)} more." if cuts else "",
            )
        ),
        table("Joints", ("joint", "kind", "first", "second", "drive", "multipliers"), rows),
        *([Details(f"The {len(multipliers)} multipliers", (what,))] if multipliers else []),
        *_acting(spec),
    )


def _belongs(multiplier: str, joint: str) -> bool:
    return multiplier in {f"{joint}_{end}" for end in ("1", "2", "turn", "normal")}


def _acting(spec: Scene) -> tuple[Block, ...]:
    rows: list[list[Said]] = [["force", f.name, _place(f.at)] for f in spec.forces]
    for torque in spec.torques:
        against = f", against {_place(torque.against)}" if torque.against else ""
        rows.append(["torque", torque.name, _place(torque.at) + against])
    rows += [[f"{s.kind} spring", s.name, f"{_place(s.first)} to {_place(s.second)}"] for s in spec.springs]
    return (table("What acts", ("what", "name", "where"), rows),) if rows else ()


def _place(place: MarkerRef) -> str:
    return f"{place.body}.{place.marker}"


def _law(spec: Scene) -> tuple[Block, ...]:
    cut = [f"{b.name}_1" for b in spec.bodies if isinstance(b, BeamBody) and b.pieces > 1]
    alike = f" Of rods that are cut, the first piece is shown ({', '.join(cut)}); the others are alike." if cut else ""
    said = (
        "Each body has its rows of (15), in the coordinates that it keeps; what stands there is not zero, but what the "
        f"joints exert: M(q) v̇ + h(t, q, v) = Gᵀ λ, with g(t, q) = 0.{alike}"
    )
    return (Heading("Equations of motion", "motion"), Paragraph((said,)))


def _constraints(equations: Equations, written: Notation) -> tuple[Block, ...]:
    if not equations.constraints:
        return ()
    lines = tuple(
        Equation(Name("g", below=(c.name.replace("_", " "),)), written.parts(c.position, title=c.doc))
        for c in equations.constraints
    )
    said = (
        "Second place minus first, from x = c + Q r; each vanishes. G has the factors of the rates in their time "
        "derivatives, gamma what is left of the second ones."
    )
    shown: list[Block] = [Heading("Constraints", "constraints"), Paragraph((said,)), Lines(lines[:MANY])]
    if len(lines) > MANY:
        shown.append(Details(f"The other {len(lines) - MANY} constraints", (Lines(lines[MANY:]),)))
    return tuple(shown)


def _matrix(spec: Scene, equations: Equations) -> Matrix:
    """The pattern of M, with the reasons of all of its zeros: within bodies those of the first piece, between bodies
    that they share no inertia."""
    names = tuple(row.name for row in equations.rows)
    n = len(names)
    mass = equations.mass
    entries = frozenset((i, j) for i in range(n) for j in range(n) if mass[i, j] != 0)
    known = {(names[i], names[j]): why for i, j, why in equations.mass_zeros}
    firsts = dict(_firsts(spec))

    def of_first(name: str) -> str:
        other = next((piece for piece in firsts if name.startswith(f"{piece}_")), None)
        return f"{firsts[other]}{name[len(other) :]}" if other else name

    reasons: dict[tuple[int, int], str] = {}
    for i in range(n):
        for j in range(i + 1):
            if (i, j) not in entries:
                same = names[i].rsplit("_", 1)[0] == names[j].rsplit("_", 1)[0]
                pair = (of_first(names[i]), of_first(names[j]))
                why = known.get(pair, BETWEEN_BODIES) if same else BETWEEN_BODIES
                reasons[i, j] = reasons[j, i] = why
    return Matrix(names, entries, reasons)


def _firsts(spec: Scene) -> Iterator[tuple[str, str]]:
    for rod in spec.bodies:
        if isinstance(rod, BeamBody):
            for k in range(1, rod.pieces):
                yield piece_name(rod, k), piece_name(rod, 0)


def _kkt(model: Model, kkt: Kkt) -> tuple[Block, ...]:
    names = (*(row.name for row in model.rows), *(m.name for m in model.multipliers))
    said = (
        "Accelerations and multipliers come from [M, -Gᵀ; -G, 0] by a factorisation L D Lᵀ whose order is fixed at "
        "generation: minimum degree, but each multiplier waits for its coordinates, so that no pivot vanishes while "
        "the constraints are independent. Rows and columns stand in that order; what is filled in has the other colour."
    )
    jacobian = model.pattern("constraint_jacobian", "G")
    rows: list[list[Said]] = [
        ["size", str(kkt.pattern.rows)],
        ["non-zeros of M", str(model.pattern("mass", "M").full_nnz)],
        ["non-zeros of G", str(len(jacobian.rowidx))],
        ["non-zeros of the KKT matrix, both triangles", str(kkt.pattern.full_nnz)],
        ["filled in, one triangle", str(kkt.fill)],
    ]
    costs: list[list[Said]] = [[Code(name), str(model.kernel(name).operations)] for name in COUNTED]
    order = ", ".join(names[k] for k in kkt.order)
    return (
        Heading("The KKT matrix", "kkt"),
        Paragraph((said,)),
        Picture(kkt_picture(kkt, names), f"Pattern of the KKT matrix of {kkt.pattern.rows} rows in its order", ""),
        table("Structure", ("what", "count"), rows, "lr"),
        table("Operations", ("function", "operations"), costs, "lr"),
        Details("The order of elimination", (Paragraph((order,)),)),
    )


def _results(results: Sequence[Result]) -> tuple[Block, ...]:
    if not results:
        return ()
    pictures = (Picture(result.svg, f"Result {result.name}", result.name) for result in results)
    return (Heading("Results", "results"), *pictures)
