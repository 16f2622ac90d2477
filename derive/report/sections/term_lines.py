"""Where the generated C computes each term: the lines that store its row, and those that define the names in it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import sympy as sp

from derive.backends.source_map import FunctionLines, SourceMap, StoredValue
from derive.ir.model import Model
from derive.mechanics.equations import Equations
from derive.mechanics.sums import exchanged
from derive.mechanics.symbols import I, Identity, J, Symbol, identity
from derive.mechanics.terms import Term
from derive.report.document.anchors import anchor
from derive.report.notation.labels import row_identities

GROUPS = {
    **dict.fromkeys(("translation", "Euler", "relative"), "accelerations"),
    **dict.fromkeys(("centrifugal", "Coriolis"), "rates"),
}
"""What a term is grouped by; any other term is a group by itself."""


ORDER = ("accelerations", "rates", "elastic", "damping", "gravity")
"""Groups as they follow each other; others come last."""


def group(term: Term) -> str:
    """What a term is grouped by."""
    return GROUPS.get(term.name, term.name)


def rank_in_row(term: Term) -> int:
    """Where a term stands in its row, by its group."""
    return ORDER.index(group(term)) if group(term) in ORDER else len(ORDER)


def title(term: Term) -> str:
    """What a term is, in a few words."""
    return f"{term.name} term, {term.equation}"


@dataclass(frozen=True)
class LocatedTerm:
    """A term with the lines of the generated C that belong to it: those that store it, and names with their lines."""

    term: Term
    variation: Identity
    stores: tuple[int, ...]
    names: tuple[tuple[sp.Symbol, int], ...]

    @property
    def anchor(self) -> str:
        """Its anchor."""
        return anchor("term", self.term.row, self.term.name)


def locate_terms(equations: Equations, model: Model, code: SourceMap) -> tuple[LocatedTerm, ...]:
    """Every term with its lines."""
    finder = _Finder(equations, model, code)
    return tuple(finder.locate(term) for term in equations.terms)


def definition_lines(code: SourceMap) -> dict[str, int]:
    """The line that computes each name: of `force`, or of `mass` if it stands there alone."""
    return {**code.functions["mass"].definitions, **code.functions["force"].definitions}


def line_anchor(number: int) -> str:
    """The anchor of a line of the generated C."""
    return f"c-{number}"


class _Finder:
    """Rows and accelerations of a model, by their places in M and h."""

    def __init__(self, equations: Equations, model: Model, code: SourceMap) -> None:
        self.equations, self.code = equations, code
        generic = equations.indexed and equations.modes > 0
        self.rigid = len(equations.rows) - generic
        self.variations = row_identities(equations)
        self.rows = {row.name: k for k, row in enumerate(equations.rows)}
        self.accelerations = {row.a: k for k, row in enumerate(equations.rows)}
        self.totals: dict[sp.Symbol, sp.Expr] = {}
        if equations.indexed:
            self.totals = {t.symbol: t.term for t in equations.mode_sums}
            self.totals |= {c.symbol: _inside(c.sums) for c in equations.table_sums}
        self.pattern = model.pattern("mass", "M")
        self.stored = tuple(self._stored(code.functions["mass"]))

    def locate(self, term: Term) -> LocatedTerm:
        """The lines of one term."""
        row = self.rows[term.row]
        columns = {k for a, k in self.accelerations.items() if a in self._behind(term.expr)}
        if columns:
            pairs = {(min(row, column), max(row, column)) for column in columns}
            lines = tuple(sorted({number for entry, number in self.stored if entry in pairs}))
            return LocatedTerm(term, self.variations[term.row], lines, self._names(term, self.code.functions["mass"]))
        force = self.code.functions["force"]
        looped = self.equations.indexed and row == self.rigid
        result = force.stores.get(StoredValue("h", row, looped))
        return LocatedTerm(term, self.variations[term.row], (result,) if result else (), self._names(term, force))

    def _stored(self, mass: FunctionLines) -> Iterator[tuple[tuple[int, int], int]]:
        """The entry that each line of `mass` stores; entries of the shapes count as one where there are loops."""
        entries = self.pattern.entries
        for value, number in mass.stores.items():
            if value.output == "M":
                i, j = (min(k, self.rigid) for k in entries[value.index])
                yield (j, i), number

    def _behind(self, expr: sp.Expr) -> set[sp.Symbol]:
        """All symbols in an expression and in the sums that it is made of."""
        result, fresh = set(), set(expr.free_symbols)
        while fresh:
            result |= fresh
            fresh = {s for f in fresh if f in self.totals for s in self.totals[f].free_symbols} - result
        return result

    def _names(self, term: Term, function: FunctionLines) -> tuple[tuple[sp.Symbol, int], ...]:
        lines = function.definitions
        result = [(symbol, lines[name]) for symbol in term.expr.free_symbols if (name := array(symbol)) in lines]
        return tuple(sorted(result, key=lambda pair: pair[1]))


def array(symbol: sp.Symbol) -> str:
    """What an indexed quantity is called in a loop: S_i_11 is the array S_11."""
    known = identity(symbol)
    return replace(known, shapes=()).name if known.indexed else known.name


def _inside(sums: Iterable[tuple[Symbol, Symbol]]) -> sp.Expr:
    return sp.Add(*(exchanged(factor, {J: I}) * entry for factor, entry in sums))
