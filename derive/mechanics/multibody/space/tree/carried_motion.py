"""The motion of a rigid body in a tree of joints, in the coordinates of its own joint and of the joints before it.

With x the position of its origin O and w its angular velocity, both in the inertial frame,

    xdot = sum_j T_j v_j,   w = sum_j e_j v_j,   xddot = sum_j T_j vdot_j + a,   wdot = sum_j e_j vdot_j + alpha,

where the sums run over all velocities v_j that move the body. T_j and e_j are the translation and the rotation by a
unit virtual displacement, which d'Alembert's principle needs; they follow those of the body before it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.axes import AXES
from derive.mechanics.motion.products import product
from derive.mechanics.motion.vectors import cross
from derive.mechanics.multibody.space.frame_motion import FrameMotion, VirtualMotion
from derive.mechanics.quantity import rounded
from derive.mechanics.symbols import Family, Identity
from derive.mechanics.terms import EquationOfMotion, Intermediate

if TYPE_CHECKING:
    from derive.mechanics.multibody.bodies.body_type import CrossSection
    from derive.mechanics.multibody.space.joint_coordinate import JointCoordinate

Rows = tuple[EquationOfMotion, ...]


@dataclass(frozen=True)
class Hinge:
    """The joint that carries a body of a tree, as a motion relative to the body before it.

    known: the motion of the marker that carries it. place, axes: the position (3, 1) and the axes (3, 3) of that marker
    in the frame of its body; of the inertial frame at the root of a tree. own_axes: the axes of its own marker, which
    is at O. motions: displacements along the axes of the known marker, then rotations, each about an axis that those
    before it have turned. ball: whether it has its rotation against the inertial frame instead.
    """

    known: FrameMotion
    place: sp.ImmutableMatrix
    axes: sp.ImmutableMatrix
    own_axes: sp.ImmutableMatrix
    motions: tuple[JointCoordinate, ...]
    ball: bool


@dataclass(frozen=True)
class CarriedMotion:
    """The motion of the origin O and of the frame of a body in a tree; vectors are columns of 3 in the inertial frame.

    parent: the body that its joint connects it to; empty at the root of a tree. lever: from the origin of that body to
    O. rows: those that move the body, its own last, `own` in number; virtual: its motion by a unit virtual displacement
    of each. acceleration, angular_acceleration: without those of the coordinates. definitions: in their order. hinge:
    None for a body that keeps all coordinates.
    """

    parent: str
    lever: sp.ImmutableMatrix
    rows: Rows
    own: int
    virtual: tuple[VirtualMotion, ...]
    frame: sp.ImmutableMatrix
    position: sp.ImmutableMatrix
    velocity: sp.ImmutableMatrix
    acceleration: sp.ImmutableMatrix
    angular_velocity: sp.ImmutableMatrix
    angular_acceleration: sp.ImmutableMatrix
    definitions: tuple[Intermediate, ...]
    hinge: Hinge | None = field(default=None, compare=False)

    @property
    def own_rows(self) -> Rows:
        """The rows of its own joint, or of a free body."""
        return self.rows[len(self.rows) - self.own :]

    @property
    def own_virtual(self) -> tuple[VirtualMotion, ...]:
        """The motions by virtual displacements of its own rows."""
        return self.virtual[len(self.rows) - self.own :]

    @property
    def turns_with_parent(self) -> bool:
        """Whether rows of the bodies before it turn it; they do not turn a body that keeps its quaternion."""
        return any(entry for v in self.virtual[: len(self.rows) - self.own] for entry in v.rotation)

    def of_accelerations(self) -> tuple[sp.Matrix, sp.Matrix]:
        """The accelerations xddot and wdot as sums over those of the coordinates."""
        linear, angular = [sp.Matrix(self.acceleration)], [sp.Matrix(self.angular_acceleration)]
        for row, v in zip(self.rows, self.virtual, strict=True):
            linear.append(v.translation * row.a)
            angular.append(v.rotation * row.a)
        return summed(linear), summed(angular)


def summed(vectors: Sequence[sp.Matrix]) -> sp.Matrix:
    """The sum of columns of 3, not expanded."""
    return sp.Matrix([sp.Add(*(vector[k] for vector in vectors)) for k in range(3)])


class TreeDefinitions:
    """Names for quantities of a body in a tree, with their definitions; numbers and symbols stay as they are."""

    def __init__(self, body: str, section: str = "") -> None:
        self.body, self.section, self.made = body, section or f"{body} motion", list[Intermediate]()

    def scalar(
        self, family: Family, value: sp.Expr, doc: str, components: tuple[int, ...] = (), point: str = "", dots: int = 0
    ) -> sp.Expr:
        """The name of a scalar, or of its opposite if the value is the opposite of a symbol."""
        value = rounded(value)
        if value.is_Rational or value.is_Symbol or (-value).is_Symbol:
            return value
        symbol = Identity(family, components=components, derivative=dots, owner=self.body, point=point).symbol
        self.made.append(Intermediate(symbol, value, self.section, "(1)", f"{doc}{self._of(components)}, {self.body}"))
        return symbol

    def vector(self, family: Family, values: sp.Matrix, doc: str, point: str = "", dots: int = 0) -> sp.ImmutableMatrix:
        """The names of the components of a column."""
        return sp.ImmutableMatrix(
            [self.scalar(family, x, doc, (k,), point, dots) for k, x in zip(AXES, values, strict=True)]
        )

    def _of(self, components: tuple[int, ...]) -> str:
        return f" along {'-'.join(map(str, components))}" if components else ""


def carried_frame(
    of: CarriedMotion, section: CrossSection, position: sp.Matrix, name: str, define: TreeDefinitions
) -> FrameMotion:
    """The motion of a marker frame of a body in a tree; position (3, 1): that of the marker in the body frame."""
    Q, w = sp.Matrix(of.frame), of.angular_velocity
    lever = define.vector(Family.LEVER, product(Q, position), f"Q r at {name}", name)
    sdot = define.vector(Family.LEVER, cross(w, lever), f"time derivative of Q r at {name}", name, 1)
    axes = product(Q, sp.Matrix(section.axes))
    axes = sp.Matrix(
        3,
        3,
        lambda i, j: define.scalar(Family.FRAME_AXES, axes[i, j], f"axes of {name}", (i + 1, j + 1), name),
    )
    linear, angular = of.of_accelerations()
    return FrameMotion(
        definitions=(),
        position=sp.ImmutableMatrix(of.position + lever),
        velocity=sp.ImmutableMatrix(of.velocity + sdot),
        acceleration=sp.ImmutableMatrix(summed([linear, cross(angular, lever), cross(w, sdot)])),
        axes=sp.ImmutableMatrix(axes),
        angular_velocity=w,
        angular_acceleration=sp.ImmutableMatrix(angular),
        lever=lever,
        frame=of.frame,
        virtual=of.virtual,
        in_body=(sp.ImmutableMatrix(position), sp.ImmutableMatrix(section.axes)),
        carrier=define.body,
    )
