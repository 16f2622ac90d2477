"""What `derive` returns: the equations of motion as named terms, with everything they are made of."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import sympy as sp

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
class Row:
    """A virtual displacement with its equation of motion: its name, the rate and acceleration that belong to it.

    `unit` is that of the rate, `work` that of the equation. In the plane rows and coordinates go together; in space
    a quaternion has four coordinates and three rows.
    """

    name: str
    v: sp.Symbol
    a: sp.Symbol
    doc: str
    unit: str
    work: str


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
class Coefficient:
    """A shape integral or a stiffness: the work on parameters alone. `zero` says why it vanishes, if it does."""

    symbol: sp.Symbol
    value: sp.Expr
    equation: str
    doc: str
    unit: str
    zero: str | None = None


@dataclass(frozen=True)
class Definition:
    """A named intermediate quantity of (15), in terms of coordinates, coefficients and earlier definitions."""

    symbol: sp.Symbol
    expr: sp.Expr
    section: str
    equation: str
    doc: str
    zero: str | None = None


def rotation_symbols(definitions: Iterable[Definition]) -> frozenset[sp.Symbol]:
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
    """Position and velocity of a named material point, and d(velocity)/dv, in the inertial base.

    `load` is the virtual work of a force at the point, with the components `force` in the inertial base, row by row.
    """

    name: str
    doc: str
    definitions: tuple[Definition, ...]
    position: sp.ImmutableMatrix
    velocity: sp.ImmutableMatrix
    jacobian: sp.ImmutableMatrix
    force: sp.ImmutableMatrix
    force_definitions: tuple[Definition, ...]
    load: tuple[sp.Expr, ...]


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
    """Position of the origin and rotation of a body's base: of every body, whether it has coordinates or not."""

    name: str
    position: tuple[sp.Expr, sp.Expr]
    turn: sp.Expr


@dataclass(frozen=True)
class Eliminated:
    """What a scene does not need and the model does not have, with the reason."""

    what: str
    reason: str


@dataclass(frozen=True)
class Equations:
    """The equations of motion of one model: the sum of the terms of each row is zero (no load at markers).

    A scene has the bodies' equations one after the other, with `constraints`: then the sum of a row is not zero, but
    what the multipliers contribute, sum lambda_k jacobian_k. `poses` are those of its bodies, `eliminated` says what is
    not modelled.

    `weight_energy` is the potential of gravity, None where there is none. `choice` says why the equations are written
    out for each shape, where loops could have been had.

    `origin` says in words where c is. `rates` gives the time derivatives of the coordinates. `coefficients` hold the
    shape integrals c1..c8 and the stiffness, `definitions` d1, D2, d3, J and what else is shared; both keep their
    zeros, with reasons. `mass_zeros` explains the zeros of the mass matrix: (row, column, reason), lower triangle.
    """

    name: str
    doc: str
    origin: str
    coordinates: tuple[Coordinate, ...]
    rows: tuple[Row, ...]
    rates: tuple[sp.Expr, ...]
    parameters: tuple[ParameterSymbol, ...]
    coefficients: tuple[Coefficient, ...]
    definitions: tuple[Definition, ...]
    terms: tuple[Term, ...]
    vanished: tuple[Vanished, ...]
    mass: sp.ImmutableMatrix
    mass_zeros: tuple[tuple[int, int, Reason], ...]
    kinetic_energy: sp.Expr
    strain_energy: sp.Expr
    weight_energy: sp.Expr | None
    linear_momentum: tuple[sp.Expr, ...]
    angular_momentum: tuple[sp.Expr, ...]
    markers: tuple[MarkerEquations, ...]
    choice: str = ""
    constraints: tuple[Constraint, ...] = ()
    poses: tuple[Pose, ...] = ()
    eliminated: tuple[Eliminated, ...] = ()

    @property
    def force(self) -> tuple[sp.Expr, ...]:
        """h of M vdot + h = 0: what is left of each row when the accelerations are zero."""
        at_rest = {row.a: sp.S.Zero for row in self.rows}
        return tuple(self.sum_of(row.name).xreplace(at_rest) for row in self.rows)

    def sum_of(self, row: str) -> sp.Expr:
        """The left-hand side of one equation of motion, in coefficients and definitions."""
        return sp.Add(*(t.expr for t in self.terms if t.row == row))

    def row(self, name: str) -> sp.Expr:
        """The left-hand side of one equation of motion in coordinates, rates, accelerations and parameters."""
        return self.expanded(self.sum_of(name))

    def expanded(self, expr: sp.Expr) -> sp.Expr:
        """An expression with every definition and coefficient written out."""
        for definition in reversed(self.definitions):
            expr = expr.subs(definition.symbol, definition.expr)
        return sp.expand(expr.subs({c.symbol: c.value for c in self.coefficients}))

    def _repr_html_(self) -> str:
        """What a notebook shows; the report is imported when one asks."""
        from derive.report.notebook import equations_html

        return equations_html(self)
