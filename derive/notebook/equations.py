"""The HTML of equations of motion, of mechanisms with their constraints, and of models with their mass matrix."""

from __future__ import annotations

from collections.abc import Iterator

from derive.ir.model import Model
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.gathering import InstancesOfKinds
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.notebook.parts import Writers, folded, head, joined, paragraph, picture, table
from derive.report.document.formula import Equation, Name
from derive.report.notation.expressions import notation
from derive.report.sections.alike_bodies import shown_once
from derive.report.sections.alike_joints import constraints_once
from derive.report.sections.mass_matrix import MassPattern
from derive.report.sections.mass_matrix import picture as mass_picture
from derive.report.sections.term_lines import group, rank_in_row, title
from derive.report.sections.terms import row_names
from derive.report.writers.equation_html import equations_shown

MOST_ROWS = 16
"""Rows of equations, and constraints, that a notebook shows."""
MOST_VELOCITIES = 60
"""Mechanisms with more velocities show the equations of their kinds of bodies, which are derived already."""


def equations_html(equations: Equations) -> str:
    """The equations of motion row by row, grouped by accelerations, rates and the rest."""
    return joined(head(equations.name, equations.doc), _rows(equations))


def _rows(equations: Equations) -> str:
    written = notation(equations)
    rows = []
    for name in list(row_names(equations))[:MOST_ROWS]:
        terms = sorted((t for t in equations.terms if t.row == name), key=rank_in_row)
        parts = tuple(part for t in terms for part in written.parts(t.expr, "", group(t), title(t)))
        rows.append(Equation(written.variation(name), parts, ":"))
    more = len(row_names(equations)) - len(rows)
    text = paragraph(f"and {more} more rows") if more > 0 else ""
    return f"{equations_shown(rows)}{text}"


def mechanism_html(mechanism: Mechanism | SpatialMechanism) -> str:
    """A mechanism: its bodies, their equations of motion, of alike bodies once, and its constraints."""
    parts = _kinds if len(mechanism.rows) > MOST_VELOCITIES else _small
    out = table(("eliminated", "reason"), [(e.what, e.reason) for e in mechanism.eliminated], left=2)
    size = f"mechanism of {len(mechanism.instances)} bodies of {len(mechanism.kinds)} kinds"
    return joined(head(mechanism.scene.name, size), *parts(mechanism), folded("What the equations leave out", out))


def _small(mechanism: Mechanism | SpatialMechanism) -> Iterator[str]:
    """The expanded equations, of alike bodies and joints the first."""
    equations, once = mechanism.expanded(), shown_once(mechanism)
    written = notation(equations)
    exerted = " The sum of each row is the force that joints exert, G\u1d40 \u03bb." if equations.constraints else ""
    yield paragraph(f"A {equations.doc}.{exerted}")
    yield _rows(once.equations)
    yield _alike("Bodies with the same equations", once.alike)
    joints = constraints_once(equations.constraints, (instance.name for instance in mechanism.instances))
    shown = [
        Equation(Name("g", below=(c.shown.replace("_", " "),)), written.parts(c.position, title=c.doc))
        for c in joints.constraints[:MOST_ROWS]
    ]
    if shown:
        yield paragraph("Constraints, each of which is zero:")
        yield equations_shown(shown)
        more = len(joints.constraints) - len(shown)
        yield paragraph(f"and {more} more constraints") if more > 0 else ""
        yield _alike("Joints with the same constraints", joints.alike)


def _alike(title: str, alike: object) -> str:
    rows = [(name, ", ".join(others)) for name, others in dict(alike).items() if others]  # type: ignore[call-overload]
    return folded(title, table(("shown", "alike"), rows, left=2))


def _kinds(mechanism: Mechanism | SpatialMechanism) -> Iterator[str]:
    """The equations of each kind of body, as if it were free."""
    for number, kind in enumerate(mechanism.kinds):
        names = [instance.name for instance in mechanism.instances if instance.kind == number]
        others = f" and {len(names) - 1} more" if len(names) > 1 else ""
        yield paragraph(f"Bodies of kind {number + 1}, {names[0]}{others}, before joints take coordinates from them:")
        yield _rows(kind.equations)


def model_html(model: Model) -> str:
    """A model: its kind, its operations, and the pattern of its mass matrix."""
    pattern = model.pattern("mass", "M")
    names = tuple(name for row in model.equations for name in row.elements)
    entries = frozenset(pattern.entries) | {(j, i) for i, j in pattern.entries}
    mass = MassPattern(names, entries, {})
    drawn = picture(mass_picture(mass, reasons=False), f"Mass matrix: {mass.count} entries")
    functions = [(kernel.name, kernel.doc, kernel.operations) for kernel in model.kernels]
    parameters = [(p.title, p.doc, p.unit, f"{p.default:g}") for p in model.parameters]
    return joined(
        head(model.name, model.doc),
        paragraph(f"The mass matrix has {mass.count} entries that are not always zero:"),
        drawn,
        folded("Parameters", table(("parameter", "meaning", "unit", "default"), parameters, left=3)),
        folded("Functions", table(("function", "meaning", "operations"), functions, left=2, most=len(functions))),
    )


WRITERS: Writers = {
    Equations: equations_html,
    InstancesOfKinds: mechanism_html,
    Model: model_html,
}
