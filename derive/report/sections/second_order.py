"""The kinematics of second order of a body: the fields Psi_ij, and which of their moments are kept."""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never

from derive.report.document.formula import Equation, FormulaRow, Name, OperatorToken, Part, Quotient
from derive.report.document.page import Block, EquationBlock, Heading, Paragraph
from derive.report.notation.beam_functions import shape_name
from derive.report.notation.formula_reader import equation, formula, marked_text
from derive.report.sections.section_second_order import section_fields_blocks
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import Frame
from derive.spec.model.beam_pieces import whole_beam
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.planar_bodies import BeamBody, SceneBody
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.specification import AnyScene

AnyBody = SceneBody | SpatialBody


def beam_second_order_blocks(spec: PlanarBeam) -> tuple[Block, ...]:
    """The displacement of second order of a beam, its derivative by an amplitude, and what the model keeps; marked as
    beyond the paper. Empty at first order."""
    return _second_order(spec.order, True, _constants([spec.frame]))


def space_second_order_blocks(order: DisplacementOrder) -> tuple[Block, ...]:
    """The second order of a body in space, whose fields are those of its nodes."""
    return _second_order(order, False, _geometric_stiffness())


def _second_order(order: DisplacementOrder, beams: bool, fields: tuple[Block, ...]) -> tuple[Block, ...]:
    if order is DisplacementOrder.FIRST_ORDER:
        return ()
    return (*_displacement("Beyond the paper: the displacement is", beams), *fields, *_kept("The model", order))


def scene_second_order_blocks(spec: AnyScene) -> tuple[Block, ...]:
    """The blocks of the bodies of a scene with displacements of second order; empty if there are none."""
    bodies = [body for body in map(_whole, spec.bodies) if _order(body) is not DisplacementOrder.FIRST_ORDER]
    bodies = list({body.name: body for body in bodies}.values())
    planar = [body for body in bodies if isinstance(body, BeamBody)]
    in_space = [body for body in bodies if isinstance(body, SpatialBeam)]
    if not bodies:
        return ()
    frames = [*(body.beam.frame for body in planar), *(body.frame for body in in_space)]
    by_order = {order: [body for body in bodies if _order(body) is order] for order in DisplacementOrder}
    return (
        Heading("Displacements of second order", "second_order"),
        *_displacement(f"Beyond the paper: the displacement of {_names(bodies)} is", bool(frames), bool(planar)),
        *(section_fields_blocks(in_space) if in_space else ()),
        *(_constants(list(dict.fromkeys(frames))) if frames else ()),
        *(_geometric_stiffness() if any(isinstance(body, FlexibleBody) for body in bodies) else ()),
        *(
            block
            for order, some in by_order.items()
            if some
            for block in _kept(f"The model of {_names(some)}", order, sections=not planar)
        ),
    )


def _whole(body: AnyBody) -> AnyBody:
    """The beam that a piece of a beam in space belongs to; another body itself."""
    return whole_beam(body) if isinstance(body, SpatialBeam) else body


def _order(body: AnyBody) -> DisplacementOrder:
    match body:
        case BeamBody():
            return body.beam.order
        case SpatialBeam():
            return body.order
        case FlexibleBody():
            return body.body.order
        case _:
            return DisplacementOrder.FIRST_ORDER


def _names(bodies: Sequence[AnyBody]) -> str:
    return ", ".join(body.name for body in bodies)


def _displacement(subject: str, beams: bool, in_plane: bool = True) -> tuple[Block, ...]:
    """The displacement, its derivative by an amplitude, and the Psi_ij of planar beams."""
    return (
        Paragraph(
            (
                f"{subject} of second order in the amplitudes",
                "; a beam that bends and does not stretch gets shorter. " if beams else ". ",
                *marked_text(
                    "In (6), in the rates of $r$ and in the equations of motion, the derivative of $r$ by an amplitude "
                    "takes the place of $Phi_i$; at a marker its component k is "
                ),
                *marked_text("$r_{k,i}$:", scalars=True),
            )
        ),
        EquationBlock(
            (
                equation("u = sum_i alpha_i Phi_i + 1/2 sum_{i j} alpha_i alpha_j Psi_{i j}"),
                equation("partial r / partial alpha_i = Phi_i + sum_j alpha_j Psi_{i j}"),
                *((_shortening(),) if beams and in_plane else ()),
            )
        ),
    )


def _shortening() -> Equation:
    """Psi_ij of a beam, from the slopes of its shapes."""

    def slope(index: str) -> Quotient:
        below = FormulaRow((OperatorToken("d"), Name("x")))
        return Quotient(FormulaRow((OperatorToken("d"), shape_name(index))), below)

    integral = (Name("∫"), slope("i"), slope("j"), OperatorToken("d"), Name("x"), formula("e_1"))
    return Equation(formula("Psi_{i j}"), (Part("-", FormulaRow(integral)),))


def _constants(frames: Sequence[Frame]) -> tuple[Block, ...]:
    """The constants of integration that the frames determine."""
    text = "; ".join(f"in the {frame.kind} frame {_condition(frame)}" for frame in frames)
    return (Paragraph((f"The constant of integration follows from the condition of the frame: {text}.",)),)


def _condition(frame: Frame) -> str:
    match frame.kind:
        case "mean":
            return "the mean of the displacement vanishes, (17)"
        case "point" | "tangent":
            return f"the displacement vanishes at xi = {frame.at or 0}, (16)"
        case "chord":
            return "the displacements of both ends along the axis are opposite"
        case "given":
            return "the displacement vanishes in the middle"
        case _ as never:
            assert_never(never)


def _geometric_stiffness() -> tuple[Block, ...]:
    """The correspondence of the geometric stiffness matrices of a body in space to integrals of the equations."""
    text = (
        "The fields of second order are given by geometric stiffness matrices of the modes under unit loads: K0t under "
        "accelerations is $c_9$, K0r under angular accelerations is $c_10$, K0omega under spin is the part of $X$ and "
        "$Psi_{i j}$ in $C_5$, and K0F under a force at a node is the displacement $Psi_{i j}$ there with its sign "
        "changed. In the equation of an amplitude they are in the terms translation and gravity (K0t), Euler (K0r) and "
        "centrifugal (K0omega)."
    )
    return (Paragraph(marked_text(text)),)


def _kept(model: str, order: DisplacementOrder, sections: bool = False) -> tuple[Block, ...]:
    """Return what a model keeps; sections: whether fields of second order turn sections, as of beams in space."""
    match order:
        case DisplacementOrder.FIRST_ORDER:
            return ()
        case DisplacementOrder.TRUNCATED:
            text = (
                f"{model} is truncated: kinetic and potential energy are kept through second order in the amplitudes "
                "and their rates, for any rigid motion. Moments of these fields with each other and with the shapes "
                "are left out; points have their full displacement. What is of second order is marked so below."
            )
            return (Paragraph((text,)),)
        case DisplacementOrder.FULL:
            turning = ", and of fields that turn sections" if sections else ""
            text = (
                f"{model} is full: nothing of this displacement is left out. The fields of second order are "
                "combinations of fields along the axis: the Legendre polynomials, if all shapes are polynomials, "
                f"otherwise the fields of second order themselves{turning}. Their amplitudes depend on those of the "
                "shapes. They are numbered behind the shapes, so that the integrals are those of one larger family."
            )
            fields = (
                equation(f"Psi_{{i j}} = sum_p z_{{p i j}} theta_p{'' if sections else ' e_1'}"),
                equation("beta_p = 1/2 sum_{i j} z_{p i j} alpha_i alpha_j", scalars=True),
                equation("beta_{p,i} = partial beta_p / partial alpha_i = sum_j z_{p i j} alpha_j", scalars=True),
                equation("beta''_p = sum_i beta_{p,i} alpha''_i + beta''_p^0", scalars=True),
                equation("beta''_p^0 = sum_{i j} z_{p i j} alpha'_i alpha'_j", scalars=True),
            )
            return (Paragraph((text,)), EquationBlock(fields))
        case _ as never:
            assert_never(never)
