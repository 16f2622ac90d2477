"""The inertia of a beam in space, or of its part to the right of a section: mass, shape integrals, fields."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.bodies.beam_functions import LEFT, RIGHT, rational
from derive.mechanics.bodies.section_family import family_weights, second_order_family
from derive.mechanics.bodies.section_fields import section_shapes
from derive.mechanics.bodies.section_masses import section_masses
from derive.mechanics.bodies.section_moments import SectionMoments
from derive.mechanics.bodies.spatial_tables import DOCS, SECOND_ORDER_DOCS
from derive.mechanics.symbols import Family
from derive.mechanics.tables import PLANAR_DOCS
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.spatial_beam import cut_into

if TYPE_CHECKING:
    from derive.mechanics.terms import ModelConstant
    from derive.spec.model.spatial_beam import SpatialBeam


DOCS_OF = {
    DisplacementOrder.FIRST_ORDER: DOCS,
    DisplacementOrder.TRUNCATED: SECOND_ORDER_DOCS,
    DisplacementOrder.FULL: {**DOCS, Family.FIELD_WEIGHT: PLANAR_DOCS[Family.FIELD_WEIGHT]},
}
"""The descriptions and the units of the tables of each order."""


@dataclass(frozen=True)
class SectionInertia:
    """The mass (kg), the shape integrals with their descriptions and units, and the number of the fields theta_p."""

    mass: sp.Expr
    constants: tuple[ModelConstant, ...]
    docs: Mapping[Family, tuple[str, str]]
    fields: int


def section_inertia(beam: SpatialBeam, start: Fraction = LEFT) -> SectionInertia:
    """The inertia of the part of a beam, or of a piece of one, to the right of xi = `start`.

    Masses at the section itself belong to the left part, but for those at the ends. Raises ConditionError when the
    ansatz does not fit the frame.
    """
    shapes, n, length = section_shapes(beam), cut_into(beam), length_of(beam)
    mass, inertia = quantity.value(beam.mass) / n, quantity.value(beam.rotary_inertia) / n
    masses = tuple(m for m in section_masses(beam.masses) if m.at > start or m.at == RIGHT or start == LEFT)
    full = beam.order is DisplacementOrder.FULL
    family = second_order_family(shapes, beam.frame, length) if full else ()
    further = tuple(member.field for member in family)
    moments = SectionMoments(beam, shapes, mass, length, inertia, masses, start, further)
    return SectionInertia(
        mass=sp.Add(mass * rational(1 - start) / 2, *(m.mass for m in masses)),
        constants=(*moments.constants(), *family_weights(family, len(shapes), length)),
        docs=DOCS_OF[beam.order],
        fields=len(family),
    )


def length_of(beam: SpatialBeam) -> sp.Expr:
    """The length of a beam, or of a piece of one, m."""
    return quantity.value(beam.length) / cut_into(beam)
