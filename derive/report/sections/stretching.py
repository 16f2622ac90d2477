"""The stretching of a beam, beyond the paper: its shapes along the axis, and the strain that they cause."""

from __future__ import annotations

from derive.mechanics.bodies.displacement_fields import stretching_shapes
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.report.document.formula import (
    Equation,
    Formula,
    FormulaRow,
    Name,
    NumberToken,
    OperatorToken,
    Part,
    Power,
    Quotient,
)
from derive.report.document.page import Block, EquationBlock, Paragraph
from derive.report.notation.beam_functions import beam_function
from derive.report.notation.formula_reader import equation
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.body import DisplacementOrder


def stretching_blocks(spec: PlanarBeam) -> tuple[Block, ...]:
    """The shapes along the axis and the strain energy; empty if the beam does not stretch."""
    if spec.axial is None:
        return ()
    first = len(assumed_shapes(spec.deflection)) + 1
    shapes = (
        Equation(Name("chi", below=(str(k),)), beam_function(shape))
        for k, shape in enumerate(stretching_shapes(spec), first)
    )
    strain = "du/dx + 1/2 (dv/dx)²"
    if spec.order is DisplacementOrder.FIRST_ORDER:
        strain = "du/dx"
    numbered = "Numbered behind the shapes of the deflection, its shapes along the axis are"
    primes = f"With primes for derivatives by x, the strain of the axis, {strain}, and the strain energy are"
    at_rest = ", with the axial force N of the straight beam" if spec.axial.preload else ""
    return (
        Paragraph((f"Beyond the paper, the beam stretches. {numbered}",)),
        EquationBlock(tuple(shapes)),
        Paragraph((f"{primes}{at_rest}:",)),
        EquationBlock((equation("epsilon = sum_k alpha_k chi_k^'"), _energy(preload=bool(spec.axial.preload)))),
    )


def _energy(preload: bool) -> Equation:
    """The strain energy 1/2 int EI v''^2 dx + 1/2 int EA epsilon^2 dx + int N epsilon dx of a beam."""
    square = NumberToken("2")
    curvature = Power(FormulaRow((Name("v"), OperatorToken("\N{DOUBLE PRIME}"))), square)
    half = Quotient(NumberToken("1"), NumberToken("2"))
    parts = [
        Part("+", FormulaRow((half, *_integral("EI", curvature)))),
        Part("+", FormulaRow((half, *_integral("EA", Power(Name("epsilon"), square))))),
    ]
    if preload:
        parts.append(Part("+", FormulaRow(_integral("N", Name("epsilon")))))
    return Equation(Name("U"), tuple(parts))


def _integral(factor: str, integrand: Formula) -> tuple[Formula, ...]:
    return Name("∫"), Name(factor), integrand, OperatorToken("d"), Name("x")
