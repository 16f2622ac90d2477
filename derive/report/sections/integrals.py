"""Shape integrals and stiffness with their values."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from derive.mechanics.equations import Coefficient, Equations
from derive.mechanics.indexed_equations import GenericEquations, Table
from derive.mechanics.symbols import Family, identity
from derive.report.document.page import Block, Code, Heading, Paragraph, Text
from derive.report.document.tables import MOST, Said, folded, table
from derive.report.notation.doc_formulas import doc, reason, unit
from derive.report.notation.expressions import SMALL, Notation, decimal
from derive.report.notation.names import SHAPES
from derive.report.notation.names import table as whole


def integral_blocks(equations: Equations | GenericEquations, notation: Notation) -> tuple[Block, ...]:
    """The integrals that are there, with their values; those that vanish are told elsewhere."""
    head = Heading("Shape integrals", "integrals")
    if isinstance(equations, GenericEquations):
        return (head, _tables(equations))
    there = [c for c in equations.coefficients if not c.zero]
    many = len(equations.coefficients) > MOST
    rows = [_integral(c, notation, told=not many) for c in there]
    said = table("", ("integral", *([] if many else ["what it is"]), "value", "unit", "in the code"), rows)
    rounded = "Values that do not end are shown to six digits; the code has all of them."
    return (
        head,
        *((_families(equations.coefficients),) if many else ()),
        folded(said, "Integrals with their values"),
        *((Paragraph((rounded,)),) if any(_rounded(c.value) for c in there) else ()),
    )


def _integral(c: Coefficient, notation: Notation, told: bool) -> list[Said]:
    what: list[Said] = [doc(c.doc)] if told else []
    return [notation.formula(c.symbol), *what, _value(c, notation), unit(c.unit), Code(str(c.symbol))]


def _rounded(value: sp.Expr) -> bool:
    """Whether a number is shown with fewer digits than it has."""
    return bool(value.is_Rational) and value.q > SMALL and sp.Rational(decimal(abs(value))) != abs(value)


def _value(coefficient: Coefficient, notation: Notation) -> Said:
    value = coefficient.value
    same = isinstance(value, sp.Symbol) and notation.formula(value) == notation.formula(coefficient.symbol)
    return "a parameter" if same else notation.formula(value)


def family_of(symbol: sp.Symbol) -> str:
    """The integral that an entry is of; markers and gravity by what they are."""
    known = identity(symbol)
    named = {Family.POINT_POSITION: "points", Family.GRAVITY: "gravity"}
    return known.owner or named.get(known.family, known.section)


def _families(coefficients: Iterable[Coefficient]) -> Block:
    """How many entries each integral has, and how many do not vanish."""
    gathered: dict[str, list[Coefficient]] = {}
    for c in coefficients:
        gathered.setdefault(family_of(c.symbol), []).append(c)
    rows: list[list[Said]] = []
    for name, some in gathered.items():
        first = whole(name) if name in SHAPES else name
        there = sum(not c.zero for c in some)
        rows.append([first, generic_doc(some[0].doc) if name in SHAPES else "", len(some), there, unit(some[0].unit)])
    return table("Integrals, and how many of them do not vanish", HEAD, rows, "llrrl")


HEAD = ("integral", "what it is", "entries", "of which not zero", "unit")


def generic_doc(text: str) -> Text:
    """What an integral is for any shape: the first index is i, the second j."""
    return doc(text.replace("_2", "_j").replace("_1", "_i"))


def _tables(equations: GenericEquations) -> Block:
    """The tables of a body with loops: what is there, and why there is not more."""
    rows: list[list[Said]] = []
    kinds = {"full": "all", "diagonal": "the diagonal", "unit": "the unit matrix", "zero": "none"}
    for t in equations.tables:
        name: Said = whole(t.name) if t.name in SHAPES else Code(t.name)
        rows.append([name, doc(t.doc), entries(t, equations.modes), kinds[t.kind], unit(t.unit), reason(t.zero)])
    head = ("integral", "what it is", "entries", "of which there", "unit", "the others vanish by")
    return table("Integrals of the body, which are tables for all shapes", head, rows, "llrlll")


def entries(given: Table, modes: int) -> int:
    """Independent entries of a table."""
    pairs = modes * (modes + (-1 if given.family is Family.C7 else 1)) // 2
    return (1, modes, pairs)[given.counted] * len(given.components)
