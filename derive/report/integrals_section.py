"""Shape integrals and stiffness with their values, and the moments made of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import groupby

import sympy as sp

from derive.mechanics.equations import Coefficient, Definition, Equations
from derive.mechanics.generic import Contraction, GenericEquations, Table, Total, indices, labels
from derive.mechanics.series import family
from derive.report.formula import Equation, Fenced, Name, Part
from derive.report.labels import anchor
from derive.report.names import SHAPES
from derive.report.names import table as whole
from derive.report.notation import SMALL, Notation, decimal, row
from derive.report.page import Block, Code, Details, Heading, Paragraph, Text
from derive.report.page import Equations as Lines
from derive.report.places import array, line_anchor
from derive.report.said import doc, reason, unit
from derive.report.tables import MOST, Said, folded, table

APPENDIX = "appendix"
MANY = 12
"""Moments of one family that are shown; of more of them, the rest is folded."""


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


def family_of(name: str) -> str:
    """The integral that an entry is of; markers and gravity by what they are."""
    return {"X": "points", "g": "gravity", "mass": "mass"}.get(family(name), family(name))


def _families(coefficients: Iterable[Coefficient]) -> Block:
    """How many entries each integral has, and how many do not vanish."""
    gathered: dict[str, list[Coefficient]] = {}
    for c in coefficients:
        gathered.setdefault(family_of(c.symbol.name), []).append(c)
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
    shapes = {"": 1, "i": modes, "ij": modes * (modes + (-1 if given.name == "c7" else 1)) // 2}[indices(given.name)]
    return shapes * len(labels(given.name))


def moment_blocks(
    equations: Equations | GenericEquations, notation: Notation, lines: Mapping[str, int]
) -> tuple[Block, ...]:
    """d1, D2, d3, J and what else has a name, in shape integrals and coordinates."""
    found = [("", d.symbol, notation.parts(d.expr), d.equation) for d in _told(equations.definitions)]
    if isinstance(equations, GenericEquations):
        found += [("", sp.Symbol(c.name), _contracted(c, notation), APPENDIX) for c in equations.contractions]
        found += [("", sp.Symbol(t.name), _summed(t, notation), APPENDIX) for t in equations.totals]
    named = [(family(symbol.name), _line(symbol, parts, number, notation, lines)) for _, symbol, parts, number in found]
    blocks: list[Block] = [
        Heading("Moments", "moments"),
        Paragraph(
            (
                "What the terms of (15) are made of, as in the appendix of the paper; each is computed once, and leads "
                "to the line that does it. The first index is the number of the moment, then come the shape and the "
                "components.",
            )
        ),
    ]
    short: list[Equation] = []
    for name, group in groupby(named, key=lambda pair: pair[0]):
        some = [one for _, one in group]
        if len(some) <= MANY:
            short += some
            continue
        blocks += [Lines(tuple(short))] if short else []
        short = []
        blocks.append(Details(f"{_title(name)}: {len(some)} equations", (Lines(tuple(some)),)))
    return (*blocks, *([Lines(tuple(short))] if short else []))


def _title(name: str) -> str:
    return {"S": "S, the symmetric part of D2"}.get(name, name)


def _told(definitions: Iterable[Definition]) -> list[Definition]:
    """Definitions but those that vanish, products of omega, and Q, which stands in the kinematics."""
    return [d for d in definitions if not d.zero and d.section not in ("oo", "Q")]


def _line(
    symbol: sp.Symbol, parts: tuple[Part, ...], number: str, notation: Notation, lines: Mapping[str, int]
) -> Equation:
    place = lines.get(array(symbol.name))
    to = f"#{line_anchor(place)}" if place else ""
    first = Part(parts[0].sign, parts[0].formula, title=f"{symbol} in the code", to=to)
    told = "" if number == APPENDIX else number.strip("()")
    return Equation(
        notation.known(symbol).formula, (first, *parts[1:]), number=told, anchor=definition_anchor(symbol.name)
    )


def definition_anchor(name: str) -> str:
    """The anchor of the equation of a moment; sine, cosine and the entries of Q have one together."""
    return anchor("def", "Q" if name in ("cos_phi", "sin_phi") or name.startswith("Q_") else name)


def moment_anchors(equations: Equations | GenericEquations) -> dict[str, str]:
    """The anchors of the equations of moments, by their names in the code."""
    found = [d.symbol.name for d in equations.definitions if not d.zero and d.section != "oo"]
    if isinstance(equations, GenericEquations):
        found += [c.name for c in equations.contractions] + [t.name for t in equations.totals]
    return {array(name): definition_anchor(name) for name in found}


def _contracted(given: Contraction, notation: Notation) -> tuple[Part, ...]:
    """base + sum over j of factor_j table_i_j."""
    base = notation.parts(given.base) if given.base != 0 else ()
    sums = (sp.Symbol(f"{factor}_j") * sp.Symbol(entry) for factor, entry in given.sums)
    return (*base, *(Part("+", row([big("j"), notation.formula(term)])) for term in sums))


def _summed(given: Total, notation: Notation) -> tuple[Part, ...]:
    """base + sum over i of term."""
    base = notation.parts(given.base) if given.base != 0 else ()
    term = notation.formula(given.term)
    return (*base, Part("+", row([big("i"), Fenced(term) if isinstance(given.term, sp.Add) else term])))


def big(index: str) -> Name:
    """A sum over the shapes."""
    return Name("\N{N-ARY SUMMATION}", below=(index,))
