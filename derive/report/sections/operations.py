"""What the model costs after each step of its lowering, and what its functions cost."""

from __future__ import annotations

import sympy as sp

from derive.ir.model import Kernel, Model
from derive.mechanics.equations import Equations
from derive.report.document.page import Block, CodeSpan, Heading, Paragraph
from derive.report.document.tables import Content, table
from derive.report.sections.terms import expansion

MOST = 600
"""Definitions that are written out to be counted."""


def operation_blocks(equations: Equations, model: Model) -> tuple[Block, ...]:
    """Operations by step, then by function."""
    text = (
        "Operations of the mass matrix (lower triangle) and the forces together. Additions, products, divisions, "
        "powers, sines and cosines count as one each; before the generated code the counts are SymPy's."
    )
    return (
        Heading("Operations", "operations"),
        Paragraph((text,)),
        table("Operations after each step", ("step", "what it does", "operations"), _steps(equations, model), "llr"),
        table("Functions", ("function", "what it gives", "operations"), list(map(_function, model.kernels)), "llr"),
    )


def _steps(equations: Equations, model: Model) -> list[list[Content]]:
    rows: list[list[Content]] = []
    if not equations.indexed and len(equations.definitions) <= MOST:
        rows.append(["written out", "in coordinates, rates and parameters, term by term", written_out(equations)])
        if any(not c.value.is_Atom for c in equations.coefficients):
            text = "what depends on parameters alone is computed before"
            rows.append(["integrals named", text, written_out(equations, integrals=False)])
        rows.append(["moments named", "d1, D2, d3, J and the like are computed once", named(equations)])
    both, setup = model.kernel("mass_force").operations, model.kernel("setup").operations
    rows.append(["generated code", "what the terms share is computed once: the function mass_force", both])
    rows.append(["besides, once", "for a set of parameters: the function setup", setup])
    return rows


def written_out(equations: Equations, integrals: bool = True) -> int:
    """Operations of the lower triangle of M and of h, written out; with or without the values of the integrals."""
    write = expansion(equations, integrals)
    return int(sum(sp.count_ops(write(expr)) for expr in _wanted(equations)))


def named(equations: Equations) -> int:
    """The same with every definition computed once."""
    wanted = _wanted(equations)
    used = set().union(*(expr.free_symbols for expr in wanted))
    count = sum(sp.count_ops(expr) for expr in wanted)
    for definition in reversed(equations.definitions):  # a definition refers to earlier ones only
        if definition.symbol in used:
            used |= definition.expr.free_symbols
            count += sp.count_ops(definition.expr)
    return int(count)


def _wanted(equations: Equations) -> list[sp.Expr]:
    """The entries of the lower triangle of M, and h."""
    mass, size = equations.mass, len(equations.rows)
    return [*(mass[i, j] for i in range(size) for j in range(i + 1)), *equations.force]


def _function(kernel: Kernel) -> list[Content]:
    return [CodeSpan(kernel.name), kernel.doc, kernel.operations]
