"""The iteration matrix dF/dy + cj dF/dydot of trees, a column after the other: derivatives of loops along directions.

Along the direction dy = e_j, dydot = cj e_j, the derivative of F is column j. The loops of the residual run once more
for it, each with the derivatives of what it writes.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from derive.ir.expressions import Element, Number, ScalarRef
from derive.ir.indices import ElementIndex, IndexTerm, constant, variable
from derive.ir.patterns import Pattern, pattern
from derive.ir.statements import ForEach, InstanceItem, Statement, StoreElement, Work
from derive.lowering.instances.loop_code.context import ZERO, Part
from derive.lowering.trees.link_loop import LinkLoop, tangent_of

COLUMN, ROW = "column", "row"
"""The variables of loops over columns and rows."""


def dense(size: int) -> Pattern:
    """The pattern of a full matrix."""
    return pattern(size, size, {(i, j) for i in range(size) for j in range(size)})


def columns(loops: Sequence[tuple[LinkLoop, bool]], parts: Sequence[Part], size: int) -> list[Statement]:
    """The loop over the columns; loops: those of the residual F in their order, parts: its sections."""
    active = {"y", "ydot"}
    tangents = [tangent for loop, backward in loops if (tangent := loop.tangent(backward, active)) is not None]
    works = [statement for *_, body in parts for statement in body if isinstance(statement, Work)]
    column = variable(COLUMN)
    sizes = dict.fromkeys(("y", "ydot", "F"), (size, 0))
    sizes |= {work.array: (work.count, work.spacing) for work in works if work.array in active - sizes.keys()}
    declared: list[Statement] = [
        Work(tangent_of(name), count, spacing=spacing) for name, (count, spacing) in sizes.items()
    ]
    zeros = [
        ForEach(ROW, constant(0), constant(count), (StoreElement(Element(tangent_of(name), variable(ROW)), ZERO),))
        for name, (count, _) in sizes.items()
    ]
    seeds: list[InstanceItem] = [
        StoreElement(Element(tangent_of("y"), column), Number(Fraction(1))),
        StoreElement(Element(tangent_of("ydot"), column), ScalarRef("cj")),
    ]
    entry = ElementIndex(0, (IndexTerm(size, COLUMN), IndexTerm(1, ROW)))
    kept = StoreElement(Element("jac", entry), Element(tangent_of("F"), variable(ROW)))
    copied = ForEach(ROW, constant(0), constant(size), (kept,))
    return [*declared, ForEach(COLUMN, constant(0), constant(size), (*zeros, *seeds, *tangents, copied))]
