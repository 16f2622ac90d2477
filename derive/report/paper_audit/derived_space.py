"""The derived equations of a body in space: the equations of motion (15) and (20), the appendix."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from itertools import groupby
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics import virtual_work_equations as body
from derive.mechanics.axes import AXES
from derive.mechanics.bodies.spatial_body import parametric_body
from derive.mechanics.bodies.spatial_tables import DOCS
from derive.mechanics.generic_forces import generic_forces
from derive.mechanics.indexed_equations import IndexedEquations, derive_body
from derive.mechanics.motion.spatial import rotation_of, spatial_moment_sums, spatial_row_sums
from derive.mechanics.sums import IndexedSum
from derive.mechanics.symbols import Family, I, J, quantity
from derive.mechanics.tables import INDICES, TableKind
from derive.mechanics.terms import Term
from derive.report.document.formula import Equation, Formula, FormulaRow, Name, NumberToken, Part
from derive.report.notation.formula_reader import formula
from derive.report.notation.integral_formulas import SYMMETRIC, integral_formula
from derive.report.notation.typeset_names import indexed
from derive.report.notation.vector_form import arrow, summand, summands
from derive.report.sections.kinematics import MOTION
from derive.spec.construction.bodies import symbolic_body

if TYPE_CHECKING:
    from derive.mechanics.typed_symbol import Symbol

VARIED = {"c": "delta c", "pi": "delta pi", "alpha": "delta alpha_i"}


INTEGRALS = {family.stem: family for family in DOCS}
"""Shape integrals, stiffness and damping by their printed names."""


def rotation() -> tuple[Equation, ...]:
    """The displacement by a small rotation: the derivative of the rotation tensor of a quaternion."""
    angle = sp.Symbol("chi")
    turned = rotation_of((sp.cos(angle / 2), *(sp.sin(angle / 2) * arrow("e"))))
    small = (turned.diff(angle).subs(angle, 0) * arrow("X")).expand()
    (part,) = summands(small)
    left = formula("u_{rotation}")
    return (Equation(left, (Part(part.sign, FormulaRow((Name("chi"), part.formula))),)),)


def equations_of_motion() -> tuple[Equation, ...]:
    """The equations of motion (15), with every derived term read back as a vector, and the strain energy."""
    return _rows(frozenset())


def mean_equations_of_motion() -> tuple[Equation, ...]:
    """The equations of motion (20): the terms that remain in the mean frame, and the remaining part of d3."""
    gone = frozenset((_row(v.term), v.term.name) for v in _mean().vanished)
    symbol = quantity(Family.D3, 1, shapes=(I,))
    left = next(c for c in _mean().table_sums if c.symbol == symbol)
    d3 = next(s for s in spatial_moment_sums() if s.symbol == symbol)
    assert left.offset == 0 and left.sums == d3.sums
    return (*_rows(gone), series("d3_i", base=False))


@cache
def _mean() -> IndexedEquations:
    return derive_body(parametric_body(symbolic_body("audit", 3, frame="mean", damping=True)))


def _rows(gone: frozenset[tuple[str, str]]) -> tuple[Equation, ...]:
    terms = (*body.rigid_inertia(MOTION), *body.generic_inertia(MOTION))
    result = []
    for row, of_row in groupby(terms, _row):
        kept = [(name, expr) for name, expr in _vectors(of_row) if (row, name) not in gone]
        parts = tuple(summand(expr, name, f"the {name} term of the row {row}") for name, expr in kept)
        parts += (_elastic(),) if row == "alpha" else ()
        result.append(Equation(formula(VARIED[row]), parts, relation=":"))
    return tuple(result)


ROWS = {row.name: "c" if k < len(AXES) else "pi" for k, row in enumerate(MOTION.rows)} | {"alpha_i": "alpha"}
"""The variation that each row belongs to."""


def _row(term: Term) -> str:
    return ROWS[term.row]


def _vectors(terms: Iterator[Term]) -> Iterator[tuple[str, list[sp.Expr]]]:
    """The terms of three rows with the same name together, in the order of the first row."""
    result: dict[str, list[sp.Expr]] = {}
    for term in terms:
        result.setdefault(term.name, []).append(term.expr)
    yield from result.items()


def _elastic() -> Part:
    elastic = generic_forces({Family.STIFFNESS})[0].sums[0]
    return Part("+", _sum_of(*elastic.sums[0]), group="elastic", title=elastic.doc)


def series(name: str, base: bool = True) -> Equation:
    """A moment of the appendix as the sum over the shapes that it is, for its first component."""
    every = (*spatial_moment_sums(), *spatial_row_sums())
    result: IndexedSum = next(s for s in every if replace(s.symbol.identity, components=()).name == name)
    parts = [Part("+", _written(result.offset))] if result.offset and base else []
    parts += [Part("+", _sum_of(*pair)) for pair in result.sums]
    return Equation(_written(result.symbol), tuple(parts))


def _sum_of(factor: Symbol, entry: Symbol) -> Formula:
    return FormulaRow(
        (Name("\u2211", below=("j",)), Name("alpha", factor.identity.derivative, ("j",)), _written(entry))
    )


def _written(symbol: Symbol) -> Formula:
    """A symbol of the derivation without its component, as the vector or tensor that it is a component of."""
    known = symbol.identity
    name = replace(indexed(known.family, *known.shapes), dots=known.derivative)
    return replace(name, style="scalar") if known.family in (Family.C8, Family.STIFFNESS) else name


def integral(name: str) -> tuple[Equation, ...]:
    """A shape integral as the derivation defines it."""
    family = INTEGRALS[name]
    shapes = (I, J)[: INDICES[family]]
    left: Formula = indexed(family, *shapes)
    right = integral_formula(family, shapes)
    if family in SYMMETRIC:
        left, right = (FormulaRow((Name("sym", style="word"), side)) for side in (left, right))
    return (Equation(left, (Part("+", right),)),)


def vanishing(name: str) -> Equation:
    """An integral that is zero in the mean frame; the tables of the body say so."""
    assert _mean().table(INTEGRALS[name]).kind is TableKind.ZERO
    return Equation(indexed(INTEGRALS[name], I), (Part("+", NumberToken("0")),))
