"""Constraints from the motion of material points: g = 0, and its first and second time derivatives."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import sympy as sp

from derive.mechanics.equations import Constraint, Definition, Row
from derive.mechanics.multibody.coordinates import time_derivatives, unit_axis
from derive.mechanics.multibody.point_motion import PointMotion
from derive.mechanics.multibody.time_functions import rounded
from derive.mechanics.symbols import element
from derive.spec.model.scene import Joint


@dataclass(frozen=True)
class Driven:
    """A drive of a joint: its name, and its motion with two time derivatives."""

    name: str
    motion: tuple[sp.Expr, sp.Expr, sp.Expr]


@dataclass(frozen=True)
class Link:
    """The second place of a joint as seen from the first: difference of points and of rotations, with derivatives."""

    apart: tuple[sp.Matrix, sp.Matrix, sp.Matrix]
    turned: tuple[sp.Expr, sp.Expr, sp.Expr]


def link(first: PointMotion, second: PointMotion) -> Link:
    """Second place minus first."""
    return Link(
        apart=(
            sp.Matrix(second.position - first.position),
            sp.Matrix(second.velocity - first.velocity),
            sp.Matrix(second.acceleration - first.acceleration),
        ),
        turned=(second.turn - first.turn, second.spin - first.spin, second.spin_rate - first.spin_rate),
    )


Residual = tuple[str, str, str, str, tuple[sp.Expr, sp.Expr, sp.Expr]]
"""Name, doc, unit, unit of the multiplier; g with two time derivatives."""


def constraints(
    joint: Joint, first: PointMotion, second: PointMotion, drive: Driven | None, rows: tuple[Row, ...]
) -> tuple[tuple[Definition, ...], tuple[Constraint, ...]]:
    """The constraints of a joint and of its drive, with what they define."""
    between = link(first, second)
    definitions: tuple[Definition, ...] = ()
    if joint.kind == "translational":
        definitions, residuals = _guide(joint, first, between, drive)
    else:
        residuals = [*_together(joint, between), *_turned(joint, between, drive)]
    return definitions, tuple(_constraint(joint, one, rows) for one in residuals)


def _together(joint: Joint, between: Link) -> Iterator[Residual]:
    for k in range(2):
        value = tuple(vector[k] for vector in between.apart)
        yield f"{joint.name}_{k + 1}", f"{_who(joint)} coincide along e{k + 1}", "m", "N", value


def _turned(joint: Joint, between: Link, drive: Driven | None) -> Iterator[Residual]:
    if joint.kind in ("weld", "fixed"):
        yield f"{joint.name}_turn", f"{_who(joint)} turn together", "rad", "N m", _offset(joint, between)
    elif drive:
        value = tuple(a - b for a, b in zip(between.turned, drive.motion, strict=True))
        yield drive.name, f"drive {drive.name} turns {joint.second.body}", "rad", "N m", value


def _offset(joint: Joint, between: Link) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    return (between.turned[0] - sp.Rational(joint.angle), *between.turned[1:])


def _guide(
    joint: Joint, first: PointMotion, between: Link, drive: Driven | None
) -> tuple[tuple[Definition, ...], list[Residual]]:
    """The axis is fixed in the first body, and turns with it; its normal is e3 x axis."""
    axis = unit_axis(joint)
    definitions: list[Definition] = []
    if first.turn.is_zero:
        along = axis
    else:
        cos, sin = rounded(sp.cos(first.turn)), rounded(sp.sin(first.turn))
        along = sp.Matrix([element(joint.name, "axis", k) for k in (1, 2)])
        values = sp.Matrix([[cos, -sin], [sin, cos]]) * axis
        doc = f"axis of {joint.name} along e"
        definitions = [
            Definition(s, value, joint.name, "(26)", f"{doc}{k}")
            for k, (s, value) in enumerate(zip(along, values, strict=True), 1)
        ]
    normal = sp.Matrix([-along[1], along[0]])

    def component(direction: sp.Matrix) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
        """direction . apart, differentiated with direction' = spin e3 x direction."""
        across = sp.Matrix([-direction[1], direction[0]])
        apart, rate, second = between.apart
        spin, spin_rate = first.spin, first.spin_rate
        return (
            direction.dot(apart),
            direction.dot(rate) + spin * across.dot(apart),
            direction.dot(second)
            + 2 * spin * across.dot(rate)
            + spin_rate * across.dot(apart)
            - spin**2 * direction.dot(apart),
        )

    found: list[Residual] = [
        (f"{joint.name}_normal", f"{joint.second.body} stays on the line of {joint.name}", "m", "N", component(normal)),
        (f"{joint.name}_turn", f"{_who(joint)} turn together", "rad", "N m", _offset(joint, between)),
    ]
    if drive:
        value = tuple(a - b for a, b in zip(component(along), drive.motion, strict=True))
        found.append((drive.name, f"drive {drive.name} displaces {joint.second.body}", "m", "N", value))
    return tuple(definitions), found


def _constraint(joint: Joint, residual: Residual, rows: tuple[Row, ...]) -> Constraint:
    name, doc, unit, force_unit, (position, rate, second) = residual
    second = sp.expand(second)
    present = second.free_symbols
    factors = ((row, second.coeff(row.a)) for row in rows if row.a in present)
    return Constraint(
        name=name,
        of=joint.name,
        doc=doc,
        unit=unit,
        force_unit=force_unit,
        position=sp.expand(position),
        rate=sp.expand(rate),
        bias=second.xreplace({row.a: sp.S.Zero for row in rows if row.a in present}),
        jacobian=tuple((row.name, factor) for row, factor in factors if factor != 0),
    )


def _who(joint: Joint) -> str:
    """The places of a joint as a user knows them, and the pieces of rods as their neighbours."""
    return f"{joint.first.body}.{joint.first.marker} and {joint.second.body}.{joint.second.marker}"


def drive_motion(expr: sp.Expr, name: str) -> Driven:
    """A drive with the derivatives of its motion."""
    return Driven(name, time_derivatives(expr))
