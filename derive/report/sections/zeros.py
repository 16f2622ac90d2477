"""The mass matrix with its structural zeros, and all that vanishes, with the reasons."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby

import sympy as sp

from derive.mechanics.equations import Equations, Term
from derive.mechanics.indexed_equations import GenericEquations
from derive.report.document.formula import Equation, Formula, Name, Number, Part
from derive.report.document.formula import Matrix as Array
from derive.report.document.labels import delta, label
from derive.report.document.page import Block, Heading, Inline, Math, Paragraph, Picture
from derive.report.document.page import Equations as Lines
from derive.report.document.tables import Said, folded, table
from derive.report.notation.doc_formulas import reason
from derive.report.notation.expressions import Notation
from derive.report.notation.names import SHAPES
from derive.report.notation.names import table as whole
from derive.report.sections.integrals import family_of
from derive.report.sections.mass_matrix_picture import Matrix, picture

SMALL, FEW, SUMMANDS = 6, 8, 4
"""Rows of a matrix that is written out; names that are listed; summands of a vanished term that is shown."""


def mass_blocks(equations: Equations | GenericEquations, matrix: Matrix, notation: Notation) -> tuple[Block, ...]:
    """The pattern as a picture, the matrix itself where it is small, and its zeros by reason."""
    said = (
        f"{matrix.count} entries are structural non-zeros. The matrix is symmetric; of each pair one entry is stored. "
        "A dot is a zero in every state: its reason is told on hover, and in the table below."
    )
    shown = Picture(picture(matrix), f"Pattern of the mass matrix: {matrix.count} entries", "")
    written = _written(equations.mass, notation) if isinstance(equations, Equations) and matrix.size <= SMALL else ()
    return (Heading("Mass matrix", "mass"), Paragraph((said,)), shown, *written, *_zeros_of(matrix))


def _written(mass: Iterable[object], notation: Notation) -> tuple[Block, ...]:
    entries = list(mass)
    size = round(len(entries) ** 0.5)
    cells: list[Formula | None] = [notation.formula(entry) if entry != 0 else None for entry in entries]
    rows = tuple(tuple(cells[i * size : (i + 1) * size]) for i in range(size))
    return (Lines((Equation(Name("M", style="tensor"), (Part("+", Array(rows)),), number="15"),)),)


def _zeros_of(matrix: Matrix) -> tuple[Block, ...]:
    """The zeros of the lower triangle by reason."""
    gathered: dict[str, list[tuple[int, int]]] = {}
    for (i, j), why in sorted(matrix.reasons.items()):
        if i >= j:
            gathered.setdefault(why, []).append((i, j))
    if not gathered:
        return ()
    rows: list[list[Said]] = [
        [_pairs(matrix, pairs), sum(1 + (i != j) for i, j in pairs), reason(why)] for why, pairs in gathered.items()
    ]
    said = table("Zeros of the mass matrix", ("entries below the diagonal", "zeros", "because"), rows, "lrl")
    return (folded(said, "Zeros of the mass matrix"),)


def _pairs(matrix: Matrix, pairs: Sequence[tuple[int, int]]) -> str:
    said = [f"{label(matrix.names[i])}, {label(matrix.names[j])}" for i, j in pairs]
    shown = said if len(said) <= FEW else [*said[: FEW - 2], "…", said[-1]]
    return "; ".join(shown)


def vanished_blocks(equations: Equations | GenericEquations, notation: Notation) -> tuple[Block, ...]:
    """Integrals that vanish by reason, and terms of (15) that are no part of the model."""
    found: list[Block] = [Heading("What vanishes", "zeros")]
    if isinstance(equations, Equations):
        found += _integrals(equations, notation)
    terms = [(v.term, v.reason) for v in equations.vanished]
    if terms:
        rows: list[list[Said]] = [
            [term.name, delta(term.row), _would_be(term, notation), reason(why)] for term, why in terms
        ]
        count = f"{len(terms)} terms of (15) are no part of this model."
        found.append(Paragraph((count,)))
        said = table("Terms that vanish", ("term", "row", "it would be", "because"), rows)
        found.append(folded(said, "Terms that vanish"))
    if len(found) == 1:
        found.append(Paragraph(("Nothing vanishes in this model.",)))
    return tuple(found)


def _would_be(term: Term, notation: Notation) -> Said:
    """What a vanished term stands for, where that is short."""
    if term.expr == 0:
        return Number("0")
    count = len(sp.Add.make_args(term.expr))
    return notation.formula(term.expr) if count <= SUMMANDS else f"a sum of {count}"


def _integrals(equations: Equations, notation: Notation) -> list[Block]:
    """Shape integrals that vanish, by reason and family."""
    gathered: dict[str, list[str]] = {}
    for c in equations.coefficients:
        if c.zero:
            gathered.setdefault(c.zero, []).append(c.symbol.name)
    if not gathered:
        return []
    rows: list[list[Said]] = [[_names(names, notation), len(names), reason(why)] for why, names in gathered.items()]
    return [table("Shape integrals that vanish", ("integrals", "how many", "because"), rows, "lrl")]


def _names(names: Sequence[str], notation: Notation) -> tuple[Inline, ...]:
    """Integrals, family by family; of many of a family the first and the last."""
    found: list[Inline] = []
    for name, group in groupby(names, key=family_of):
        some = list(group)
        found += ["; "] if found else []
        if len(some) > FEW and name in SHAPES:
            found += [f"{len(some)} of ", Math(whole(name))]
            continue
        for k, one in enumerate(some):
            found += [", "] if k else []
            found.append(Math(notation.formula(sp.Symbol(one))))
    return tuple(found)
