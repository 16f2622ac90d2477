"""The inertia of the part of a beam in space to the right of a section: the rigid rows of its equations of motion.

The part moves with the fields of the whole beam, so that its equations are those of a body with the same shapes whose
mass is distributed over -1 < start <= xi <= 1 alone. See `beam_part` of planar beams.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.bodies.section_fields import section_shapes
from derive.mechanics.bodies.section_inertia import section_inertia
from derive.mechanics.body import Body, ExactValues
from derive.mechanics.expansion import rigid_rows
from derive.mechanics.tables import exact_tables

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

    It has no stiffness and no damping. The rows contain the rotation tensor by its symbols.
    """
    body = _part(beam, start, gravity)
    return body, rigid_rows(body, tuple(body.motion.rotation))


def _part(beam: SpatialBeam, start: Fraction, gravity: tuple[ModelConstant, ...]) -> Body:
    inertia = section_inertia(beam, start)
    return Body(
        name="part",
        doc="the part of a beam to the right of a section",
        frame_doc="",
        dimension=3,
        modes=len(section_shapes(beam)),
        mass=inertia.mass,
        tables=exact_tables(inertia.constants, inertia.docs, 3),
        values=ExactValues(inertia.constants),
        gravity=gravity,
        order=beam.order,
        fields=inertia.fields,
    )
