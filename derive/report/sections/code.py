"""The generated code: the C of mass matrix and forces, each line with the terms that it computes, and what it costs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

from derive.algebra import sp
from derive.backends.source_map import FunctionLines, SourceMap
from derive.ir.kernel import Kernel
from derive.ir.model import Model
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import IndexedEquations
from derive.report.document.page import (
    Block,
    CodeLine,
    CodeSpan,
    Content,
    Details,
    Heading,
    Hyperlink,
    Listing,
    Paragraph,
    table,
)
from derive.report.notation.formula_reader import marked_text
from derive.report.notation.labels import delta
from derive.report.sections.term_lines import LocatedTerm, line_anchor
from derive.report.sections.terms import expansion

LONG = 400
"""Lines of a function that is shown as a whole; of a longer one those that compute a term or a moment."""

MOST_DEFINITIONS = 600
"""Definitions that are written out to be counted."""


@dataclass(frozen=True)
class Targets:
    """The targets of links: terms by the lines that store them, and the anchors of moments by their names in the code.

    `wanted` are the lines that links of other parts of the page lead to.
    """

    terms: Mapping[int, tuple[LocatedTerm, ...]]
    moments: Mapping[str, str]
    wanted: frozenset[int] = frozenset()


def targets(located: Iterable[LocatedTerm], moments: Mapping[str, str]) -> Targets:
    """The targets of the links of lines: terms by line, and anchors of moments."""
    result: dict[int, list[LocatedTerm]] = {}
    wanted: set[int] = set()
    for item in located:
        wanted |= {number for _, number in item.names}
        for number in item.stores:
            result.setdefault(number, []).append(item)
    return Targets({number: tuple(some) for number, some in result.items()}, moments, frozenset(wanted))


def code_blocks(code: SourceMap, lead: Targets) -> tuple[Block, ...]:
    """The functions `mass` and `force`, and `setup` folded."""
    setup = code.functions["setup"]
    return (
        Heading("The generated C", "c"),
        Paragraph(
            marked_text(
                f"These functions are in `{PurePosixPath(code.path).name}`; the line numbers are those of the file. "
                "Each line is followed by the terms of the equations of motion that it computes. The function "
                "`mass_force` computes both the mass matrix and the forces."
            )
        ),
        _listing(code.functions["mass"], lead, "mass: the mass matrix, lower triangle by columns"),
        _listing(code.functions["force"], lead, "force: the forces h"),
        Details(
            f"setup: the constants, which depend only on the parameters ({len(setup.lines)} lines)",
            (_listing(setup, Targets({}, {}), "setup"),),
        ),
    )


def _listing(function: FunctionLines, lead: Targets, caption: str) -> Listing:
    lines = tuple(_line(number, line.text, line.defines or "", lead) for number, line in function.numbered)
    return Listing("c", caption, lines if len(lines) <= LONG else _shortened(lines, lead.wanted))


def _line(number: int, text: str, name: str, lead: Targets) -> CodeLine:
    links = [Hyperlink(f"{p.term.name} {delta(p.variation)}", f"#{p.anchor}") for p in lead.terms.get(number, ())]
    if name in lead.moments:
        links.append(Hyperlink(name, f"#{lead.moments[name]}"))
    return CodeLine(number, text, line_anchor(number), tuple(links))


def _shortened(lines: Sequence[CodeLine], wanted: frozenset[int]) -> tuple[CodeLine, ...]:
    """The first line, those that lead somewhere or that something leads to, comments before them, and the last."""
    kept = {0, len(lines) - 1}
    for k, line in enumerate(lines):
        if line.links or line.number in wanted:
            kept |= {k, k - 1} if "/*" in lines[k - 1].text or "*/" in lines[k - 1].text else {k}
    return tuple(lines[k] for k in sorted(kept))


def operation_blocks(equations: Equations, model: Model) -> tuple[Block, ...]:
    """Operations by step, then by function."""
    text = (
        "The table counts the operations of the mass matrix (lower triangle) and the forces together. Each addition, "
        "product, division, power, sine and cosine counts as one. SymPy counts all steps but the generated code."
    )
    return (
        Heading("Operations", "operations"),
        Paragraph((text,)),
        table("Operations after each step", ("step", "effect", "operations"), _steps(equations, model), "llr"),
        table("Functions", ("function", "result", "operations"), list(map(_function, model.kernels)), "llr"),
    )


def _steps(equations: Equations, model: Model) -> list[list[Content]]:
    rows: list[list[Content]] = []
    if not isinstance(equations, IndexedEquations) and len(equations.definitions) <= MOST_DEFINITIONS:
        rows.append(["expanded", "all terms in coordinates, velocities and parameters", written_out(equations)])
        if any(not c.value.is_Atom for c in equations.coefficients):
            text = "expressions of the parameters alone are computed beforehand"
            rows.append(["integrals named", text, written_out(equations, integrals=False)])
        rows.append(["moments named", "d1, D2, d3, J and the like are computed once", named(equations)])
    both, setup = model.kernel("mass_force").operations, model.kernel("setup").operations
    rows.append(["generated code", "subexpressions that terms share are computed once: the function mass_force", both])
    rows.append(["setup", "once for each set of parameters: the function setup", setup])
    return rows


def written_out(equations: Equations, integrals: bool = True) -> int:
    """The number of operations of the lower triangle of M and of h, unrolled; with or without values of integrals."""
    write = expansion(equations, integrals)
    return int(sum(sp.count_ops(write(expr)) for expr in _wanted(equations)))


def named(equations: Equations) -> int:
    """The number of operations of M and h with every definition computed once."""
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
