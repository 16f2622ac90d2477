"""The second order of beams in space: the fields by which it moves and turns sections, and the coupling of bendings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from derive.report.document.formula import (
    Equation,
    Fenced,
    Formula,
    FormulaRow,
    Name,
    NumberToken,
    OperatorToken,
    Part,
    Quotient,
)
from derive.report.document.page import Block, EquationBlock, Inline, Math, Paragraph
from derive.report.notation.beam_functions import shape_name
from derive.report.notation.formula_reader import formula
from derive.spec.model.spatial_beam import SpatialBeam

HALF = Quotient(NumberToken("1"), NumberToken("2"))
OF_POINT = Name("p", style="vector")
CROSS = OperatorToken("\u00d7")


def section_fields_blocks(beams: Sequence[SpatialBeam]) -> tuple[Block, ...]:
    """The fields Phi_i and Psi_ij of beams in space, the rotation s of their sections, and the energy of third order.

    What no beam has, such as torsion, is left out.
    """
    twists, stretches = any(beam.torsion for beam in beams), any(beam.axial for beam in beams)
    letters: list[Inline] = [Math(Name("v")), " and ", Math(Name("w")), " are the deflections along e2 and e3"]
    if twists:
        letters += [", ", Math(Name("theta")), " is the twist, the rotation of the sections about the axis"]
    if stretches:
        letters += [", ", Math(Name("u")), " is the displacement along the axis"]
    fields: tuple[Inline, ...] = (
        "A section of a beam in space is rigid. The shape i displaces the axis by ",
        Math(formula("d_i")),
        ", and turns a section, whose points have the position ",
        Math(OF_POINT),
        " against the axis, by the small vector ",
        Math(_rotation("i")),
        ". At second order the axis gets shorter as a beam bends, and the sections turn as its tangent does, and "
        "further by the vector ",
        Math(Name("s", style="vector")),
        ", to which two shapes add ",
        Math(_rotation("i", "j")),
        ":",
    )
    blocks: list[Block] = [
        Paragraph(fields),
        EquationBlock((_first(), _second(), _shortening())),
        Paragraph(("Here ", *letters, "; primes are derivatives by x.")),
        EquationBlock(tuple(_turning(twists, stretches))),
    ]
    if any(beam.torsion and beam.bending_stiffnesses[0] != beam.bending_stiffnesses[1] for beam in beams):
        coupling = (
            "A beam that twists has the curvatures of both bendings in other planes. Where its bending stiffnesses "
            "differ, this adds to the strain energy a term of third order in the amplitudes, which is of second order "
            "about a bent state: a beam buckles laterally by it. In the equations it is the term elastic, third order."
        )
        blocks += [Paragraph((coupling,)), EquationBlock((_coupling(),))]
    return tuple(blocks)


def _rotation(*index: str) -> Name:
    """The rotation of the sections by a shape, or the part of second order of two of them."""
    return Name("t" if len(index) == 1 else "s", below=(" ".join(index),), style="vector")


def _turned(by: Formula, what: Formula) -> FormulaRow:
    return FormulaRow((by, CROSS, what))


def _first() -> Equation:
    displaced = formula("d_i")
    return Equation(formula("Phi_i"), (Part("+", displaced), Part("+", _turned(_rotation("i"), OF_POINT))))


def _second() -> Equation:
    both = FormulaRow(
        (
            _turned(_rotation("i"), Fenced(_turned(_rotation("j"), OF_POINT))),
            OperatorToken("+"),
            _turned(_rotation("j"), Fenced(_turned(_rotation("i"), OF_POINT))),
        )
    )
    return Equation(
        formula("Psi_{i j}"),
        (
            Part("+", FormulaRow((Name("psi", below=("i j",)), formula("e_1")))),
            Part("+", FormulaRow((HALF, Fenced(both)))),
            Part("+", _turned(_rotation("i", "j"), OF_POINT)),
        ),
    )


def _shortening() -> Equation:
    """The psi_ij of two shapes in one plane, from their slopes."""
    slopes = tuple(FormulaRow((shape_name(index), OperatorToken("\N{PRIME}"))) for index in ("i", "j"))
    integral = FormulaRow((Name("∫"), *slopes, OperatorToken("d"), Name("x")))
    return Equation(Name("psi", below=("i j",)), (Part("-", integral),))


def _slope(of: str) -> FormulaRow:
    return FormulaRow((Name(of), OperatorToken("\N{PRIME}")))


def _curvature(of: str) -> FormulaRow:
    return FormulaRow((Name(of), OperatorToken("\N{DOUBLE PRIME}")))


def _turning(twists: bool, stretches: bool) -> Iterator[Equation]:
    """The components of the rotation s at second order."""
    minus = OperatorToken("\u2212")
    inside = FormulaRow((_slope("v"), _curvature("w"), minus, _curvature("v"), _slope("w")))
    integral = FormulaRow((HALF, Name("∫"), Fenced(inside), OperatorToken("d"), Name("x")))
    yield Equation(Name("s", below=("1",)), (Part("+", integral),))
    for axis, turned, stretched, sign in (("2", "v", "w", "+"), ("3", "w", "v", "-")):
        parts = [Part("+", FormulaRow((HALF, Name("theta"), _slope(turned))))] if twists else []
        if stretches:
            parts.append(Part("+" if sign == "+" else "-", FormulaRow((_slope(stretched), _slope("u")))))
        if parts:
            yield Equation(Name("s", below=(axis,)), tuple(parts))


def _coupling() -> Equation:
    """The strain energy int (EI_3 - EI_2) theta v'' w'' dx."""
    stiffness = FormulaRow((Name("EI", below=("3",)), OperatorToken("\u2212"), Name("EI", below=("2",))))
    parts = (Name("∫"), Fenced(stiffness), Name("theta"), _curvature("v"), _curvature("w"))
    return Equation(Name("U", below=("3",)), (Part("+", FormulaRow((*parts, OperatorToken("d"), Name("x")))),))
