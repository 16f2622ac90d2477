"""The fields theta_p of the full model of a beam in space, of which its fields of second order are combinations.

    Psi_ij = sum z_pij theta_p,

where some theta_p are displacements of the axis, Legendre polynomials of xi along e1 if the shapes are polynomials, and
the others turn the sections as two shapes do together.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.bodies.beam_functions import Real, rational
from derive.mechanics.bodies.foreshortening import NO_PART, combinations_of
from derive.mechanics.bodies.section_fields import SectionField, SectionShape, second_field
from derive.mechanics.motion.full_second_order import field_weight
from derive.mechanics.symbols import Family
from derive.mechanics.tables import PLANAR_DOCS
from derive.mechanics.terms import ModelConstant
from derive.roles import Source

if TYPE_CHECKING:
    from derive.spec.model.beam_parts import Frame

AXIS = (1, 0)
"""The slot of displacements along the axis."""


@dataclass(frozen=True)
class FamilyMember:
    """A field theta_p, and its weights in the fields Psi_ij length/2, by i <= j; missing weights vanish."""

    field: SectionField
    weights: Mapping[tuple[int, int], Real]


def second_order_family(shapes: tuple[SectionShape, ...], frame: Frame, length: sp.Expr) -> tuple[FamilyMember, ...]:
    """The fields theta_p of some shapes: those along the axis, then those that turn sections."""
    pairs = combinations_with_replacement(enumerate(shapes, 1), 2)
    every = {(i, j): second_field(first, second, frame, length).slots for (i, first), (j, second) in pairs}
    along = combinations_of({pair: slots[AXIS] for pair, slots in every.items() if AXIS in slots})
    turning = {pair: {slot: of for slot, of in slots.items() if slot != AXIS} for pair, slots in every.items()}
    return (
        *(FamilyMember(SectionField({AXIS: of.field}, sp.S.One, 2 / length), of.weights) for of in along),
        *(
            FamilyMember(SectionField(slots, sp.S.One, 2 / length), {pair: Fraction(1)})
            for pair, slots in turning.items()
            if slots
        ),
    )


def family_weights(family: tuple[FamilyMember, ...], n: int, length: sp.Expr) -> Iterator[ModelConstant]:
    """The weights z_pij of n shapes, with the reason of those that vanish."""
    doc, unit = PLANAR_DOCS[Family.FIELD_WEIGHT]
    for p, member in enumerate(family, 1):
        for pair in combinations_with_replacement(range(1, n + 1), 2):
            value = 2 / length * rational(member.weights.get(pair, Fraction(0)))
            zero = None if value else NO_PART
            yield ModelConstant(field_weight(p, *pair), value, Source.SECOND_ORDER, doc, unit, zero)
