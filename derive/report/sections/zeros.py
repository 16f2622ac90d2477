"""Structural zeros: integrals and terms that vanish, with the reasons."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from derive.algebra import sp
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.symbols import Family, identity
from derive.mechanics.terms import Reason, Term
from derive.report.document.formula import NumberToken
from derive.report.document.page import (
    Block,
    Content,
    Details,
    Heading,
    Inline,
    Math,
    Paragraph,
    TableBlock,
    folded,
    table,
)
from derive.report.notation.expressions import Notation
from derive.report.notation.integral_formulas import INTEGRANDS, reason
from derive.report.notation.typeset_names import whole

FEW, SUMMANDS = 8, 4
"""Names that are listed; summands of a vanished term that is shown."""


def vanished_blocks(equations: Equations, notation: Notation) -> tuple[Block, ...]:
    """Integrals that vanish by reason, and terms of (15) that are no part of the model."""
    result: list[Block] = [Heading("What vanishes", "zeros")]
    if not isinstance(equations, IndexedEquations):
        result += _integrals(equations, notation)
    terms = [(v.term, v.reason) for v in equations.vanished]
    if terms:
        rows: list[list[Content]] = [
            [term.name, notation.delta(term.row), _would_be(term, notation), reason(why, notation)]
            for term, why in terms
        ]
        result.append(Paragraph((f"{len(terms)} terms of (15) vanish in this model.",)))
        result.append(_by_reason(terms, notation))
        whole = table("Terms that vanish", ("term", "equation", "expression that vanishes", "reason"), rows)
        single = folded(whole, "Terms that vanish")
        result.append(
            Details(f"The {len(terms)} terms one by one", (whole,)) if isinstance(single, TableBlock) else single
        )
    if len(result) == 1:
        result.append(Paragraph(("Nothing vanishes in this model.",)))
    return tuple(result)


def _by_reason(terms: Sequence[tuple[Term, Reason]], notation: Notation) -> TableBlock:
    """Terms that vanish for the same reason in one row: their names, each with the rows of the equations it is of."""
    gathered: dict[Reason, dict[str, list[str]]] = {}
    for term, why in terms:
        gathered.setdefault(why, {}).setdefault(term.name, []).append(term.row)
    rows: list[list[Content]] = [
        [
            reason(why, notation),
            sum(map(len, by_name.values())),
            "; ".join(f"{name} in {_rows(own, notation)}" for name, own in by_name.items()),
        ]
        for why, by_name in gathered.items()
    ]
    return table("Terms that vanish, by reason", ("reason", "number", "terms"), rows, "lrl")


def _rows(names: Sequence[str], notation: Notation) -> str:
    """Rows by their virtual displacements; of many the first and the last."""
    shown = names if len(names) <= FEW else (*names[: FEW - 2], names[-1])
    text = [notation.delta(name) for name in shown]
    return ", ".join(text if len(names) <= FEW else [*text[:-1], "…", text[-1]])


def _would_be(term: Term, notation: Notation) -> Content:
    """The expression of a vanished term, if it is short."""
    if term.expr == 0:
        return NumberToken("0")
    count = len(sp.Add.make_args(term.expr))
    return notation.formula(term.expr) if count <= SUMMANDS else f"a sum of {count}"


def _integrals(equations: Equations, notation: Notation) -> list[Block]:
    """Shape integrals that vanish, by reason and family."""
    gathered: dict[str, list[sp.Symbol]] = {}
    for c in equations.coefficients:
        if c.zero:
            gathered.setdefault(c.zero, []).append(c.symbol)
    if not gathered:
        return []
    rows: list[list[Content]] = [
        [reason(why, notation), len(names), _names(names, notation)] for why, names in gathered.items()
    ]
    return [table("Shape integrals that vanish", ("reason", "number", "integrals"), rows, "lrl")]


def _names(symbols: Sequence[sp.Symbol], notation: Notation) -> tuple[Inline, ...]:
    """Integrals, family by family; of many of a family how many there are."""
    text: list[Inline] = []
    for (owner, family), group in groupby(symbols, key=_family):
        some = list(group)
        text += ["; "] if text else []
        if len(some) > FEW and family in INTEGRANDS and not owner:
            text += [f"{len(some)} of ", Math(whole(family))]
            continue
        for k, symbol in enumerate(some):
            text += [", "] if k else []
            text.append(Math(notation.formula(symbol)))
    return tuple(text)


def _family(symbol: sp.Symbol) -> tuple[str, Family]:
    known = identity(symbol)
    return known.owner, known.family
