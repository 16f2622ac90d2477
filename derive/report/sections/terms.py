"""The equations of motion row by row: in shape integrals and moments, and written out in coordinates.

Every term keeps its name and its number, and leads to the lines of the generated C that compute it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from derive.algebra import sp
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.symbols import Family, Identity, identity
from derive.mechanics.terms import Intermediate
from derive.report.document.anchors import anchor
from derive.report.document.formula import Equation, FormulaRow, Part
from derive.report.document.page import (
    Block,
    Cell,
    Content,
    Details,
    EquationBlock,
    Heading,
    Hyperlink,
    Inline,
    Math,
    TableBlock,
    table,
)
from derive.report.notation.expressions import Notation
from derive.report.notation.labels import SHAPE
from derive.report.sections.term_lines import LocatedTerm, group, line_anchor, rank_in_row, title

MOST_ROWS, MOST_SUMMANDS = 16, 240
"""Rows that are shown, others are folded; summands of all rows up to which they are written out in coordinates."""
HOPELESS = 10 * MOST_SUMMANDS
"""Summands of a definition before it is expanded from which on too many of them remain."""


@dataclass(frozen=True)
class Substitution:
    """The symbols of the equations, expressed in coordinates, velocities and parameters."""

    values: Mapping[sp.Symbol, sp.Expr]

    def __call__(self, expr: sp.Expr) -> sp.Expr:
        """An expression written out."""
        return sp.expand(expr.xreplace(self.values))


def expansion(equations: Equations, integrals: bool = True) -> Substitution:
    """Definitions written out, and shape integrals too if they are not to stay names."""
    values: dict[sp.Symbol, sp.Expr] = {c.symbol: c.value for c in equations.coefficients if integrals or c.zero}
    for definition in equations.definitions:
        values[definition.symbol] = sp.expand(definition.expr.xreplace(values))
    return Substitution(values)


def row_blocks(
    equations: Equations, located: Sequence[LocatedTerm], notation: Notation, number: str = ""
) -> tuple[Block, ...]:
    """Every row: its equation and its terms; `number` is that of the rows written out, if the paper has them."""
    written = _short(equations)
    names = row_names(equations)
    shown = [_row(name, names[name], located, notation, written, number) for name in names]
    if len(shown) <= MOST_ROWS:
        return tuple(block for blocks in shown for block in blocks)
    first = tuple(block for blocks in shown[:MOST_ROWS] for block in blocks)
    rest = tuple(block for blocks in shown[MOST_ROWS:] for block in blocks)
    return (*first, Details(f"The other {len(shown) - MOST_ROWS} rows", rest))


def _short(equations: Equations) -> Substitution | None:
    """The substitution that writes the rows out in coordinates; None if that makes too many summands."""
    if isinstance(equations, IndexedEquations):
        return None
    values: dict[sp.Symbol, sp.Expr] = {c.symbol: c.value for c in equations.coefficients}
    for definition in _needed(equations):
        if _summands(definition.expr, values) > HOPELESS:
            return None
        values[definition.symbol] = sp.expand(definition.expr.xreplace(values))
        if len(sp.Add.make_args(values[definition.symbol])) > MOST_SUMMANDS:
            return None
    written, count = Substitution(values), 0
    for term in equations.terms:
        count += len(sp.Add.make_args(written(term.expr)))
        if count > MOST_SUMMANDS:
            return None
    return written


def _summands(expr: sp.Expr, values: Mapping[sp.Symbol, sp.Expr]) -> int:
    """The number of summands of an expression with these values in place of symbols, if none of them cancel."""
    if expr.is_Add:
        return sum(_summands(arg, values) for arg in expr.args)
    if expr.is_Mul:
        return math.prod(_summands(arg, values) for arg in expr.args)
    if expr.is_Pow and expr.exp.is_Integer and expr.exp > 0:
        own = _summands(expr.base, values)
        return math.comb(own + int(expr.exp) - 1, int(expr.exp))
    return len(sp.Add.make_args(values[expr])) if expr in values else 1


def _needed(equations: Equations) -> list[Intermediate]:
    """The definitions that the terms depend on, in their order."""
    symbols = set().union(*(term.expr.free_symbols for term in equations.terms))
    result = []
    for definition in reversed(equations.definitions):
        if definition.symbol in symbols:
            symbols |= definition.expr.free_symbols
            result.append(definition)
    return result[::-1]


def row_names(equations: Equations) -> dict[str, str]:
    """The rows with what their virtual displacements are."""
    result = {row.name: _meaning(identity(row.v)) for row in equations.rows}
    if isinstance(equations, IndexedEquations) and equations.modes:
        result[SHAPE] = f"each of the {equations.modes} shapes"
    return result


def _meaning(velocity: Identity) -> str:
    """The meaning of a row of rotation; empty for other rows, whose coordinates have a name."""
    if velocity.family is not Family.ANGULAR_VELOCITY:
        return ""
    return f"rotation about the body axis {velocity.components[0]}"


def _row(
    name: str,
    meaning: str,
    located: Sequence[LocatedTerm],
    notation: Notation,
    written: Substitution | None,
    number: str,
) -> tuple[Block, ...]:
    own = ordered(p for p in located if p.term.row == name)
    head = Heading(f"{notation.delta(name)}{f': {meaning}' if meaning else ''}", anchor("row", name), 3)
    if not own:
        return (head, EquationBlock((Equation(notation.variation(name), (), ":"),)))
    parts = tuple(part for item in own for part in _parts(item, notation))
    lines = [Equation(notation.variation(name), parts, ":", "15")]
    if written:
        summands = tuple(part for item in own for part in _written(item, written, notation))
        if not _same(parts, summands):
            lines.append(Equation(FormulaRow(()), summands, "=", number))
    return (head, EquationBlock(tuple(lines)), _table(own, notation))


def ordered(located: Iterable[LocatedTerm]) -> list[LocatedTerm]:
    """Accelerations first, then rates, elastic, and the rest; within a group as they were derived."""
    return sorted(located, key=lambda item: rank_in_row(item.term))


def _parts(located: LocatedTerm, notation: Notation) -> tuple[Part, ...]:
    to = f"#{line_anchor(located.stores[0])}" if located.stores else ""
    return notation.parts(located.term.expr, located.anchor, group(located.term), title(located.term), to)


def _written(located: LocatedTerm, written: Substitution, notation: Notation) -> tuple[Part, ...]:
    expr = written(located.term.expr)
    return notation.parts(expr, "", group(located.term), title(located.term), f"#{located.anchor}")


def _same(parts: Sequence[Part], others: Sequence[Part]) -> bool:
    """Whether writing a row out leaves it the same."""
    return [(p.sign, p.formula) for p in parts] == [(p.sign, p.formula) for p in others]


def _table(located: Sequence[LocatedTerm], notation: Notation) -> TableBlock:
    """The terms of a row with their lines."""
    rows: list[list[Content]] = [
        [_linked(p), group(p.term), p.term.equation, lines(p.stores), _names(p, notation)] for p in located
    ]
    head = ("term", "group", "from", "stored in line", "made of")
    return table("", head, rows)


def _linked(located: LocatedTerm) -> Cell:
    return Cell((Hyperlink(located.term.name, f"#{located.anchor}"),))


def lines(numbers: Sequence[int]) -> tuple[Inline, ...]:
    """Numbers of lines as links, those that follow each other as one."""
    result: list[Inline] = []
    for first, last in runs(numbers):
        text = str(first) if first == last else f"{first}\N{EN DASH}{last}"
        result += [", "] if result else []
        result.append(Hyperlink(text, f"#{line_anchor(first)}"))
    return tuple(result)


def runs(numbers: Sequence[int]) -> list[tuple[int, int]]:
    """The first and the last number of each run of consecutive numbers."""
    groups = groupby(enumerate(numbers), key=lambda pair: pair[1] - pair[0])
    pieces = ([number for _, number in group] for _, group in groups)
    return [(piece[0], piece[-1]) for piece in pieces]


def _names(located: LocatedTerm, notation: Notation) -> tuple[Inline, ...]:
    """The names that a term is made of, with the lines that define them; those that follow each other together."""
    by_line = {number: symbol for symbol, number in located.names}
    result: list[Inline] = []
    for first, last in runs(sorted(by_line)):
        between = [number for number in (first, last) if first != last or number == first][: 2 if first != last else 1]
        result += ["; "] if result else []
        for k, number in enumerate(between):
            result += [" … "] if k and last > first + 1 else [", "] if k else []
            result.append(Math(notation.formula(by_line[number])))
        text = f"line {first}" if first == last else f"lines {first}\N{EN DASH}{last}"
        result += [" ", Hyperlink(text, f"#{line_anchor(first)}")]
    return tuple(result)


def written_row(equations: Equations, name: str, written: Substitution, notation: Notation) -> tuple[Part, ...]:
    """A row written out in coordinates, term by term, without links."""
    result: list[Part] = []
    for term in sorted((t for t in equations.terms if t.row == name), key=rank_in_row):
        result += notation.parts(written(term.expr), group=group(term), title=title(term))
    return tuple(result)
