"""What second order adds to the kinematics of a body: the fields Psi_ij, and which of their moments are kept."""

from __future__ import annotations

from typing import assert_never

from derive.report.document.page import Block, EquationBlock, Math, Paragraph
from derive.report.notation.formula_reader import equation, formula
from derive.spec.model.body import DisplacementOrder, NodalBody, PlanarBeam
from derive.spec.model.scene import Specification


def second_order_blocks(spec: Specification, order: DisplacementOrder) -> tuple[Block, ...]:
    """The displacement of second order, its derivative by an amplitude, and what the model keeps; marked as beyond
    the paper. Empty at first order."""
    if order is DisplacementOrder.FIRST_ORDER:
        return ()
    beam = isinstance(spec, PlanarBeam)
    shortening = (equation("Psi_{ij} = - 2/l int phi_i^' phi_j^' dxi e_1"),) if beam else ()
    return (
        Paragraph(
            (
                "Beyond the paper: the displacement is of second order in the amplitudes",
                "; a beam that bends and does not stretch gets shorter. " if beam else ". ",
                "In (6), in the rates of ",
                Math(formula("r")),
                " and in the equations of motion, the derivative of ",
                Math(formula("r")),
                " by an amplitude takes the place of ",
                Math(formula("Phi_i")),
                ":",
            )
        ),
        EquationBlock(
            (
                equation("u = sum_i alpha_i Phi_i + 1/2 sum_{ij} alpha_i alpha_j Psi_{ij}"),
                equation("partial r / partial alpha_i = Phi_i + sum_j alpha_j Psi_{ij}"),
                *shortening,
            )
        ),
        *(_geometric_stiffness() if isinstance(spec, NodalBody) else ()),
        *_kept(order),
    )


def _geometric_stiffness() -> tuple[Block, ...]:
    """What the geometric stiffness matrices of a body in space are in the equations."""
    return (
        Paragraph(
            (
                "The fields of second order are given by geometric stiffness matrices of the modes under unit loads: "
                "K0t under accelerations is ",
                Math(formula("c_9")),
                ", K0r under angular accelerations is ",
                Math(formula("c_10")),
                ", K0omega under spin is the part of ",
                Math(formula("X")),
                " and ",
                Math(formula("Psi_{ij}")),
                " in ",
                Math(formula("C_5")),
                ", and K0F under a force at a node is the displacement ",
                Math(formula("Psi_{ij}")),
                " there with its sign changed. In the equation of an amplitude they are in the terms translation and "
                "gravity (K0t), Euler (K0r) and centrifugal (K0omega).",
            )
        ),
    )


def _kept(order: DisplacementOrder) -> tuple[Block, ...]:
    match order:
        case DisplacementOrder.FIRST_ORDER:
            return ()
        case DisplacementOrder.TRUNCATED:
            text = (
                "The model is truncated: kinetic and potential energy are kept through second order in the amplitudes "
                "and their rates, for any rigid motion. Moments of these fields with each other and with the shapes "
                "are left out; points have their full displacement. What is of second order is marked so below."
            )
            return (Paragraph((text,)),)
        case DisplacementOrder.FULL:
            text = (
                "The model is full: nothing of this displacement is left out. The fields of second order are "
                "combinations of fields that are orthogonal to each other, with amplitudes that depend on those of the "
                "shapes. These are numbered behind the shapes, so that the integrals are those of one larger family."
            )
            fields = (
                equation("Psi_{ij} = sum_p z_{pij} theta_p", scalars=True),
                equation("beta_p = 1/2 sum_{ij} z_{pij} alpha_i alpha_j", scalars=True),
            )
            return (Paragraph((text,)), EquationBlock(fields))
        case _ as never:
            assert_never(never)
