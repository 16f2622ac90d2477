"""The displacement fields of a beam: its shape functions across the axis and, if it stretches, those along the axis.

A beam that stretches has the displacement u = sum alpha_k chi_k(xi) e1 besides its deflection. At second order the
psi_ij of `foreshortening` come to it, with psi_ij' = -(2/l) phi_i' phi_j', so that the strain of the axis is

    epsilon = du/dx + 1/2 (dv/dx)^2 = sum alpha_k dchi_k/dx

through second order: bending and stretching are coupled by the kinematics alone, and the strain energy is quadratic.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache

from derive.mechanics.bodies.beam_functions import LEFT, NOTHING, ONE, RIGHT, BeamFunction, Real, polynomial
from derive.mechanics.bodies.beam_integrals import BeamField
from derive.mechanics.bodies.reference_conditions import (
    ConditionError,
    assumed_shapes,
    dependencies,
    normalised,
    orthogonalised,
)
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import Frame, Polynomial

MIDDLE = Fraction(0)


def displacement_fields(beam: PlanarBeam) -> tuple[BeamField, ...]:
    """The fields in the order of their amplitudes: first the shapes of bending, then those of stretching.

    Raises ConditionError when an ansatz does not fit the frame.
    """
    bending = (BeamField(shape, 2) for shape in assumed_shapes(beam.deflection))
    return (*bending, *(BeamField(shape, 1) for shape in stretching_shapes(beam)))


def stretching_shapes(beam: PlanarBeam) -> tuple[BeamFunction, ...]:
    """The shapes chi_k(xi) of stretching; empty without stretching. Raises ConditionError, see `axial_shapes`."""
    return axial_shapes(beam.axial.ansatz, beam.frame, beam.orthogonal) if beam.axial else ()


@cache
def axial_shapes(ansatz: tuple[Polynomial, ...], frame: Frame, orthogonal: bool) -> tuple[BeamFunction, ...]:
    """The polynomials of an axial ansatz, each less the constant that the frame removes, scaled to one at xi = 1.

    A translation along the axis is left out. Raises ConditionError when the others are linearly dependent, or when
    there are none.
    """
    polynomials = [p for p in map(polynomial, ansatz) if not p.derivative().is_zero]
    if not polynomials:
        raise ConditionError(["the axial ansatz holds nothing but a translation; add xi"])
    dependent = dependencies([ONE, *polynomials])
    if dependent:
        raise ConditionError(
            f"the axial ansatz is linearly dependent, together with the translation 1: {d} = 0; leave one out"
            for d in dependent
        )
    shapes = [without_translation(p, frame) for p in polynomials]
    return tuple(map(normalised, orthogonalised(shapes) if orthogonal else shapes))


def without_translation(displacement: BeamFunction, frame: Frame) -> BeamFunction:
    """A displacement along the axis less the constant that the condition of the frame takes away.

    Its mean vanishes (17), or it vanishes at the point of the frame (16), in a given frame in the middle; at the ends
    of a chord it is opposite, so that c, the centre of the undeformed beam, is the middle of the chord.
    """
    return displacement - ONE.scaled(_constant(displacement, frame))


def _constant(displacement: BeamFunction, frame: Frame) -> Real:
    match frame.kind:
        case "mean":
            return displacement.integral() / 2
        case "point" | "tangent":
            return displacement.at(frame.at or MIDDLE)
        case "chord":
            return (displacement.at(LEFT) + displacement.at(RIGHT)) / 2
        case "given":
            return displacement.at(MIDDLE)


def shortening(first: BeamField, second: BeamField, frame: Frame) -> BeamFunction:
    """The psi_ij length/2 of two fields, -int phi_i' phi_j' dxi with the condition of the frame; 0 for stretching."""
    if first.axis == 1 or second.axis == 1:
        return NOTHING
    primitive = -(first.of.derivative() * second.of.derivative()).antiderivative()
    return without_translation(primitive, frame)
