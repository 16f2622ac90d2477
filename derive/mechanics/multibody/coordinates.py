"""Which coordinates a body keeps: a joint to the ground, or to a body whose motion is known, takes some away.

Only rigid bodies are reduced: of a flexible one a joint holds a point, not a coordinate.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

import sympy as sp

from derive.mechanics.equations import Coordinate, Definition, Row
from derive.mechanics.motion import Motion
from derive.mechanics.multibody.point_motion import PointMotion
from derive.mechanics.symbols import Family, Symbol, owned, quantity, t
from derive.spec.model.scene import Joint


@dataclass(frozen=True)
class Held:
    """The coordinates of a body in a scene.

    `values` says what each coordinate, rate and acceleration of the free body is; `weights` what each new row is made
    of, by the names of the free body's rows. `definitions` are those of a prescribed motion, `reason` says what was
    left out.
    """

    coordinates: tuple[Coordinate, ...]
    rows: tuple[Row, ...]
    values: Mapping[sp.Basic, sp.Basic]
    weights: tuple[Mapping[str, sp.Expr], ...]
    definitions: tuple[Definition, ...] = ()
    reason: str = ""


def free(name: str, motion: Motion) -> Held:
    """All coordinates, with the name of the body in front."""
    coordinates, rows = [], []
    values: dict[sp.Basic, sp.Basic] = {}
    for coordinate, row in zip(motion.coordinates, motion.rows, strict=True):
        new, new_row = _coordinate(owned(coordinate.q, name), f"{name}: {coordinate.doc}", coordinate.unit)
        coordinates.append(new)
        rows.append(new_row)
        values |= {coordinate.q: new.q, row.v: new_row.v, row.a: new_row.a}
    return Held(tuple(coordinates), tuple(rows), values, tuple({row.name: sp.S.One} for row in motion.rows))


def known(name: str, motion: Motion, at: PointMotion, turn: tuple[sp.Expr, sp.Expr, sp.Expr], reason: str) -> Held:
    """No coordinates: O follows a known point, and the rotation and its two derivatives are known functions of t."""
    values, definitions = _origin(name, motion, at)
    for symbol, value in zip(_symbols(motion, 2), turn, strict=True):
        new, found = _named(name, symbol, value, f"prescribed rotation of {name}")
        values[symbol] = new
        definitions += found
    return Held((), (), values, (), tuple(definitions), reason)


def turning(name: str, motion: Motion, at: PointMotion, reason: str) -> Held:
    """The rotation alone: O follows a known point."""
    values, definitions = _origin(name, motion, at)
    coordinate, row = _coordinate(owned(quantity(Family.ANGLE), name), f"rotation of {name}", "rad")
    values |= dict(zip(_symbols(motion, 2), (coordinate.q, row.v, row.a), strict=True))
    weights = {motion.rows[2].name: sp.S.One}
    return Held((coordinate,), (row,), values, (weights,), tuple(definitions), reason)


def sliding(name: str, motion: Motion, at: PointMotion, axis: sp.Matrix, turn: sp.Expr, reason: str) -> Held:
    """The displacement s along an axis through a point of the ground alone."""
    coordinate, row = _coordinate(owned(quantity(Family.GUIDE), name), f"displacement of {name} along its guide", "m")
    values: dict[sp.Basic, sp.Basic] = {}
    for k in range(2):
        q, v, a = _symbols(motion, k)
        values |= {q: at.position[k] + axis[k] * coordinate.q, v: axis[k] * row.v, a: axis[k] * row.a}
    values |= dict(zip(_symbols(motion, 2), (turn, sp.S.Zero, sp.S.Zero), strict=True))
    weights = {motion.rows[k].name: axis[k] for k in range(2) if axis[k]}
    return Held((coordinate,), (row,), values, (weights,), (), reason)


def unit_axis(joint: Joint) -> sp.Matrix:
    """The direction of a translational joint, of length one exactly: a point of the circle that is rational."""
    axis = sp.Matrix([sp.Rational(x) for x in joint.axis])
    length = sp.sqrt(axis.dot(axis))
    if length.is_Rational:
        return axis / length
    angle = math.atan2(*map(float, reversed(joint.axis)))
    half = sp.Rational(Fraction(math.tan(angle / 2)).limit_denominator(10**9))
    return sp.Matrix([1 - half**2, 2 * half]) / (1 + half**2)


def is_still(at: PointMotion) -> bool:
    """Whether a known point does not move."""
    return not any((*at.velocity, *at.acceleration, at.spin, at.spin_rate))


def time_derivatives(of: sp.Expr) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """A function of time with its first two derivatives."""
    return of, of.diff(t), of.diff(t, 2)


def _coordinate(q: Symbol, doc: str, unit: str) -> tuple[Coordinate, Row]:
    name = q.name
    v, a = (Symbol(replace(q.identity, derivative=d)) for d in (1, 2))
    work = "N m" if unit == "rad" else "N"
    return Coordinate(q, doc, unit), Row(name, v, a, f"rate of {name}", f"{unit}/s", work)


def _symbols(motion: Motion, k: int) -> tuple[sp.Symbol, sp.Symbol, sp.Symbol]:
    return motion.coordinates[k].q, motion.rows[k].v, motion.rows[k].a


def _origin(name: str, motion: Motion, at: PointMotion) -> tuple[dict[sp.Basic, sp.Basic], list[Definition]]:
    """c of a body whose origin O follows a known point; what moves has a name."""
    values: dict[sp.Basic, sp.Basic] = {}
    definitions: list[Definition] = []
    for k in range(2):
        moved = (at.position[k], at.velocity[k], at.acceleration[k])
        for symbol, value in zip(_symbols(motion, k), moved, strict=True):
            new, found = _named(name, symbol, value, f"prescribed motion of the origin of {name}")
            values[symbol] = new
            definitions += found
    return values, definitions


def _named(name: str, symbol: sp.Symbol, value: sp.Expr, doc: str) -> tuple[sp.Expr, list[Definition]]:
    """A number or a symbol as it is; else a definition."""
    if value.is_Rational or value.is_Symbol:
        return value, []
    new = owned(symbol, name)
    return new, [Definition(new, value, name, "(1)", doc)]
