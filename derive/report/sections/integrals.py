"""Shape integrals and stiffness with their values."""

from __future__ import annotations

from collections.abc import Iterable

from derive.algebra import sp
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.symbols import Family, I, Identity, J, identity
from derive.mechanics.tables import CoefficientTable, TableKind
from derive.mechanics.terms import ModelConstant
from derive.report.document.page import SHOWN, Block, CodeSpan, Content, Heading, Math, Paragraph, folded, table
from derive.report.notation.expressions import SMALL, Notation, decimal
from derive.report.notation.integral_formulas import INTEGRANDS, meaning, reason, unit
from derive.report.notation.typeset_names import whole
from derive.roles import Role, Source


def integral_blocks(equations: Equations, notation: Notation) -> tuple[Block, ...]:
    """The integrals that do not vanish, with their values."""
    head = Heading("Shape integrals", "integrals")
    if isinstance(equations, IndexedEquations):
        return (head, _tables(equations, notation))
    planar = all(q.role is not Role.QUATERNION for q in equations.coordinates)
    there = [c for c in equations.coefficients if not c.zero]
    many = len(equations.coefficients) > SHOWN
    rows = [_integral(c, notation, planar, equations.truncated, described=not many) for c in there]
    whole_table = table("", ("integral", *([] if many else ["definition"]), "value", "unit", "in the code"), rows)
    rounded = "Values with more digits are shown to six; the code has all of them."
    return (
        head,
        *((_families(equations.coefficients, planar, equations.truncated),) if many else ()),
        folded(whole_table, "Integrals with their values"),
        *((Paragraph((rounded,)),) if any(_rounded(c.value) for c in there) else ()),
    )


def _integral(c: ModelConstant, notation: Notation, planar: bool, second_order: bool, described: bool) -> list[Content]:
    # The formula of a stiffness is that of bending; one of stretching is described by the derivation.
    formulas = (c.doc,) if c.equation == Source.STRETCHING else meaning(identity(c.symbol), c.doc, planar, second_order)
    what: list[Content] = [formulas] if described else []
    return [notation.formula(c.symbol), *what, _value(c, notation), unit(c.unit), CodeSpan(str(c.symbol))]


def _rounded(value: sp.Expr) -> bool:
    """Whether a number is shown with fewer digits than it has."""
    return bool(value.is_Rational) and value.q > SMALL and sp.Rational(decimal(abs(value))) != abs(value)


def _value(coefficient: ModelConstant, notation: Notation) -> Content:
    value = coefficient.value
    same = isinstance(value, sp.Symbol) and notation.formula(value) == notation.formula(coefficient.symbol)
    return "a parameter" if same else notation.formula(value)


NAMED = {Family.POINT_POSITION: "points", Family.GRAVITY: "gravity", Family.MASS: "mass"}
"""Families whose entries are grouped under a heading."""

TABLES = (*INTEGRANDS, Family.STIFFNESS, Family.CUBIC_STIFFNESS, Family.PRELOAD, Family.DAMPING, Family.ROTARY)
"""Families with a table of entries."""


def _families(coefficients: Iterable[ModelConstant], planar: bool, second_order: bool) -> Block:
    """The table of the integrals with the numbers of their entries and of those that do not vanish."""
    gathered: dict[tuple[str, Family], list[ModelConstant]] = {}
    for c in coefficients:
        known = identity(c.symbol)
        gathered.setdefault((known.owner, known.family), []).append(c)
    rows: list[list[Content]] = []
    for (owner, family), some in gathered.items():
        first = Math(whole(family)) if family in TABLES else NAMED.get(family, family.stem)
        name: Content = (first, f" of {owner}") if owner else first
        generic = Identity(family, (I, J)[: len(identity(some[0].symbol).shapes)])
        what = meaning(generic, "", planar, second_order) if family in INTEGRANDS else _kind(family)
        rows.append([name, what, len(some), sum(not c.zero for c in some), unit(some[0].unit)])
    return table("Integrals and their non-zeros", HEAD, rows, "llrrl")


HEAD = ("integral", "definition", "entries", "non-zeros", "unit")


def _kind(family: Family) -> str:
    """The kind of the entries of a family that is no integral, in words; empty for other families."""
    names = {
        Family.STIFFNESS: "stiffness",
        Family.CUBIC_STIFFNESS: "stiffness of third order",
        Family.PRELOAD: "force at rest",
        Family.DAMPING: "damping",
        Family.ROTARY: "rotary inertia",
        Family.FIELD_WEIGHT: "parts of the fields theta in the fields of second order",
        Family.POINT_SECOND: "fields of second order at markers",
        Family.POINT_POSITION: "undeformed positions of markers",
        Family.POINT_SHAPE: "shapes at markers",
        Family.SECTION_ROTATION: "rotations of sections at markers by the shapes",
    }
    return names.get(family, "")


def _tables(equations: IndexedEquations, notation: Notation) -> Block:
    """The tables of a body with loops: what is there, and why there is not more."""
    rows: list[list[Content]] = []
    kinds = {
        TableKind.FULL: "all",
        TableKind.DIAGONAL: "the diagonal",
        TableKind.UNIT: "the unit matrix",
        TableKind.ZERO: "none",
    }
    for t in equations.tables:
        name: Content = whole(t.family) if t.family in TABLES else CodeSpan(t.name)
        what = meaning(Identity(t.family, (I, J)[: t.counted]), t.doc, planar=False, second_order=equations.truncated)
        zero = reason(t.zero, notation)
        rows.append([name, what, entries(t, equations.modes), kinds[t.kind], unit(t.unit), zero])
    head = ("integral", "definition", "entries", "of which there", "unit", "the others vanish by")
    return table("Integrals of the body, which are tables for all shapes", head, rows, "llrlll")


def entries(given: CoefficientTable, modes: int) -> int:
    """Independent entries of a table."""
    pairs = modes * (modes + (-1 if given.family is Family.C7 else 1)) // 2
    return (1, modes, pairs)[given.counted] * len(given.components)
