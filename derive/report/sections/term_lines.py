"""The lines of the generated C that compute each term: those that store its row, and those that define its names."""

from __future__ import annotations

from dataclasses import dataclass

from derive.algebra import sp
from derive.backends.source_map import FunctionLines, SourceMap
from derive.mechanics.equations import Equations
from derive.mechanics.symbols import Identity, identity
from derive.mechanics.terms import Term
from derive.report.document.anchors import anchor
from derive.report.notation.labels import row_identities

GROUPS = {
    **dict.fromkeys(("translation", "Euler", "relative"), "accelerations"),
    **dict.fromkeys(("centrifugal", "Coriolis"), "rates"),
}
"""The group of a term by its name; any other term is a group by itself."""


ORDER = ("accelerations", "rates", "elastic", "preload", "damping", "gravity")
"""Groups as they follow each other; others come last."""


def group(term: Term) -> str:
    """The group of a term."""
    return GROUPS.get(term.name, term.name)


def rank_in_row(term: Term) -> int:
    """The position of a term in its row, by its group."""
    return ORDER.index(group(term)) if group(term) in ORDER else len(ORDER)


def title(term: Term) -> str:
    """The name of a term and its equation, in a few words."""
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
        """The anchor of the term."""
        return anchor("term", self.term.row, self.term.name)


def locate_terms(equations: Equations, code: SourceMap) -> tuple[LocatedTerm, ...]:
    """Every term with its lines, which the source map states."""
    variations = row_identities(equations)
    return tuple(_located(term, variations[term.row], code) for term in equations.terms)


def definition_lines(code: SourceMap) -> dict[str, int]:
    """The line that computes each name: of `force`, or of `mass` if only that computes it."""
    return {**code.functions["mass"].definitions, **code.functions["force"].definitions}


def line_anchor(number: int) -> str:
    """The anchor of a line of the generated C."""
    return f"c-{number}"


def _located(term: Term, variation: Identity, code: SourceMap) -> LocatedTerm:
    mass, force = code.functions["mass"], code.functions["force"]
    in_mass, in_force = _lines_of(term, mass), _lines_of(term, force)
    return LocatedTerm(term, variation, in_mass or in_force, _names(term, mass if in_mass else force))


def _lines_of(term: Term, function: FunctionLines) -> tuple[int, ...]:
    """The lines of a function that store values which the term is a part of."""
    key = term.row, term.name
    return tuple(number for number, line in function.numbered if key in ((t.row, t.name) for t in line.terms))


def _names(term: Term, function: FunctionLines) -> tuple[tuple[sp.Symbol, int], ...]:
    lines = function.definitions
    result = [(symbol, lines[name]) for symbol in term.expr.free_symbols if (name := identity(symbol).array) in lines]
    return tuple(sorted(result, key=lambda pair: pair[1]))
