"""The bodies, joints, loads, constraints and KKT matrix of a mechanism, with a drawing of its initial configuration."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from derive.ir.model import Kkt, Model, Variable
from derive.ir.series import VariableSeries, variable_series
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
from derive.report.sections.instance_rows import enumeration_of_instances, merged_rows
from derive.spec.model.beam_parts import AttachedMass
from derive.spec.model.forces import SceneForce
from derive.spec.model.instances import instance_name, joined
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.model.scene import BeamBody, RigidBody, SceneBody
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_bodies import FlexibleBody, NodalLoad, SpatialRigidBody
from derive.spec.model.spatial_forces import SpatialAction, SpatialJointLoad
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

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
"""The digits of exponents."""

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
        rows.append([body.name, _kind(body), _weight(body), str(kept), reasons.get(body.name, "")])
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
    ]
    return (*blocks, table("Also eliminated", ("what", "reason"), others)) if others else tuple(blocks)


def _cells(rows: Sequence[Sequence[str]]) -> list[list[Content]]:
    """The rows of a table, with one for successive instances that are alike."""
    return [[*row] for row in merged_rows(rows)]


def _names(spec: AnyScene) -> set[str]:
    return {"ground", *(body.name for body in spec.bodies)}


def _kind(body: SceneBody | SpatialBody) -> str:
    if isinstance(body, FlexibleBody):
        return f"flexible, {body.body.frame.kind} frame"
    if isinstance(body, SpatialBeam):
        piece = body.piece_of
        of = f"piece {piece.number + 1} of {body.pieces} of {piece.rod.name}, a " if piece else ""
        return f"{of}beam in space, {body.frame.kind} frame"
    if not isinstance(body, BeamBody):
        return body.kind
    cut = f" in {body.pieces} pieces" if body.pieces > 1 else ""
    return f"flexible{cut}, {body.beam.frame.kind} frame"


def _weight(body: SceneBody | SpatialBody) -> str:
    if isinstance(body, SpatialRigidBody) and body.mass is not None and body.inertia is not None:
        inertia = ", ".join(_quantity(entry, "kg\u00a0m²") for entry in body.inertia[:3])
        return f"{_quantity(body.mass, 'kg')}; {inertia} about its axes"
    if isinstance(body, FlexibleBody):
        return f"{len(body.body.data.positions)} nodes"
    if isinstance(body, SpatialBeam):
        both = " and ".join(_quantity(x, "N\u00a0m²") for x in dict.fromkeys(body.bending_stiffnesses))
        inertia = _quantity(body.rotary_inertia, "kg\u00a0m²")
        values = [
            _quantity(body.mass, "kg"),
            f"{inertia} about its axis",
            _quantity(body.length, "m"),
            f"bending stiffness {both}",
        ]
        if body.torsion:
            values.append("torsional stiffness " + _quantity(body.torsion.stiffness, "N\u00a0m²"))
        if body.axial:
            values.append("axial stiffness " + _quantity(body.axial.stiffness, "N"))
        return f"{'the whole beam: ' if body.piece_of else ''}{', '.join(values)}"
    if isinstance(body, BeamBody):
        beam = body.beam
        stiffness = _quantity(beam.bending_stiffness, "N\u00a0m²")
        values = [_quantity(beam.mass, "kg"), _quantity(beam.length, "m"), f"bending stiffness {stiffness}"]
        return ", ".join((*values, *map(_attached, beam.masses)))
    if not isinstance(body, RigidBody) or body.mass is None:
        return ""
    values = [_quantity(body.mass, "kg")]
    if body.inertia is not None:
        values.append(_quantity(body.inertia, "kg\u00a0m²"))
    return ", ".join(values)


def _attached(mass: AttachedMass) -> str:
    """A mass that is attached to a beam, with its inertia if it has one."""
    values = [_quantity(mass.mass, "kg"), *([_quantity(mass.inertia, "kg\u00a0m²")] if mass.inertia else [])]
    return f"{' and '.join(values)} attached at ξ = {float(mass.at):g} ({mass.name})"


def _quantity(quantity: Quantity, unit: str) -> str:
    """A value with its unit, between which no line breaks: 2.194·10⁻⁶ kg m²."""
    if isinstance(quantity, Parameter):
        return f"{quantity.symbol}\u00a0{unit}"
    mantissa, _, exponent = f"{float(quantity):g}".partition("e")
    power = f"·10{str(int(exponent)).translate(SUPERSCRIPTS)}" if exponent else ""
    return f"{mantissa}{power}\u00a0{unit}"


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
    variables = (Variable(c.name, c.doc, c.force_unit, shown=c.shown) for c in equations.constraints)
    multipliers = [row for series in variable_series(variables) for row in _multipliers(series)]
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
        *_loads(spec),
    )


def _multipliers(series: VariableSeries) -> Iterator[list[Content]]:
    """The rows of a table on multipliers, those of instances with their index i."""
    last = series.first + series.count - 1
    instances = f"; i = {series.first} to {last}" if series.table else ""
    for label in series.labels:
        name = joined(instance_name(series.table, "i"), label.name) if series.table else label.title
        yield [CodeSpan(name), label.unit, f"{label.doc}{instances}"]


def _loads(spec: AnyScene) -> tuple[Block, ...]:
    rows = [[f.name, _load(f, "force"), _where(f, "")] for f in spec.forces]
    rows += [[t.name, _load(t, "torque"), _where(t, ", against ")] for t in spec.torques]
    rows += [[s.name, _load(s, "spring"), _where(s, " to ")] for s in spec.springs]
    flexible = (body for body in spec.bodies if isinstance(body, FlexibleBody))
    rows += [[load.name, "nodal forces", _nodes(body, load)] for body in flexible for load in body.loads]
    cells: list[list[Content]] = [[load, name, marker] for name, load, marker in merged_rows(rows)]
    return (folded(table("Loads", ("load", "name", "marker"), cells), "Loads"),) if cells else ()


def _where(load: SceneForce | SpatialAction, between: str) -> str:
    """The markers at which a load acts, or its joint."""
    if isinstance(load, SpatialJointLoad):
        return f"joint {load.joint}"
    return between.join(map(str, load.markers))


def _nodes(body: FlexibleBody, load: NodalLoad) -> str:
    """The nodes on which a load acts, and the sum of its forces without their factor."""
    count = len(load.nodes)
    where = f"node {load.nodes[0]}" if count == 1 else f"{count} nodes"
    total = ", ".join(f"{float(sum((force[k] for force in load.forces), Fraction(0))):g}" for k in range(3))
    return f"{where} of {body.name}, in sum [{total}] N in the {load.frame} frame"


def _load(load: SceneForce | SpatialAction, noun: str) -> str:
    return noun if load.kind == noun else f"{load.kind} {noun}"


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
