"""The components of equations of motion: coordinates, constants, intermediate quantities, terms and constraints."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache, cached_property
from typing import TYPE_CHECKING

from derive.mechanics.symbols import Family, identity, local
from derive.roles import Role

if TYPE_CHECKING:
    from derive.algebra import sp
    from derive.mechanics.sums import ModeSum, TableSum

ROLES = {
    Family.TRANSLATION: Role.TRANSLATION,
    Family.ANGLE: Role.ROTATION,
    Family.QUATERNION: Role.QUATERNION,
    Family.GUIDE: Role.DISPLACEMENT,
    Family.AMPLITUDE: Role.AMPLITUDE,
}
"""The roles of coordinates, by their families."""


@dataclass(frozen=True)
class Coordinate:
    """A generalised coordinate: its symbol, its description, and its unit."""

    q: sp.Symbol
    doc: str
    unit: str

    @property
    def role(self) -> Role:
        """The role of the coordinate, which follows from the family of its symbol."""
        return ROLES[identity(self.q).family]


@dataclass(frozen=True)
class EquationOfMotion:
    """A virtual displacement with its equation of motion: its name, the velocity and acceleration that belong to it.

    `unit` is that of the velocity, `force_unit` that of the equation. In the plane there is one equation for each
    coordinate; in space a quaternion has four coordinates and three equations.
    """

    name: str
    v: sp.Symbol
    a: sp.Symbol
    doc: str
    unit: str
    force_unit: str


@dataclass(frozen=True)
class ParameterSymbol:
    """A run-time parameter: symbol, description, unit, default value, and whether setup requires a positive value."""

    symbol: sp.Symbol
    doc: str
    unit: str
    default: float
    positive: bool = True


@dataclass(frozen=True)
class InputSymbol:
    """A run-time input, or a time derivative of one: symbol, name, name for people, description and unit."""

    symbol: sp.Symbol
    name: str
    shown: str
    doc: str
    unit: str


@dataclass(frozen=True)
class ModelConstant:
    """A constant that depends on parameters alone, such as a shape integral or a stiffness.

    `equation` is its number in the paper; `zero` is the reason if the constant vanishes structurally, otherwise None.
    """

    symbol: sp.Symbol
    value: sp.Expr
    equation: str
    doc: str
    unit: str
    zero: str | None = None


@dataclass(frozen=True)
class Intermediate:
    """A named intermediate quantity of (15), in terms of coordinates, model constants and earlier definitions.

    `section` names the part of a kernel that computes it; `zero` is the reason if it vanishes, otherwise None.
    `divisor` is an earlier definition that has to be positive for this one to exist, otherwise None; `divisor_text`
    is the message where it is not.
    """

    symbol: sp.Symbol
    expr: sp.Expr
    section: str
    equation: str
    doc: str
    zero: str | None = None
    divisor: sp.Symbol | None = None
    divisor_text: str = ""

    @cached_property
    def needs(self) -> frozenset[sp.Symbol]:
        """The symbols in the expression, which is searched once and not for each kernel."""
        return frozenset(self.expr.free_symbols)


def rotation_symbols(definitions: Iterable[Intermediate]) -> frozenset[sp.Symbol]:
    """The entries of rotation tensors, and the sines and cosines in them."""
    families = (Family.ROTATION_TENSOR, Family.COSINE, Family.SINE)
    return frozenset(d.symbol for d in definitions if identity(d.symbol).family in families)


@dataclass(frozen=True)
class Term:
    """One named term of the equations of motion: the name of its row and its expression."""

    row: str
    name: str
    equation: str
    expr: sp.Expr


@dataclass(frozen=True)
class Reason:
    """The reason why an entry or a term vanishes: the integrals that are zero in it, each with its own reason.

    `identity` is the reason of what vanishes in every body, without an integral. The text gathers the integrals by
    reason: `c6_1 .. c6_8 = 0 by condition (19); ...`.
    """

    causes: tuple[tuple[sp.Symbol, str], ...] = ()
    identity: str = ""

    @property
    def by_reason(self) -> dict[str, tuple[sp.Symbol, ...]]:
        """The integrals by their reasons, in the order in which these occur."""
        gathered: dict[str, list[sp.Symbol]] = {}
        for symbol, reason in self.causes:
            gathered.setdefault(reason, []).append(symbol)
        return {reason: tuple(symbols) for reason, symbols in gathered.items()}

    def __bool__(self) -> bool:
        """Whether the reason is not empty."""
        return bool(self.causes or self.identity)

    def __str__(self) -> str:
        """The reason as plain text."""
        texts = [
            f"{', '.join(s.name for s in some) if len(some) < 4 else f'{some[0].name} .. {some[-1].name}'} = 0 by {why}"
            for why, some in self.by_reason.items()
        ]
        return "; ".join(texts) or self.identity


@dataclass(frozen=True)
class Vanished:
    """A term of (15) that vanishes in this model, with the reason."""

    term: Term
    reason: Reason


@dataclass(frozen=True)
class MarkerEquations:
    """Kinematics of a marker: position, velocity (d, 1) and Jacobian d(velocity)/dv (d, rows) in the inertial frame.

    `load` (rows,) is the virtual work of a force at the marker, with inertial components `force` (d, 1). If the
    equations keep their sums over the modes, `mode_sums` define the point in the body frame, at second order with the
    `table_sums` dr/dalpha_i, and the last column and row belong to a generic mode. d is 2 in the plane and 3 in space.
    shown: the name for people, where that is another one; angular_velocity: of a marker of a scene, that of its frame,
    in the inertial frame (3, 1), in the plane (1, 1).
    """

    name: str
    doc: str
    definitions: tuple[Intermediate, ...]
    position: sp.ImmutableMatrix
    velocity: sp.ImmutableMatrix
    jacobian: sp.ImmutableMatrix
    force: sp.ImmutableMatrix
    force_definitions: tuple[Intermediate, ...]
    load: tuple[sp.Expr, ...]
    mode_sums: tuple[ModeSum, ...] = ()
    table_sums: tuple[TableSum, ...] = ()
    shown: str = ""
    angular_velocity: sp.ImmutableMatrix | None = None


@dataclass(frozen=True)
class FreeRotation:
    """The rotation of a body in space that nothing else of it depends on: its rows and its rotation tensor Q.

    The rows are those of the angular velocity in the body frame; no other row of the body turns it.
    """

    rows: tuple[str, str, str]
    Q: sp.ImmutableMatrix


@dataclass(frozen=True)
class OwnAxes:
    """The motion of a frame of a free body, along the axes of this body.

    `work` is the virtual work of `load_symbols` along these axes by the names of the rows, where the translations of
    the origin, which come first, are along them too. `acceleration` and `angular_acceleration` are without those of the
    coordinates. `Q` is the rotation tensor of the body.
    """

    Q: sp.ImmutableMatrix
    work: tuple[tuple[str, sp.Expr], ...]
    acceleration: sp.ImmutableMatrix
    angular_acceleration: sp.ImmutableMatrix


@cache
def load_symbols() -> tuple[sp.Symbol, ...]:
    """The components of any force and torque on a frame."""
    return tuple(local(f"load_{kind}", k) for kind in ("force", "torque") for k in (1, 2, 3))


@dataclass(frozen=True)
class ConstrainedFrame:
    """A frame on which a constraint in space acts, in inertial components.

    `rotation` is that of its body if it is free, and `moment` what a unit multiplier exerts on the body about its
    origin, so that the factors of its rows are Q^T moment. `turning` holds the factors of the other rows in the angular
    velocity of the frame, by their names.

    A unit multiplier exerts `force` at the point and `torque` on the frame; `work` is the virtual work of any such
    `load_symbols` by the names of the rows, and equal for all constraints on the frame. `acceleration` and
    `angular_acceleration` are those of the frame. `carrier` is its body if that is one of a tree, and `place` the point
    in the frame of this body; `own` is the motion along the axes of its body if that keeps all coordinates.
    """

    rotation: FreeRotation | None
    moment: sp.ImmutableMatrix
    turning: tuple[tuple[str, sp.ImmutableMatrix], ...]
    force: sp.ImmutableMatrix
    torque: sp.ImmutableMatrix
    work: tuple[tuple[str, sp.Expr], ...]
    acceleration: sp.ImmutableMatrix
    angular_acceleration: sp.ImmutableMatrix
    carrier: str = ""
    place: sp.ImmutableMatrix | None = None
    own: OwnAxes | None = None


@dataclass(frozen=True)
class FramePair:
    """Both frames of a constraint in space, and `axis` if gdot is axis . (w2 - w1) with their angular velocities.

    `bias` is gddot without the accelerations of the frames.
    """

    first: ConstrainedFrame
    second: ConstrainedFrame
    axis: sp.ImmutableMatrix | None
    bias: sp.Expr


@dataclass(frozen=True)
class Constraint:
    """A scalar constraint g = 0 with its multiplier, the constraint reaction on body 2 of the joint.

    `position` is g, `rate` is gdot, and `bias` is gddot with all accelerations set to zero. `jacobian` holds the factor
    of each generalised velocity in gdot, by the name of its row. `of` names the joint or the drive; `unit` is the unit
    of g, `force_unit` that of the multiplier. `shown` is the name for people; `section` is that of the specification
    with the elements to which `of` belongs. `frames` are those of a joint in space.
    """

    name: str
    shown: str
    of: str
    doc: str
    unit: str
    force_unit: str
    position: sp.Expr
    rate: sp.Expr
    bias: sp.Expr
    jacobian: tuple[tuple[str, sp.Expr], ...]
    section: str = "joints"
    frames: FramePair | None = None

    @property
    def multiplier(self) -> sp.Symbol:
        """The symbol of the multiplier."""
        return local(f"lambda_{self.name}")


@dataclass(frozen=True)
class OutputEquation:
    """A component of an output in terms of coordinates, velocities, accelerations, multipliers and the time.

    `shown` is the name for people.
    """

    name: str
    shown: str
    unit: str
    doc: str
    expr: sp.Expr


@dataclass(frozen=True)
class Pose:
    """Position of the origin (m) and rotation angle (rad) of a body frame in the plane, with or without coordinates."""

    name: str
    position: tuple[sp.Expr, sp.Expr]
    rotation_angle: sp.Expr

    @property
    def parts(self) -> tuple[tuple[str, sp.Expr], ...]:
        """The components with their labels, in the order of the generated code."""
        return (*zip(("c1", "c2"), self.position, strict=True), ("phi", self.rotation_angle))


@dataclass(frozen=True)
class SpatialPose:
    """Position of the origin (m) and rotation tensor, by rows, of a body frame in space."""

    name: str
    position: tuple[sp.Expr, ...]
    rotation: tuple[sp.Expr, ...]

    @property
    def parts(self) -> tuple[tuple[str, sp.Expr], ...]:
        """The components with their labels, in the order of the generated code."""
        tensor = (f"Q{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3))
        return (*zip(("c1", "c2", "c3"), self.position, strict=True), *zip(tensor, self.rotation, strict=True))


@dataclass(frozen=True)
class Eliminated:
    """A part of a scene that joint elimination removes from the model, with the reason."""

    what: str
    reason: str
