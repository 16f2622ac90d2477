"""The kinematics of a body: (1), (5), (6), (14), and what they are in its coordinates."""

from __future__ import annotations

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.equations import Equations
from derive.mechanics.motion.kinematics import ONE, PHI, RDDOT, RDOT, Field, R, add
from derive.mechanics.motion.material_points import vector_at
from derive.mechanics.motion.planar import planar_motion
from derive.mechanics.motion.spatial import spatial_motion
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
from derive.report.document.page import Block, EquationBlock, Heading, Math, Paragraph
from derive.report.notation.expressions import Notation, base, row
from derive.report.notation.formula_reader import equation, formula, marked_text
from derive.report.notation.vector_form import DELTA_ALPHA, arrow, summands
from derive.report.sections.second_order import beam_second_order_blocks, space_second_order_blocks
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.body import DisplacementOrder

MOTION = spatial_motion(0)
AT = {R: arrow("r"), RDOT: arrow("rdot"), RDDOT: arrow("rddot"), PHI: arrow("Phi_i")}


def position() -> Equation:
    """The position x of a material point, from the field of the positions."""
    return Equation(formula("x"), summands(vector_at(MOTION, MOTION.position, AT)), number="1")


def acceleration() -> Equation:
    """The acceleration: the field of the positions, differentiated twice."""
    return Equation(formula("x''"), summands(vector_at(MOTION, MOTION.acceleration, AT)), number="5")


def virtual_displacement() -> Equation:
    """The virtual displacement: the velocity with the rates varied."""
    fields: list[Field] = []
    for amounts, units in (("delta_c", MOTION.translations), ("delta_pi", MOTION.frame.rotations())):
        for amount, unit in zip(arrow(amounts), units, strict=True):
            fields.append({name: amount * tensor for name, tensor in unit.items()})
    fields.append({name: DELTA_ALPHA * tensor for name, tensor in MOTION.frame.deformation().items()})
    return Equation(formula("delta x"), summands(vector_at(MOTION, add(*fields), AT)), number="6")


def beam_kinematics_blocks(spec: PlanarBeam, notation: Notation) -> tuple[Block, ...]:
    """The kinematics of a planar beam."""
    origin = Paragraph(marked_text("$c$ is the position of the centre of the undeformed beam."))
    return (*_kinematics(), *beam_second_order_blocks(spec), *_beam(spec, notation), origin)


def space_kinematics_blocks(equations: Equations, notation: Notation) -> tuple[Block, ...]:
    """The kinematics of a body in space."""
    order = equations.body.order if equations.body else DisplacementOrder.FIRST_ORDER
    origin = (Paragraph((equations.frame_doc,)),) if equations.frame_doc else ()
    return (*_kinematics(), *space_second_order_blocks(order), *_space(equations, notation), *origin)


def _kinematics() -> tuple[Block, ...]:
    """From the position of a material point to its acceleration and its virtual displacement."""
    return (
        Heading("Kinematics", "kinematics"),
        Paragraph(
            marked_text(
                "The deformation displaces a material point by $u$ from its position $X$ in the reference "
                "configuration; the floating frame then rotates it by $Q$ and translates it by $c$. Two time "
                "derivatives give its acceleration, and the variation gives its virtual displacement."
            )
        ),
        EquationBlock(
            (
                position(),
                equation("r = X + u"),
                equation("u = sum_i alpha_i Phi_i", number="14"),
                acceleration(),
                virtual_displacement(),
            )
        ),
    )


def _beam(spec: PlanarBeam, notation: Notation) -> tuple[Block, ...]:
    """The blocks of (23)-(27) for a beam, and its acceleration in components."""
    length = notation.formula(quantity.value(spec.length))
    xi = Name("xi")
    along = FormulaRow((Quotient(NumberToken("1"), NumberToken("2")), xi, length, base(1)))
    motion = planar_motion(0)
    turning, coriolis, relative = (motion.acceleration[field] for field in (R, RDOT, RDDOT))
    assert relative == sp.eye(2)
    summands = (
        formula("c''"),
        _rotated(notation.matrix(turning), formula("r")),
        _rotated(notation.matrix(coriolis), formula("r'")),
        _rotated(formula("r''")),
    )
    components = Equation(formula("x''"), tuple(Part("+", summand) for summand in summands))
    return (
        Paragraph(("The beam moves in a plane and deflects across its axis:",)),
        EquationBlock(
            (
                Equation(formula("c"), notation.vector(motion.position[ONE]), number="23"),
                Equation(formula("X"), (Part("+", along),), number="24"),
                _linear_displacement(spec),
                Equation(formula("Q"), (Part("+", notation.matrix(motion.rotation)),), number="26", anchor="def-Q"),
                Equation(formula("omega"), (Part("+", FormulaRow((Name("phi", dots=1), base(3)))),), number="27"),
                components,
            )
        ),
    )


def _linear_displacement(spec: PlanarBeam) -> Equation:
    """(25), and beyond the paper the displacement along the axis; of second order, what is linear in the amplitudes."""
    first_order = spec.order is DisplacementOrder.FIRST_ORDER
    left = formula("u") if first_order else formula("sum_i alpha_i Phi_i")
    stretching = (Part("+", formula("sum_k alpha_k chi_k e_1")),) if spec.axial else ()
    return Equation(left, (Part("+", FormulaRow((Name("v"), base(2)))), *stretching), number="25")


def _rotated(*factors: Formula) -> Formula:
    """The product of Q and further factors."""
    return FormulaRow((formula("Q"), OperatorToken("·"), *factors))


def _space(equations: Equations, notation: Notation) -> tuple[Block, ...]:
    """Q by a unit quaternion, and how that changes with omega."""
    entries = [d.expr for d in equations.definitions if d.section == "Q"]
    rotation = sp.Matrix(3, 3, entries)
    rates = [
        Equation(Name("e", dots=1, below=(str(k),)), notation.parts(rate))
        for k, rate in enumerate(equations.rates[3:7])
    ]
    unit = row([*(p for k in range(4) for p in ([OperatorToken("+")] if k else []) + [_squared(k)])])
    return (
        Paragraph(
            (
                "The rotation is that of a unit quaternion, ",
                Math(unit),
                Math(FormulaRow((OperatorToken("="), NumberToken("1")))),
                "; the angular velocity and the virtual rotation are resolved in the floating frame.",
            )
        ),
        EquationBlock((Equation(formula("Q"), (Part("+", notation.matrix(rotation)),), anchor="def-Q"), *rates)),
    )


def _squared(k: int) -> Formula:
    return Power(Name("e", below=(str(k),)), NumberToken("2"))
