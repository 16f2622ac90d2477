"""Rigid bodies that are fixed to sections of a beam in space.

Such a body moves as its section does, so that a field f = f_0 + sum_k f_k p_k of the section at xi is also its field.
Its moments int f g^T dm follow from those of 1 and p, as those of the sections do: m, m c and int p p^T dm, which is
(tr J/2) I - J + m c c^T for a body with the tensor of inertia J about its centre of mass c.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction

from derive.algebra import sp
from derive.mechanics import quantity
from derive.spec.model.spatial_beam_parts import SpatialAttachedMass


@dataclass(frozen=True)
class SectionMass:
    """The moments (4, 4) of 1 and the coordinates of p of a body on the section at xi = `at`."""

    at: Fraction
    moments: sp.ImmutableMatrix

    @property
    def mass(self) -> sp.Expr:
        """Its mass, kg."""
        return self.moments[0, 0]


def section_masses(masses: Iterable[SpatialAttachedMass]) -> Iterator[SectionMass]:
    """The moments of attached masses."""
    for m in masses:
        mass, centre = quantity.value(m.mass), sp.Matrix([quantity.value(x, positive=False) for x in m.centre])
        xx, yy, zz, xy, xz, yz = (quantity.value(x, positive=False) for x in m.inertia or (Fraction(0),) * 6)
        J = sp.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        second = J.trace() / 2 * sp.eye(3) - J + mass * centre * centre.T
        first = mass * centre
        moments = sp.Matrix([[mass]]).row_join(first.T).col_join(first.row_join(second))
        yield SectionMass(m.at, moments.as_immutable())
