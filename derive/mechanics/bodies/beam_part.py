"""The inertia of the part of a beam to the right of a section: the rigid rows of its equations of motion.

The part moves with the fields of the whole beam, so that its equations are those of a body with the same shapes whose
mass is distributed over -1 < start <= xi <= 1 alone. The virtual work on its translations and on its rotation is the
force and the torque about O that its motion needs, besides its weight; at any order of the displacements.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.bodies.attached_masses import IntegralsWithMasses, LocatedMass, SecondOrderWithMasses
from derive.mechanics.bodies.beam_functions import LEFT, BeamFunction, rational
from derive.mechanics.bodies.beam_integrals import BY_CHANCE, BeamField, BeamIntegrals
from derive.mechanics.bodies.foreshortening import Foreshortening, field_weights
from derive.mechanics.bodies.planar_integrals import Value, coefficients, second_order_coefficients
from derive.mechanics.body import Body, planar_body
from derive.spec.model.beam_parts import Frame
from derive.spec.model.body import DisplacementOrder

if TYPE_CHECKING:
    from derive.mechanics.terms import ModelConstant


@dataclass(frozen=True)
class PartIntegrals(BeamIntegrals):
    """Moments over the part to the right of xi = `start`; `mass` is that of the whole beam."""

    start: Fraction = LEFT

    def _value(
        self, integrand: BeamFunction, factor: sp.Expr, reason: str | None = None, otherwise: str = BY_CHANCE
    ) -> Value:
        return _part_value(self.mass * factor, integrand, self.start)


@dataclass(frozen=True)
class PartForeshortening(Foreshortening):
    """The second-order fields with their moments over the part to the right of xi = `start`."""

    start: Fraction = LEFT

    def _value(self, integrand: BeamFunction, factor: sp.Expr, reason: str | None = None) -> Value:
        return _part_value(self.mass * factor, integrand, self.start)


def _part_value(factor: sp.Expr, integrand: BeamFunction, start: Fraction) -> Value:
    value = rational(integrand.integral(start))
    return Value(factor * value / 2, None if value else BY_CHANCE)


def part_body(
    shapes: tuple[BeamField, ...],
    frame: Frame,
    order: DisplacementOrder,
    mass: sp.Expr,
    length: sp.Expr,
    start: Fraction,
    gravity: tuple[ModelConstant, ...],
    masses: tuple[LocatedMass, ...] = (),
) -> Body:
    """The part to the right of xi = `start` of a beam with these fields, and the masses that are attached to it.

    mass (kg) and length (m) are those of the whole beam.
    """
    second = PartForeshortening(shapes, frame, mass, length, start)
    fields = tuple(c.field for c in second.combinations) if order is DisplacementOrder.FULL else ()
    family = (*shapes, *(BeamField(field, 1) for field in fields))
    of_fields = PartIntegrals(family, mass, length, False, start)
    constants = coefficients(IntegralsWithMasses(of_fields, masses), len(family))
    if order is DisplacementOrder.TRUNCATED:
        constants += second_order_coefficients(SecondOrderWithMasses(second, masses), constants, len(shapes))
    constants += field_weights(second) if fields else ()
    of_part = mass * rational(1 - start) / 2
    return planar_body(
        name="part",
        doc="the part of a beam to the right of a section",
        frame_doc="",
        modes=len(shapes),
        mass=sp.Add(of_part, *(m.mass for m in masses)),
        constants=constants,
        gravity=gravity,
        order=order,
        fields=len(fields),
    )
