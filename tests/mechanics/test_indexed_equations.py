"""Equations with their sums over the modes kept say the same as those written out, and both print on a page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest
import sympy as sp

import derive
from beams import FRAMES
from conftest import ROOT
from derive.mechanics.body import Body
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.sums import exchanged, signed_entry
from derive.mechanics.symbols import I, J, amplitude

if TYPE_CHECKING:
    from derive.mechanics.typed_symbol import Symbol

SCENES = sorted(path for path in (ROOT / "scenes").glob("*.toml"))


def values(body: Body) -> dict[sp.Symbol, sp.Expr]:
    """The value of every constant of a body; of the mass, gravity and points as well."""
    constants = [body.mass_constant, *body.gravity]
    constants += [c for table in body.tables for c in body.values.constants(table)]
    return {c.symbol: c.value for c in constants}


def evaluated(equations: Equations, row: str, shape: int) -> sp.Expr:
    """A row of the indexed form for one shape."""
    return carried_out(equations, equations.sum_of(row), shape)


def evaluated_energy(equations: Equations) -> sp.Expr:
    """The kinetic energy of the indexed form."""
    return carried_out(equations, equations.kinetic_energy, 1)


def at(symbol: Symbol, i: int, j: int = 0) -> sp.Expr:
    """A generic symbol at modes i and j, with its sign."""
    sign, entry = signed_entry(symbol, i, j)
    return sign * entry


def carried_out(equations: Equations, of_form: sp.Expr, shape: int) -> sp.Expr:
    """An expression of the indexed form for one shape: sums are carried out by hand, constants have their values."""
    assert equations.body is not None
    known, shapes = values(equations.body), range(1, equations.modes + 1)
    sums: dict[sp.Symbol, sp.Expr] = {}

    def of(expr: sp.Expr, i: int) -> sp.Expr:
        """An expression of the generic index i for shape i."""
        named = {s: at(s, i, i) if s.identity.indexed else s for s in expr.free_symbols}
        for generic, symbol in named.items():
            if generic.identity.shapes == (I,) and len(symbol.identity.shapes) == 1 and symbol not in known | sums:
                diagonal = exchanged(generic, {I: I}).identity  # the diagonal of a table has one index
                pair = [s for s in known if s.identity.family is diagonal.family and s.identity.shapes == (i, i)]
                named[generic] = pair[0] if pair else symbol
        return expr.xreplace(named).xreplace(sums).xreplace(known)

    for c in equations.table_sums:
        for i in shapes:
            products = (exchanged(f, {J: j}) * at(e, i, j) for f, e in c.sums for j in shapes)
            sums[at(c.symbol, i)] = sp.expand(of(c.offset, i) + sp.Add(*products).xreplace(known))
    for total in equations.mode_sums:
        sums[total.symbol] = sp.expand(of(total.offset, 1) + sp.Add(*(of(total.term, i) for i in shapes)))
    expr = of(of_form, shape)
    for definition in reversed(equations.definitions):
        expr = expr.xreplace({definition.symbol: definition.expr})
    return sp.expand(expr)


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("n", [1, 2, 3])
@pytest.mark.parametrize(
    "masses",
    [pytest.param({}, marks=pytest.mark.long), {"tip": {"at": 1, "mass": 2, "inertia": 3}}],
    ids=["bare", "with a mass"],
)
def test_sums_of_a_beam_are_the_expanded_ones(frame: str, n: int, masses: dict) -> None:
    shapes = ["1", "xi", *(f"xi^{k}" for k in range(2, n + 2))]
    spec = derive.planar_beam("beam", ansatz=shapes, frame=FRAMES[frame], orthogonal=False, masses=masses)
    equations = derive.derive(spec)
    assert not isinstance(equations.expanded(), IndexedEquations)
    for row in ("c1", "c2", "phi"):
        assert sp.expand(evaluated(equations, row, 1) - equations.row(row)) == 0
    for i in range(1, n + 1):
        assert sp.expand(evaluated(equations, "alpha_i", i) - equations.row(f"alpha{i}")) == 0
        assert amplitude(i, 2) in equations.row(f"alpha{i}").free_symbols
    sums, expanded = (evaluated_energy(equations), equations.expanded().kinetic_energy)
    assert sp.expand(sums - equations.expanded().substituted(expanded)) == 0


def test_the_size_of_the_indexed_form_does_not_depend_on_the_number_of_modes() -> None:
    few, many = (derive.derive(derive.symbolic_body("body", n, frame="given")) for n in (3, 60))
    assert [t.expr for t in few.terms] == [t.expr for t in many.terms] and few.mode_sums == many.mode_sums


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_equations_print_on_a_page(path: Path) -> None:
    derived = derive.derive(derive.read(path))
    for shown in (derived, derived.expanded()):
        lines = str(shown).splitlines()
        assert 4 <= len(lines) <= 75 and max(map(len, lines)) <= 120
    assert str(derived.expanded().rows[0].name) in str(derived.expanded())
