"""A relative motion that a joint leaves a body, by its name: a displacement along an axis or a rotation about one."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from derive.algebra import zero
from derive.mechanics.multibody.space.rows import ROTATIONS

if TYPE_CHECKING:
    from derive.algebra import sp
    from derive.mechanics.multibody.point_motion import Derivatives
    from derive.mechanics.terms import Coordinate, EquationOfMotion

AXES_OF = {"x": 0, "y": 1, "z": 2, "rx": 0, "ry": 1, "rz": 2}


@dataclass(frozen=True)
class JointCoordinate:
    """A relative motion of a body behind a known marker: prescribed with its derivatives, or a coordinate.

    along: a displacement that goes with a rotation, by this factor of it, m/rad: that of a screw.
    """

    motion: str
    coordinate: Coordinate | None
    row: EquationOfMotion | None
    values: Derivatives
    along: sp.Expr = field(default_factory=zero)

    @property
    def is_rotation(self) -> bool:
        """Whether the motion is a rotation."""
        return self.motion in ROTATIONS
