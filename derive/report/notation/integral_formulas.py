"""Shape integrals as formulas, by their families; units, and the reasons of zeros with the integrals in them."""

from __future__ import annotations

from collections.abc import Sequence

from derive.algebra import sp
from derive.mechanics.symbols import Family, Identity, ShapeIndex
from derive.mechanics.terms import Reason
from derive.mechanics.typed_symbol import Symbol
from derive.report.document.formula import Formula, FormulaRow, Name, NumberToken, OperatorToken, Power, Quotient
from derive.report.document.page import Inline, Math, Text
from derive.report.notation.beam_functions import shape_name
from derive.report.notation.expressions import Notation
from derive.report.notation.formula_reader import formula
from derive.report.notation.typeset_names import index_text, whole

INTEGRANDS: dict[Family, str] = {
    Family.C1: "X",
    Family.C2: "Phi_{i}",
    Family.C3: "((X . X) I - X X)",
    Family.C4: "((Phi_{i} . X) I - Phi_{i} X)",
    Family.C5: "((Phi_{i} . Phi_{j}) I - Phi_{i} Phi_{j})",
    Family.C6: "X >< Phi_{i}",
    Family.C7: "Phi_{i} >< Phi_{j}",
    Family.C8: "Phi_{i} . Phi_{j}",
    Family.C9: "Psi_{<i> <j>}",
    Family.C10: "X >< Psi_{<i> <j>}",
}
"""The integrands, over the mass, of the shape integrals for the shapes i and j; <i> stands beside other indices."""

PLANAR = {Family.C3: "X . X", Family.C4: "X . Phi_{i}", Family.C5: "(Phi_{i} . Phi_{j} + X . Psi_{<i> <j>})"}
"""The integrands of bodies in the plane, where they differ."""

SECOND_ORDER = {
    Family.C5: "((Phi_{i} . Phi_{j} + X . Psi_{<i> <j>}) I - Phi_{i} Phi_{j} - X Psi_{<i> <j>})",
}
"""The integrands of bodies in space whose displacements are of second order, where they differ."""

SYMMETRIC = (Family.C4, Family.C5)
"""Tensors of which a body in space has the symmetric part alone."""

CROSS = (Family.C6, Family.C7, Family.C10)

FEW = 4
"""The number of integrals from which on a list is shortened to the first and the last."""

RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


def integral_formula(
    family: Family,
    shapes: Sequence[ShapeIndex] = (),
    component: int = 0,
    planar: bool = False,
    second_order: bool = False,
) -> Formula:
    """A shape integral of some shapes; of a vector the component, if it is not 0."""
    others = PLANAR if planar else SECOND_ORDER if second_order else {}
    integrand = others.get(family, INTEGRANDS[family])
    for index, shape in zip("ij", shapes, strict=False):
        integrand = integrand.replace(f"{{{index}}}", f"{{{index_text(shape)}}}")
        integrand = integrand.replace(f"<{index}>", index_text(shape))
    if component:
        integrand = f"({integrand}) . e_{component}" if family in CROSS else f"{integrand} . e_{component}"
    return formula(f"int rho {integrand} dOmega")


def stiffness_formula(shapes: Sequence[ShapeIndex]) -> Formula:
    """An entry of the stiffness of a beam, (22)."""
    second = Power(OperatorToken("d"), NumberToken("2"))
    below = FormulaRow((OperatorToken("d"), Power(Name("x"), NumberToken("2"))))
    curvatures = (Quotient(FormulaRow((second, shape_name(index_text(shape)))), below) for shape in shapes)
    return FormulaRow((Name("∫"), Name("EI"), *curvatures, OperatorToken("d"), Name("x")))


def meaning(known: Identity, doc: str, planar: bool, second_order: bool = False) -> Text:
    """The meaning of an integral: its formula, or the text of the derivation if it has no formula."""
    if known.family in INTEGRANDS:
        component = known.components[0] if len(known.components) == 1 else 0
        shown = Math(integral_formula(known.family, known.shapes, component, planar, second_order))
        return ("symmetric part of ", shown) if known.family in SYMMETRIC and not planar else (shown,)
    if known.family is Family.POINT_SECOND:
        shapes = " ".join(map(index_text, known.shapes))
        return (Math(formula(f"Psi_{{{shapes}}} . e_{known.components[0]}")), f" at marker {known.point}")
    if known.family is Family.STIFFNESS and planar and known.shapes:
        return ("stiffness ", Math(stiffness_formula(known.shapes)))
    return (doc,)


def unit(text: str) -> str:
    """A unit with its powers raised, on one line."""
    first, *powers = text.split("^")
    raised = (f"{power[:1].translate(RAISED)}{power[1:]}" for power in powers)
    return "".join((first, *raised)).replace(" ", "\N{NO-BREAK SPACE}")


def reason(why: Reason | str, notation: Notation) -> Text:
    """The reason why a term or an integral vanishes, with the integrals in it as formulas."""
    if isinstance(why, str):
        return (why,)
    text: list[Inline] = []
    for words, symbols in why.by_reason.items():
        text += ["; "] if text else []
        text += _listed(symbols, notation)
        text.append(f" = 0 by {words}")
    return tuple(text) or (why.identity,)


def _listed(symbols: Sequence[sp.Symbol], notation: Notation) -> list[Inline]:
    if len(symbols) >= FEW:
        return [_integral(symbols[0], notation), " … ", _integral(symbols[-1], notation)]
    return [part for k, s in enumerate(symbols) for part in ([", "] if k else []) + [_integral(s, notation)]]


def _integral(symbol: sp.Symbol, notation: Notation) -> Inline:
    """An integral; a whole table where it has no indices."""
    known = symbol.identity if isinstance(symbol, Symbol) else None
    if known is not None and known.family in INTEGRANDS and not known.shapes and not known.components:
        return Math(whole(known.family))
    return Math(notation.formula(symbol))
