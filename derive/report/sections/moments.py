"""The moments d1, D2, d3 and J of (15), made of shape integrals and coordinates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from derive.algebra import sp
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.sums import ModeSum, TableSum
from derive.mechanics.symbols import Family, identity
from derive.report.document.anchors import anchor
from derive.report.document.formula import Equation, Fenced, Name, Part
from derive.report.document.page import SHOWN, Block, Details, EquationBlock, Heading, Paragraph
from derive.report.notation.expressions import Notation, row
from derive.report.sections.term_lines import line_anchor
from derive.roles import Source

MANY = 12
"""Moments of one family that are shown; of more of them, the rest is folded."""


@dataclass(frozen=True)
class Moment:
    """A moment with its summands and its equation number."""

    symbol: sp.Symbol
    parts: tuple[Part, ...]
    number: str

    @property
    def family(self) -> str:
        """The moment without its indices."""
        known = identity(self.symbol)
        return known.owner or known.section


def moments(equations: Equations, notation: Notation) -> tuple[tuple[Moment, ...], ...]:
    """d1, D2, d3, J and the other named moments, by families; Q is defined in the kinematics."""
    listed = [d for d in equations.definitions if not d.zero and d.section not in ("oo", "Q")]
    result = [Moment(d.symbol, notation.parts(d.expr), d.equation) for d in listed]
    if isinstance(equations, IndexedEquations):
        result += [Moment(c.symbol, _contracted(c, notation), c.source) for c in equations.table_sums]
        result += [Moment(t.symbol, _summed(t, notation), t.source) for t in equations.mode_sums]
    return tuple(tuple(group) for _, group in groupby(result, key=lambda moment: moment.family))


def moment_blocks(
    families: Sequence[Sequence[Moment]], notation: Notation, lines: Mapping[str, int]
) -> tuple[Block, ...]:
    """The moments in shape integrals and coordinates; of many of a family the first ones, folded away."""
    blocks: list[Block] = [
        Heading("Moments", "moments"),
        Paragraph(
            (
                "The terms of (15) are made of these moments, as in the appendix of the paper. Each is computed once "
                "and links to the line of C that computes it. The first index is the number of the moment; the indices "
                "of the shape and of the components follow.",
            )
        ),
    ]
    short: list[Equation] = []
    for some in families:
        shown = [_line(moment, notation, lines) for moment in some[:SHOWN]]
        if len(some) <= MANY:
            short += shown
            continue
        blocks += [EquationBlock(tuple(short))] if short else []
        short = []
        count = f"{len(some)} equations" if len(some) <= SHOWN else f"the first {SHOWN} of {len(some)} equations"
        blocks.append(Details(f"{_title(some[0].family)}: {count}", (EquationBlock(tuple(shown)),)))
    return (*blocks, *([EquationBlock(tuple(short))] if short else []))


def _title(name: str) -> str:
    return {"S": "S, the symmetric part of D2"}.get(name, name)


def _line(moment: Moment, notation: Notation, lines: Mapping[str, int]) -> Equation:
    """The equation of a moment, which leads to its line."""
    name = moment.symbol.name
    place = lines.get(identity(moment.symbol).array)
    first = replace(moment.parts[0], title=f"{name} in the code", to=f"#{line_anchor(place)}" if place else "")
    listed = "" if moment.number is Source.APPENDIX else moment.number.strip("()")
    parts = (first, *moment.parts[1:])
    return Equation(
        notation.written(moment.symbol).formula, parts, number=listed, anchor=definition_anchor(moment.symbol)
    )


ROTATION = (Family.COSINE, Family.SINE, Family.ROTATION_TENSOR)


def definition_anchor(symbol: sp.Symbol) -> str:
    """The anchor of the equation of a moment; sine, cosine and the entries of Q have one together."""
    known = identity(symbol)
    return anchor("def", "Q" if known.family in ROTATION and not known.owner else symbol.name)


def moment_anchors(equations: Equations, families: Sequence[Sequence[Moment]]) -> dict[str, str]:
    """The anchors of the equations that are shown, by the names in the code."""
    symbols = [d.symbol for d in equations.definitions if d.section == "Q"]
    symbols += [moment.symbol for some in families for moment in some[:SHOWN]]
    return {identity(symbol).array: definition_anchor(symbol) for symbol in symbols}


def _contracted(given: TableSum, notation: Notation) -> tuple[Part, ...]:
    """base + sum over j of factor_j table_i_j."""
    base = notation.parts(given.offset) if given.offset != 0 else ()
    sums = (factor * entry for factor, entry in given.sums)
    return (*base, *(Part("+", row([big("j"), notation.formula(term)])) for term in sums))


def _summed(given: ModeSum, notation: Notation) -> tuple[Part, ...]:
    """base + sum over i of term."""
    base = notation.parts(given.offset) if given.offset != 0 else ()
    term = notation.formula(given.term)
    return (*base, Part("+", row([big("i"), Fenced(term) if isinstance(given.term, sp.Add) else term])))


def big(index: str) -> Name:
    """A sum over the shapes."""
    return Name("\N{N-ARY SUMMATION}", below=(index,))
