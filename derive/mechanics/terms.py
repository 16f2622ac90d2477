"""What equations of motion are made of: coordinates, constants, intermediate quantities, named terms, constraints."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import sympy as sp

from derive.mechanics.sums import ModeSum
from derive.mechanics.symbols import Family, identity
from derive.roles import Role

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
    """A generalised coordinate: its symbol, what it is, and its unit."""

    q: sp.Symbol
    doc: str
    unit: str

    @property
    def role(self) -> Role:
        """What the coordinate describes."""
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
    """A run-time parameter: its symbol in the derivation, what it is, its unit, its default, and whether setup
    refuses a value that is not positive."""

    symbol: sp.Symbol
    doc: str
    unit: str
    default: float
    positive: bool = True


@dataclass(frozen=True)
class ModelConstant:
    """A shape integral or a stiffness: the work on parameters alone. `zero` says why it vanishes, if it does."""

    symbol: sp.Symbol
    value: sp.Expr
    equation: str
    doc: str
    unit: str
    zero: str | None = None


@dataclass(frozen=True)
class Intermediate:
    """A named intermediate quantity of (15), in terms of coordinates, coefficients and earlier definitions."""

    symbol: sp.Symbol
    expr: sp.Expr
    section: str
    equation: str
    doc: str
    zero: str | None = None


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
    """Why an entry or a term vanishes: the integrals that are zero in it, each with its own reason.

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
        """Whether there is a reason."""
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
    """A term of (15) that is no part of this model, with the reason."""

    term: Term
    reason: Reason


@dataclass(frozen=True)
class MarkerEquations:
    """Position and velocity of a named material point, and d(velocity)/dv, in the inertial frame.

    `load` is the virtual work of a force at the point, with the components `force` in the inertial frame, row by row.
    Where sums over the shapes are kept, `mode_sums` are those that define the point in the body frame, and the last
    column and row are those of a generic shape.
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


@dataclass(frozen=True)
class Constraint:
    """g = 0 with its multiplier, the force or torque that a joint exerts on its second body.

    `position` is g, `rate` its time derivative, `bias` what is left of the second one when the accelerations are zero;
    `jacobian` holds the factors of the rates, by row. `of` is the joint or the drive.
    """

    name: str
    of: str
    doc: str
    unit: str
    force_unit: str
    position: sp.Expr
    rate: sp.Expr
    bias: sp.Expr
    jacobian: tuple[tuple[str, sp.Expr], ...]


@dataclass(frozen=True)
class Pose:
    """Position of the origin and rotation of a body's frame: of every body, whether it has coordinates or not."""

    name: str
    position: tuple[sp.Expr, sp.Expr]
    rotation_angle: sp.Expr


@dataclass(frozen=True)
class Eliminated:
    """What a scene does not need and the model does not have, with the reason."""

    what: str
    reason: str
