"""The floating frame of a body: its reference conditions, what they eliminate, and the assumed modes that are left."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import assert_never

from derive.algebra import sp
from derive.mechanics.bodies.beam_functions import polynomial, rational
from derive.mechanics.bodies.reference_conditions import (
    Condition,
    MeanCondition,
    PointCondition,
    assumed_shapes,
    conditions,
    end_conditions,
)
from derive.report.document.formula import Equation, Fenced, Formula, FormulaRow, Name, NumberToken, OperatorToken, Part
from derive.report.document.page import Block, Content, EquationBlock, Heading, Inline, Math, Paragraph, Text, table
from derive.report.notation.beam_functions import beam_function, polynomial_of, shape_name
from derive.report.notation.expressions import join, number, row
from derive.report.notation.formula_reader import equation, formula
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import Ends, FamilyKind, Polynomial, ShapeFamily
from derive.spec.model.body import BodyFrame, NodalBody


@dataclass(frozen=True)
class PaperNumbers:
    """Numbers of the paper's results for its own ansatz (21), in one of its frames."""

    conditions: tuple[str, str]
    shapes: tuple[str, str]
    deflection: str
    motion: str


MEAN = PaperNumbers(("35", "37"), ("39", "40"), "38", "41")
POINT = PaperNumbers(("28", "29"), ("31", "32"), "30", "33")

DEFLECTION = "v = sum_i alpha_i ϕ_i"
ZERO = (Part("+", NumberToken("0")),)

LISTED = 3
"""Assumed modes that a subtitle lists."""

FRAMES = {
    "mean": "The frame follows the mean motion: the deformation neither displaces the beam nor turns it on average.",
    "point": "The frame is that of a section: the deformation neither displaces it nor turns it.",
    "tangent": "The frame is that of an end: the deformation neither displaces it nor turns it.",
    "chord": "The frame follows the chord: the deformation displaces neither end across it.",
    "given": "The shapes are used as they are given; no combination of them is a rigid motion.",
}

ENDS: dict[Ends | None, str] = {
    None: "",
    "pinned": " Its ends are pinned: there is no bending moment at either.",
    "free": " Its ends are free: there is neither a bending moment nor a shear force at either.",
}

FAMILIES: dict[FamilyKind, str] = {
    "pinned": " The shapes are the natural modes of the beam with pinned ends, half sine waves of amplitude one.",
    "free-free": " The shapes are the natural modes of the free beam, scaled to one at the right end.",
    "clamped-free": " The shapes are the natural modes of the cantilever, scaled to one at the free end.",
}


@dataclass(frozen=True)
class OnAnsatz:
    """A condition as an equation for the factors a_0, a_1, ... of the ansatz, in whole numbers without a divisor."""

    condition: Condition
    factors: tuple[int, ...]

    @property
    def equation(self) -> Equation:
        """The equation for the factors of the ansatz."""
        parts = tuple(
            Part("-" if f < 0 else "+", row([*([NumberToken(str(abs(f)))] if abs(f) != 1 else []), _a(j)]))
            for j, f in enumerate(self.factors)
            if f
        )
        return Equation(join(parts), ZERO)


def on_ansatz(spec: PlanarBeam) -> tuple[OnAnsatz, ...]:
    """The conditions of the frame and of the ends of a beam on the factors of its ansatz: 3 a_0 + a_2 = 0."""
    terms = [polynomial(p) for p in polynomials(spec)]
    imposed = (*conditions(spec.frame), *end_conditions(spec.ends)) if terms else ()
    return tuple(OnAnsatz(c, _whole([rational(c.on(term)) for term in terms])) for c in imposed)


def polynomials(spec: PlanarBeam) -> tuple[Polynomial, ...]:
    """The ansatz of a beam; none if it has a family of shapes."""
    return () if isinstance(spec.ansatz, ShapeFamily) else spec.ansatz


def removed(spec: PlanarBeam) -> tuple[int, ...]:
    """The terms of the ansatz that the conditions eliminate."""
    results = on_ansatz(spec)
    return tuple(sp.Matrix([list(item.factors) for item in results]).rref()[1]) if results else ()


def of_paper(spec: PlanarBeam) -> bool:
    """Whether the ansatz of a beam is the cubic of the paper."""
    return spec.ends is None and polynomials(spec) == tuple((0,) * k + (1,) for k in range(4))


def paper_numbers(spec: PlanarBeam) -> PaperNumbers | None:
    """The numbers of the paper's equations for this beam; None if the paper does not have this beam."""
    if not of_paper(spec) or spec.gravity is not None or spec.masses or spec.damping or spec.axial:
        return None
    if spec.frame.kind == "mean":
        return MEAN
    return POINT if spec.frame.kind == "point" and spec.frame.at == 0 else None


OF_THE_BEAM = (
    "Shapes and conditions are those of the beam without its attached masses. These add to the shape integrals: some "
    "that vanish for the beam alone do not, and couple what is uncoupled in the mass matrix without the masses."
)


def frame_blocks(spec: PlanarBeam) -> tuple[Block, ...]:
    """The blocks of the frame of a beam, from its ansatz to its assumed shapes."""
    numbers = paper_numbers(spec)
    lines = shape_equations(spec)
    shapes = len(lines)
    if isinstance(spec.ansatz, ShapeFamily):
        fulfilled = EquationBlock(tuple(map(condition_equation, conditions(spec.frame))))
        return (
            Heading("The frame and its shape functions", "frame"),
            Paragraph((FRAMES[spec.frame.kind], FAMILIES[spec.ansatz.kind])),
            *((Paragraph(("They fulfil the conditions of the frame:",)), fulfilled) if fulfilled.rows else ()),
            Paragraph((f"With {shapes} of them, from that of the lowest frequency on, the deflection is",)),
            EquationBlock((equation(DEFLECTION, scalars=True), *lines)),
        )
    return (
        Heading("The frame and what it removes", "frame"),
        Paragraph((FRAMES[spec.frame.kind], ENDS[spec.ends], " The deflection starts as")),
        EquationBlock((ansatz_equation(spec),)),
        *_conditions(spec),
        *((Paragraph((OF_THE_BEAM,)),) if spec.masses else ()),
        Paragraph(_left(spec, shapes)),
        EquationBlock((equation(DEFLECTION, scalars=True, number=numbers.deflection if numbers else ""), *lines)),
    )


def beam_subtitle(spec: PlanarBeam) -> Text:
    """A beam in a line: its frame and its assumed modes."""
    shapes = assumed_shapes(spec.deflection)
    text: list[Inline] = [f"free planar beam, {spec.frame.kind} frame, "]
    if len(shapes) > LISTED or isinstance(spec.ansatz, ShapeFamily):
        return (*text, f"{len(shapes)} assumed modes")
    text.append("assumed mode " if len(shapes) == 1 else "assumed modes ")
    for k, shape in enumerate(shapes):
        text += [" and " if k + 1 == len(shapes) else ", "] if k else []
        text.append(Math(join(beam_function(shape))))
    return tuple(text)


def shape_equations(spec: PlanarBeam) -> tuple[Equation, ...]:
    """The assumed shapes of a beam."""
    numbers = paper_numbers(spec)
    return tuple(
        Equation(shape_name(str(k)), beam_function(shape), number=numbers.shapes[k - 1] if numbers else "")
        for k, shape in enumerate(assumed_shapes(spec.deflection), 1)
    )


def ansatz_equation(spec: PlanarBeam) -> Equation:
    """The deflection of a beam before its conditions are imposed."""
    return Equation(Name("v"), _ansatz(polynomials(spec)), number="21" if of_paper(spec) else "")


def _conditions(spec: PlanarBeam) -> tuple[Block, ...]:
    lines = [line for item in on_ansatz(spec) for line in (condition_equation(item.condition), item.equation)]
    if numbers := paper_numbers(spec):
        lines[1::2] = (replace(line, number=n) for line, n in zip(lines[1::2], numbers.conditions, strict=True))
    words = "These are its conditions, each followed by the equation that it imposes on the ansatz:"
    return (Paragraph((words,)), EquationBlock(tuple(lines))) if lines else ()


def condition_equation(condition: Condition) -> Equation:
    """A condition with its number in the paper."""
    return Equation(condition_formula(condition), ZERO, number=condition.equation.strip("()"))


def condition_formula(condition: Condition) -> Formula:
    """The left-hand side of a condition: the integral of xi v, or v' at a point."""
    match condition:
        case MeanCondition(power):
            factors = "xi " * power
            return formula(f"int_{{-1}}^1 {factors}v dxi", scalars=True)
        case PointCondition(order, at):
            primes = [OperatorToken("\N{PRIME}")] * order
            return FormulaRow((Name("v"), *primes, Fenced(number(rational(at)))))
        case _:
            assert_never(condition)


def _left(spec: PlanarBeam, shapes: int) -> tuple[Inline, ...]:
    gone = removed(spec)
    words: list[Inline] = []
    if gone:
        words.append(f"The conditions eliminate {len(gone)} of the {len(polynomials(spec))} terms of the ansatz: ")
        for k, j in enumerate(gone):
            words += [" and "] if k else []
            words.append(Math(_a(j)))
        words.append(" follow from the others. ")
    words.append(f"{shapes} {'shapes are' if shapes > 1 else 'shape is'} left, scaled to one at the right end")
    if spec.orthogonal:
        words.append(", each made orthogonal to those before it in the mass of the beam")
    words.append(":")
    return tuple(words)


def _ansatz(terms: tuple[Polynomial, ...]) -> tuple[Part, ...]:
    parts = []
    for j, term in enumerate(terms):
        own = polynomial_of(term)
        plain = len(own) == 1 and own[0].sign == "+"
        factor: list[Formula] = [own[0].formula] if plain else [Fenced(join(own))]
        parts.append(Part("+", row([_a(j), *([] if plain and own[0].formula == NumberToken("1") else factor)])))
    return tuple(parts)


def _a(j: int) -> Name:
    return Name("a", below=(str(j),))


def _whole(values: list[sp.Rational]) -> tuple[int, ...]:
    """Numbers in the same proportions, whole, without a common divisor, the first of them positive."""
    scaled = [v * sp.ilcm(1, *(x.q for x in values)) for v in values]
    divisor = sp.igcd(*scaled) or 1
    first = next((v for v in scaled if v), 1)
    return tuple(int(v / divisor * (-1 if first < 0 else 1)) for v in scaled)


MEAN_OF_MODES = "The frame follows the mean motion: no mode displaces the body or turns it on average."
GIVEN_MODES = "The modes are used as they are given; no condition is imposed on them."


def node_frame_blocks(spec: NodalBody) -> tuple[Block, ...]:
    """The conditions on the modes of a body of nodes, and by how much the given modes violated them."""
    return (*mode_frame_blocks(spec.frame), *_residuals(spec), *_without_stiffness(spec))


def mode_frame_blocks(frame: BodyFrame) -> tuple[Block, ...]:
    """The conditions of a frame on the modes of a body in space."""
    results: list[Block] = [Heading("The frame and what it removes", "frame")]
    if frame.kind == "mean":
        results += [
            Paragraph((MEAN_OF_MODES,)),
            EquationBlock(
                (
                    equation("int_Omega rho Phi_i dOmega = 0", number="17"),
                    equation("int_Omega rho X >< Phi_i dOmega = 0", number="19"),
                )
            ),
        ]
    elif frame.kind == "point":
        words = (
            f"The frame is fixed to node {frame.node}: no mode displaces it, nor turns it and its neighbours on "
            "average."
        )
        results += [Paragraph((words,)), EquationBlock((equation("Phi_i(P_c) = 0", number="16"),))]
    else:
        results.append(Paragraph((GIVEN_MODES,)))
    return tuple(results)


def _without_stiffness(spec: NodalBody) -> list[Block]:
    """A warning where modes have no stiffness."""
    from derive.reduction import zero_stiffness_modes

    modes = ", ".join(map(str, zero_stiffness_modes(spec)))
    return [Paragraph((f"No stiffness in mode {modes}: is a part loose, or are elements missing?",))] if modes else []


def _residuals(spec: NodalBody) -> list[Block]:
    """A table of the residuals of the frame conditions, before and after the modes were brought to the frame."""
    from derive.reduction import residuals

    results = residuals(spec)
    rows: list[list[Content]] = [
        [
            "mean displacement of a mode, of its size (17)",
            *_both(results.before.displacement, results.after.displacement),
        ],
        ["mean rotation of a mode, of its size (19)", *_both(results.before.rotation, results.after.rotation)],
        ["distance of O from the centre of mass", *_both(results.before.centre, results.after.centre)],
    ]
    return [table("How far the modes are from the mean frame", ("", "as given", "as used"), rows, "lrr")]


def _both(before: float, after: float) -> tuple[NumberToken, NumberToken]:
    return NumberToken(f"{before:.1e}"), NumberToken(f"{after:.1e}")
