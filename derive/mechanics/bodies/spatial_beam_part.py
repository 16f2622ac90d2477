"""The inertia of the part of a beam in space to the right of a section: the rigid rows of its equations of motion.

The part moves with the fields of the whole beam, so that its equations are those of a body with the same shapes whose
mass is distributed over -1 < start <= xi <= 1 alone. See `beam_part` of planar beams.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.bodies.beam_functions import RIGHT, rational
from derive.mechanics.bodies.section_fields import section_shapes
from derive.mechanics.bodies.section_masses import section_masses
from derive.mechanics.bodies.section_moments import SectionMoments
from derive.mechanics.bodies.spatial_beam import length_of
from derive.mechanics.bodies.spatial_tables import DOCS, SECOND_ORDER_DOCS
from derive.mechanics.body import Body, ExactValues
from derive.mechanics.expansion import rigid_rows
from derive.mechanics.tables import exact_tables
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.spatial_beam import cut_into

if TYPE_CHECKING:
    from derive.mechanics.terms import ModelConstant
    from derive.spec.model.spatial_beam import SpatialBeam


KEPT = 64
"""The number of parts that are kept, since a section has several outputs."""


@lru_cache(KEPT)
def spatial_part(
    beam: SpatialBeam, start: Fraction, gravity: tuple[ModelConstant, ...]
) -> tuple[Body, tuple[sp.Expr, ...]]:
    """The part of a beam, or of a piece of one, to the right of xi = `start`, and its rigid rows.

    Masses at the section itself belong to the left part, but for those at the right end.

    It has no stiffness and no damping. The rows contain the rotation tensor by its symbols.
    """
    body = _part(beam, start, gravity)
    return body, rigid_rows(body, tuple(body.motion.rotation))


def _part(beam: SpatialBeam, start: Fraction, gravity: tuple[ModelConstant, ...]) -> Body:
    shapes = section_shapes(beam)
    n = cut_into(beam)
    mass, inertia = quantity.value(beam.mass) / n, quantity.value(beam.rotary_inertia) / n
    masses = tuple(m for m in section_masses(beam.masses) if m.at > start or m.at == RIGHT)
    constants = tuple(SectionMoments(beam, shapes, mass, length_of(beam), inertia, masses, start).constants())
    docs = DOCS if beam.order is DisplacementOrder.FIRST_ORDER else SECOND_ORDER_DOCS
    return Body(
        name="part",
        doc="the part of a beam to the right of a section",
        frame_doc="",
        dimension=3,
        modes=len(shapes),
        mass=sp.Add(mass * rational(1 - start) / 2, *(m.mass for m in masses)),
        tables=exact_tables(constants, docs, 3),
        values=ExactValues(constants),
        gravity=gravity,
        order=beam.order,
    )
