"""A body in its scene: its equations of motion in the coordinates that it keeps there, under names of the scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import sympy as sp

from derive.mechanics import zeros
from derive.mechanics.equations import (
    Coefficient,
    Coordinate,
    Definition,
    Equations,
    MarkerEquations,
    Row,
    Term,
    Vanished,
)
from derive.mechanics.motion import Motion
from derive.mechanics.multibody.components import Member
from derive.mechanics.multibody.coordinates import Held
from derive.mechanics.multibody.point_motion import PointMotion, point_motion
from derive.mechanics.multibody.time_functions import rounded
from derive.mechanics.points import marker
from derive.mechanics.symbols import Family, identity, owned

Symbols = dict[sp.Basic, sp.Basic]


@dataclass(frozen=True)
class Placed:
    """What a body contributes to the equations of a scene; `points` are its markers."""

    coordinates: tuple[Coordinate, ...]
    rows: tuple[Row, ...]
    coefficients: tuple[Coefficient, ...]
    definitions: tuple[Definition, ...]
    terms: tuple[Term, ...]
    vanished: tuple[Vanished, ...]
    mass_zeros: tuple[tuple[str, str, str], ...]
    energies: tuple[sp.Expr, sp.Expr, sp.Expr]
    linear: tuple[sp.Expr, ...]
    angular: tuple[sp.Expr, ...]
    markers: tuple[MarkerEquations, ...]
    points: Mapping[str, PointMotion]


def placed(member: Member, equations: Equations, held: Held) -> Placed:
    """A member of a scene; `equations` are those of its body, without markers, in its own symbols."""
    motion = member.body.motion
    reasons = zeros.reasons_of(equations.coefficients)
    of_points = tuple(c for s in member.sections.values() for c in (*s.point.coefficients, *s.turns))
    coefficients = (*(equations.coefficients if held.rows else ()), *of_points)
    change: Symbols = {**held.values, **_renamed(member.group, (*equations.coefficients, *of_points))}
    definitions = list(held.definitions)
    definitions += _definitions(member.name, equations.definitions if held.rows else _rotation(motion), change)
    reasons |= zeros.reasons_of(of_points)
    points = {}
    for name, section in member.sections.items():
        moved = point_motion(motion, section.point, section.turns, reasons)
        definitions += _definitions(member.name, moved.definitions, change)
        points[name] = moved.replaced(change)
    shown = held.rows and member.shown
    return Placed(
        coordinates=held.coordinates,
        rows=held.rows,
        coefficients=tuple(_coefficient(member.group, c) for c in coefficients),
        definitions=tuple(definitions),
        terms=tuple(_terms(equations, held, change)),
        vanished=tuple(_vanished(member, equations, held)),
        mass_zeros=tuple(_mass_zeros(equations, held)),
        energies=tuple(
            sp.expand((e or sp.S.Zero).xreplace(change))
            for e in (equations.kinetic_energy, equations.strain_energy, equations.weight_energy)
        ),
        linear=tuple(sp.expand(e.xreplace(change)) for e in equations.linear_momentum),
        angular=tuple(sp.expand(e.xreplace(change)) for e in equations.angular_momentum),
        markers=tuple(_marker(member, name, reasons, held, change) for name in shown or ()),
        points=points,
    )


def _renamed(group: str, coefficients: tuple[Coefficient, ...]) -> Symbols:
    return {c.symbol: owned(c.symbol, group) for c in coefficients if not _is_shared(c)}


def _is_shared(c: Coefficient) -> bool:
    """Whether all bodies share a coefficient: gravity is resolved in the inertial frame."""
    return identity(c.symbol).family is Family.GRAVITY


def _coefficient(group: str, c: Coefficient) -> Coefficient:
    if _is_shared(c):
        return c
    return replace(c, symbol=owned(c.symbol, group), doc=f"{c.doc}; {group}")


def _rotation(motion: Motion) -> tuple[Definition, ...]:
    return motion.rotation_definitions


def _definitions(name: str, definitions: tuple[Definition, ...], change: Symbols, point: str = "") -> list[Definition]:
    """Definitions under names of the scene; `change` learns them, and numbers for those that are constant here."""
    found = []
    for d in definitions:
        if d.zero:
            continue
        expr = rounded(sp.expand(d.expr.xreplace(change)))
        if expr.is_Rational or expr.is_Symbol:
            change[d.symbol] = expr
            continue
        symbol = owned(d.symbol, name, point)
        change[d.symbol] = symbol
        where = f"{name}_{point}" if point else name
        found.append(replace(d, symbol=symbol, expr=expr, section=f"{where} {d.section}"))
    return found


def _terms(equations: Equations, held: Held, change: Symbols) -> list[Term]:
    found = []
    for row, weights in zip(held.rows, held.weights, strict=True):
        for old, weight in weights.items():
            for term in equations.terms:
                expr = sp.expand(weight * term.expr.xreplace(change)) if term.row == old else sp.S.Zero
                if expr != 0:
                    found.append(replace(term, row=row.name, expr=expr))
    return found


def _kept(held: Held) -> dict[str, str]:
    """The rows that are those of the free body, by their names there."""
    found = {}
    for row, weights in zip(held.rows, held.weights, strict=True):
        if len(weights) == 1:
            found[next(iter(weights))] = row.name
    return found


def _vanished(member: Member, equations: Equations, held: Held) -> list[Vanished]:
    names = _kept(held)
    return [replace(v, term=replace(v.term, row=names[v.term.row])) for v in equations.vanished if v.term.row in names]


def _mass_zeros(equations: Equations, held: Held) -> list[tuple[str, str, str]]:
    names, rows = _kept(held), [row.name for row in equations.rows]
    return [
        (names[rows[i]], names[rows[j]], why)
        for i, j, why in equations.mass_zeros
        if rows[i] in names and rows[j] in names
    ]


def _marker(member: Member, name: str, reasons: zeros.Reasons, held: Held, change: Symbols) -> MarkerEquations:
    """A marker with its Jacobian and load in the coordinates that the body keeps."""
    free = marker(member.body.motion, member.sections[name].point, reasons)
    own = dict(change)
    definitions = tuple(_definitions(member.name, free.definitions, own, name))
    turned = tuple(_definitions(member.name, free.force_definitions, own, name))
    rows = [row.name for row in member.body.motion.rows]

    def combined(values: Mapping[str, sp.Expr], weights: Mapping[str, sp.Expr]) -> sp.Expr:
        return sp.expand(sp.Add(*(w * values[old].xreplace(own) for old, w in weights.items())))

    load = dict(zip(rows, free.load, strict=True))
    columns = {row: free.jacobian[:, j] for j, row in enumerate(rows)}
    jacobian = [
        [combined({old: column[i] for old, column in columns.items()}, weights) for weights in held.weights]
        for i in range(2)
    ]
    return replace(
        free,
        name=f"{member.group}_{name}",
        doc=f"{free.doc} of {member.name}",
        definitions=definitions,
        position=_vector(free.position, own),
        velocity=_vector(free.velocity, own),
        jacobian=sp.ImmutableMatrix(jacobian),
        force_definitions=turned,
        load=tuple(combined(load, weights) for weights in held.weights),
    )


def _vector(column: sp.ImmutableMatrix, change: Symbols) -> sp.ImmutableMatrix:
    return sp.ImmutableMatrix(column.applyfunc(lambda e: sp.expand(e.xreplace(change))))
