"""The bodies, joints, loads, constraints and KKT matrix of a mechanism, with a drawing of its initial configuration."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from derive.ir.model import Kkt, Model
from derive.ir.series import VariableSeries, variable_series
from derive.lowering.model_tables import multiplier_variables
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.bodies.beam import piece_name
from derive.mechanics.symbols import identity
from derive.mechanics.terms import Constraint
from derive.report.document.formula import Equation, Name
from derive.report.document.page import (
    Block,
    CodeSpan,
    Content,
    Details,
    EquationBlock,
    Heading,
    Paragraph,
    Picture,
    folded,
    table,
)
from derive.report.notation.expressions import Notation
from derive.report.sections.alike_joints import ConstraintsShownOnce
from derive.report.sections.body_values import body_kind, body_values, section_mass_blocks
from derive.report.sections.instance_rows import enumeration_of_instances, merged_rows
from derive.report.sections.loads import load_blocks
from derive.spec.model.instances import instance_name, joined
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.visual.kkt_matrix import kkt_picture
from derive.visual.mechanism import mechanism_picture

MANY = 24
"""Constraints that are shown; further ones are folded."""

LEGEND = (
    "Circles are joints, black squares are welds and fixed joints, parallel lines guide a translational joint, "
    "hatching is the ground; orange arrows are drives and loads."
)
LEGEND_OF_BEAMS = (
    " Flexible rods are drawn undeformed, as light bands that are cut where the rod is divided into beams."
)

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
"""Functions whose operations are listed."""

HINT = "The pointer shows the row and the column of an entry."


SPATIAL_LEGEND = (
    "Rigid bodies are homogeneous boxes of the same mass and inertia, with lines from their centres of mass to their "
    "markers; beams are bars, and finite-element bodies have their own surfaces. Points are markers."
)


def mechanism_blocks(spec: AnyScene, drawing: str = "") -> tuple[Block, ...]:
    """The drawing of the mechanism, to scale; `drawing` is that of a scene in space as SVG, if it has been made."""
    names = enumeration_of_instances([body.name for body in spec.bodies])
    if isinstance(spec, SpatialScene):
        title, caption = f"The mechanism at t = 0 with its bodies {names}", f"The mechanism at t = 0. {SPATIAL_LEGEND}"
        return (Heading("Mechanism", "mechanism"), Picture(drawing, title, caption)) if drawing else ()
    flexible = any(isinstance(body, BeamBody) for body in spec.bodies)
    caption = f"The mechanism at t = 0, to scale. {LEGEND}{LEGEND_OF_BEAMS if flexible else ''}"
    return (
        Heading("Mechanism", "mechanism"),
        Picture(mechanism_picture(spec), f"The mechanism at t = 0 with its bodies {names}", caption),
    )


def body_blocks(spec: AnyScene, model: Model, equations: Equations) -> tuple[Block, ...]:
    """The bodies with their coordinates, and what is eliminated."""
    reasons = {out.what: out.reason for out in model.eliminated}
    rows = [["ground", "the inertial frame", "", "0", reasons.get("ground", "")]]
    for body in spec.bodies:
        owners = {body.name, *((piece_name(body, k) for k in range(body.pieces)) if isinstance(body, BeamBody) else ())}
        kept = sum(identity(c.q).owner in owners for c in equations.coordinates)
        rows.append([body.name, body_kind(body), body_values(body), str(kept), reasons.get(body.name, "")])
    others: list[list[Content]] = [[out.what, out.reason] for out in model.eliminated if out.what not in _names(spec)]
    blocks: list[Block] = [
        Heading("Bodies", "bodies"),
        Paragraph(
            (f"A {model.doc}. Joints and drives eliminate coordinates where they determine the motion of a body.",)
        ),
        folded(
            table("Bodies", ("body", "kind", "mass and stiffness", "coordinates", "eliminated"), _cells(rows), "lllrl"),
            "Bodies",
        ),
        *section_mass_blocks(spec),
    ]
    return (*blocks, table("Also eliminated", ("what", "reason"), others)) if others else tuple(blocks)


def _cells(rows: Sequence[Sequence[str]]) -> list[list[Content]]:
    """The rows of a table, with one for successive instances that are alike."""
    return [[*row] for row in merged_rows(rows)]


def _names(spec: AnyScene) -> set[str]:
    return {"ground", *(body.name for body in spec.bodies)}


def joint_blocks(spec: AnyScene, equations: Equations) -> tuple[Block, ...]:
    """The joints with their drives and multipliers, and the loads."""
    own: dict[str, list[Constraint]] = {}
    of_gears = {c.of: c for c in equations.constraints if c.section == "gears"}
    for constraint in equations.constraints:
        if constraint.section != "gears":
            own.setdefault(constraint.of, []).append(constraint)
    rows: list[list[str]] = []
    for joint in spec.joints:
        drive = next((d.name for d in spec.drives if d.joint == joint.name), "")
        names = [c.shown for c in (*own.pop(joint.name, ()), *own.pop(drive, ()))]
        exerted = ", ".join(names) or "none, since it eliminates coordinates"
        rows.append([joint.name, joint.kind, str(joint.first), str(joint.second), drive, exerted])
    if isinstance(spec, SpatialScene):
        rows += [
            [gear.name, "gear", *(f"joint {joint}" for joint in gear.joints), "", of_gears[gear.name].shown]
            for gear in spec.gears
        ]
    cuts = sum(map(len, own.values()))
    variables = variable_series(multiplier_variables(equations.constraints))
    multipliers = [row for series in variables for row in _multipliers(series)]
    components = "in components of the inertial frame"
    if isinstance(spec, SpatialScene):
        components = "in inertial components if the joint removes all displacements, else in components of the frame "
        components += "of marker 1"
    whole = table("", ("multiplier", "unit", "constraint"), multipliers)
    return (
        Heading("Joints", "joints"),
        Paragraph(
            (
                f"A multiplier is the constraint reaction on body 2: a force, {components}, or a torque. The joint "
                "exerts the opposite on body 1.",
                " The multiplier of a gear acts in its second joint, and multiplied by - ratio in its first joint."
                if of_gears
                else "",
                f" The welds between the beams of a rod have {cuts} further multipliers." if cuts else "",
            )
        ),
        folded(
            table("Joints", ("joint", "kind", "marker 1", "marker 2", "drive", "multipliers"), _cells(rows)), "Joints"
        ),
        *([Details(f"The {len(equations.constraints)} multipliers", (whole,))] if multipliers else []),
        *load_blocks(spec),
    )


def _multipliers(series: VariableSeries) -> Iterator[list[Content]]:
    """The rows of a table on multipliers, those of instances with their index i."""
    last = series.first + series.count - 1
    instances = f"; i = {series.first} to {last}" if series.table else ""
    for label in series.labels:
        name = joined(instance_name(series.table, "i"), label.name) if series.table else label.title
        yield [CodeSpan(name), label.unit, f"{label.doc}{instances}"]


def constraint_blocks(once: ConstraintsShownOnce, written: Notation, spatial: bool = False) -> tuple[Block, ...]:
    """The constraints on position level, of joints that are alike those of the first."""
    if not once.constraints:
        return ()
    lines = tuple(
        Equation(Name("g", below=(c.shown.replace("_", " "),)), written.parts(c.position, title=c.doc))
        for c in once.constraints
    )
    what = (
        "a component of the displacement from marker 1 to marker 2, or a product of their axes A"
        if spatial
        else "the position of marker 2 minus that of marker 1"
    )
    text = (
        f"Each constraint g = 0 is {what}, from x = c + Q r. G holds the coefficients of the generalised velocities in "
        "its time derivative."
    )
    if once.alike:
        text += " Where the constraints of joints differ only in names and constants, those of the first are shown."
    blocks: list[Block] = [Heading("Constraints", "constraints"), Paragraph((text,)), EquationBlock(lines[:MANY])]
    rows: list[list[Content]] = [[name, enumeration_of_instances(others)] for name, others in once.alike.items()]
    if len(lines) > MANY:
        blocks.append(Details(f"The other {len(lines) - MANY} constraints", (EquationBlock(lines[MANY:]),)))
    return (*blocks, *((table("Joints with the same constraints", ("shown", "the same for"), rows),) if rows else ()))


def kkt_blocks(model: Model, kkt: Kkt) -> tuple[Block, ...]:
    """The matrix in its elimination order, its structure and the operations of the functions that use it."""
    names = (*(row.name for row in model.equations), *(m.name for m in model.multipliers))
    text = (
        "The code computes accelerations and multipliers by the factorisation L D Lᵀ of [M, -Gᵀ; -G, 0]. The "
        "elimination order is fixed at generation: it is a minimum degree order in which each multiplier is eliminated "
        "after its coordinates. No pivot vanishes while the constraints are independent. The picture shows the lower "
        "triangle in this order."
    )
    if kkt.relative:
        rows = ", ".join(names[m] for m in kkt.relative)
        text += (
            " The code transforms the system first, which the picture does not show: along the joints of "
            f"{rows}, angular accelerations become inertial components relative to the preceding body. Where a joint "
            "leaves one rotation or none, the rows of that rotation are eliminated together with those that the joint "
            "removes."
        )
    jacobian = model.pattern("constraint_jacobian", "G")
    structure: list[list[Content]] = [
        ["size", str(kkt.pattern.rows)],
        ["non-zeros of M", str(model.pattern("mass", "M").full_nnz)],
        ["non-zeros of G", str(len(jacobian.rowidx))],
        ["non-zeros of the KKT matrix, both triangles", str(kkt.pattern.full_nnz)],
        ["fill-in, one triangle", str(kkt.fill)],
    ]
    costs: list[list[Content]] = [[CodeSpan(name), str(model.kernel(name).operations)] for name in COUNTED]
    order = ", ".join(names[k] for k in kkt.order)
    return (
        Heading("The KKT matrix", "kkt"),
        Paragraph((text,)),
        Picture(
            kkt_picture(kkt, names),
            f"Pattern of the KKT matrix of {kkt.pattern.rows} rows in its elimination order",
            "",
            HINT,
        ),
        table("Structure", ("quantity", "count"), structure, "lr"),
        table("Operations", ("function", "operations"), costs, "lr"),
        Details("The elimination order", (Paragraph((order,)),)),
    )
