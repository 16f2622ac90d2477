"""The equations of an instance of a body: those of its kind in the coordinates and symbols of the mechanism."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache

import sympy as sp

from derive.mechanics import zeros
from derive.mechanics.equations import Equations
from derive.mechanics.motion.material_points import marker
from derive.mechanics.multibody.bodies.body_type import Component
from derive.mechanics.multibody.coordinates import CoordinateMap
from derive.mechanics.multibody.kinds import KEPT, BodyInstance, BodyKind
from derive.mechanics.multibody.point_motion import PointMotion, point_motion
from derive.mechanics.quantity import rounded
from derive.mechanics.symbols import Family, identity, owned
from derive.mechanics.terms import (
    Coordinate,
    EquationOfMotion,
    Intermediate,
    MarkerEquations,
    ModelConstant,
    Reason,
    Term,
    Vanished,
)

Symbols = dict[sp.Basic, sp.Basic]


@dataclass(frozen=True)
class InstanceEquations:
    """The contribution of an instance to the equations of a mechanism.

    `points` are the motions of its markers, `origin` is c. `free_residual` are the rows of c1, c2 and phi of the free
    body: the force and the torque about c that move it as it moves, besides gravity (N, N m); only if it is `complete`.
    """

    coordinates: tuple[Coordinate, ...]
    rows: tuple[EquationOfMotion, ...]
    coefficients: tuple[ModelConstant, ...]
    definitions: tuple[Intermediate, ...]
    terms: tuple[Term, ...]
    vanished: tuple[Vanished, ...]
    mass_zeros: tuple[tuple[str, str, Reason], ...]
    energies: tuple[sp.Expr, sp.Expr, sp.Expr]
    linear: tuple[sp.Expr, ...]
    angular: tuple[sp.Expr, ...]
    markers: tuple[MarkerEquations, ...]
    points: Mapping[str, PointMotion]
    origin: tuple[sp.Expr, ...]
    free_residual: tuple[sp.Expr, ...]


def instance_equations(instance: BodyInstance, kind: BodyKind, repeated: bool) -> InstanceEquations:
    """The equations of an instance.

    `repeated`: an earlier instance has the same group and kind, so that its vanished terms are already listed.
    """
    return _equations(_Request(_key(instance, kind), repeated, instance, kind))


@dataclass(frozen=True)
class _Request:
    """A request for the equations of an instance; `key` is hashable and contains everything that they depend on."""

    key: Hashable
    repeated: bool
    instance: BodyInstance = field(compare=False)
    kind: BodyKind = field(compare=False)


def _key(instance: BodyInstance, kind: BodyKind) -> Hashable:
    component, coordinates = instance.component, instance.coordinates
    return (
        *(component.name, component.group, component.body, tuple(component.sections.items()), component.markers),
        *(component.specified, coordinates.coordinates, coordinates.rows, tuple(coordinates.values.items())),
        *(tuple(tuple(weights.items()) for weights in coordinates.weights), coordinates.definitions),
        *(coordinates.reason, instance.complete, kind.body),
    )


@lru_cache(KEPT)
def _equations(request: _Request) -> InstanceEquations:
    instance, kind, repeated = request.instance, request.kind, request.repeated
    component, coordinates, equations = instance.component, instance.coordinates, kind.equations.expanded()
    moved = _moved(instance, kind)
    change = moved.change
    shown = component.markers if instance.moves else ()
    return InstanceEquations(
        coordinates=coordinates.coordinates,
        rows=coordinates.rows,
        coefficients=tuple(_coefficient(component.group, c) for c in moved.constants),
        definitions=moved.definitions,
        terms=tuple(_terms(equations, coordinates, change)),
        vanished=() if repeated else tuple(_vanished(equations, coordinates)),
        mass_zeros=() if repeated else tuple(_mass_zeros(equations, coordinates)),
        energies=tuple(
            sp.expand((e or sp.S.Zero).xreplace(change))
            for e in (equations.kinetic_energy, equations.strain_energy, equations.weight_energy)
        ),
        linear=tuple(sp.expand(e.xreplace(change)) for e in equations.linear_momentum),
        angular=tuple(sp.expand(e.xreplace(change)) for e in equations.angular_momentum),
        markers=tuple(_marker(component, name, moved.reasons, coordinates, change) for name in shown),
        points=moved.points,
        origin=tuple(coordinates.values[c.q] for c in component.body.motion.coordinates[:2]),
        free_residual=_free_residual(instance, equations, change) if instance.complete else (),
    )


def _free_residual(instance: BodyInstance, equations: Equations, change: Symbols) -> tuple[sp.Expr, ...]:
    rows = instance.component.body.motion.rows[:3]
    return tuple(sp.expand(equations.sum_of(row.name).xreplace(change)) for row in rows)


def point_motions(instance: BodyInstance, kind: BodyKind) -> Mapping[str, PointMotion]:
    """The motions of the markers of an instance in the coordinates of the mechanism."""
    return _moved(instance, kind).points


@dataclass(frozen=True)
class _Moved:
    """The kinematics of an instance: replacements for the symbols of its kind, and the motions of its markers."""

    change: Symbols
    constants: tuple[ModelConstant, ...]
    definitions: tuple[Intermediate, ...]
    reasons: zeros.Reasons
    points: Mapping[str, PointMotion]


def _moved(instance: BodyInstance, kind: BodyKind) -> _Moved:
    component, coordinates, motion = instance.component, instance.coordinates, kind.motion
    of_body = component.body.constants
    reasons = zeros.reasons_of(of_body)
    of_points = tuple(c for s in component.sections.values() for c in (*s.point.coefficients, *s.rotations))
    change: Symbols = {**coordinates.values, **_renamed(component.group, (*of_body, *of_points))}
    definitions = list(coordinates.definitions)
    own = kind.equations.expanded().definitions if instance.has_inertia else motion.rotation_definitions
    definitions += _definitions(component.name, own, change)
    reasons |= zeros.reasons_of(of_points)
    points = {}
    for name, section in component.sections.items():
        moved = point_motion(motion, section.point, section.rotations, reasons)
        definitions += _definitions(component.name, moved.definitions, change)
        points[name] = moved.replaced(change)
    constants = (*(of_body if instance.has_inertia else ()), *of_points)
    return _Moved(change, constants, tuple(definitions), reasons, points)


def _renamed(group: str, coefficients: tuple[ModelConstant, ...]) -> Symbols:
    return {c.symbol: owned(c.symbol, group) for c in coefficients if not _is_shared(c)}


def _is_shared(c: ModelConstant) -> bool:
    """Whether all bodies share a coefficient: gravity is resolved in the inertial frame."""
    return identity(c.symbol).family is Family.GRAVITY


def _coefficient(group: str, c: ModelConstant) -> ModelConstant:
    if _is_shared(c):
        return c
    return replace(c, symbol=owned(c.symbol, group), doc=f"{c.doc}; {group}")


def _definitions(
    name: str, definitions: tuple[Intermediate, ...], change: Symbols, point: str = ""
) -> list[Intermediate]:
    """Definitions under names of the scene; `change` receives their symbols, or the values of constant ones."""
    result = []
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
        result.append(replace(d, symbol=symbol, expr=expr, section=f"{where} {d.section}"))
    return result


def _terms(equations: Equations, coordinates: CoordinateMap, change: Symbols) -> list[Term]:
    result = []
    for row, weights in zip(coordinates.rows, coordinates.weights, strict=True):
        for old, weight in weights.items():
            for term in equations.terms:
                expr = sp.expand(weight * term.expr.xreplace(change)) if term.row == old else sp.S.Zero
                if expr != 0:
                    result.append(replace(term, row=row.name, expr=expr))
    return result


def _kept(coordinates: CoordinateMap) -> dict[str, str]:
    """The rows that correspond to a single row of the free body, by the name of that row."""
    result = {}
    for row, weights in zip(coordinates.rows, coordinates.weights, strict=True):
        if len(weights) == 1:
            result[next(iter(weights))] = row.name
    return result


def _vanished(equations: Equations, coordinates: CoordinateMap) -> list[Vanished]:
    names = _kept(coordinates)
    return [replace(v, term=replace(v.term, row=names[v.term.row])) for v in equations.vanished if v.term.row in names]


def _mass_zeros(equations: Equations, coordinates: CoordinateMap) -> list[tuple[str, str, Reason]]:
    names, rows = _kept(coordinates), [row.name for row in equations.rows]
    return [
        (names[rows[i]], names[rows[j]], why)
        for i, j, why in equations.mass_zeros
        if rows[i] in names and rows[j] in names
    ]


def _marker(
    component: Component, name: str, reasons: zeros.Reasons, coordinates: CoordinateMap, change: Symbols
) -> MarkerEquations:
    """A marker with its Jacobian and load in the coordinates that the body keeps."""
    free = marker(component.body.motion, component.sections[name].point, reasons)
    own = dict(change)
    definitions = tuple(_definitions(component.name, free.definitions, own, name))
    force_definitions = tuple(_definitions(component.name, free.force_definitions, own, name))
    rows = [row.name for row in component.body.motion.rows]

    def combined(values: Mapping[str, sp.Expr], weights: Mapping[str, sp.Expr]) -> sp.Expr:
        return sp.expand(sp.Add(*(w * values[old].xreplace(own) for old, w in weights.items())))

    load = dict(zip(rows, free.load, strict=True))
    columns = {row: free.jacobian[:, j] for j, row in enumerate(rows)}
    jacobian = [
        [combined({old: column[i] for old, column in columns.items()}, weights) for weights in coordinates.weights]
        for i in range(2)
    ]
    return replace(
        free,
        name=f"{component.specified}_{name}",
        doc=f"{free.doc} of {component.name}",
        definitions=definitions,
        position=_vector(free.position, own),
        velocity=_vector(free.velocity, own),
        jacobian=sp.ImmutableMatrix(jacobian),
        force_definitions=force_definitions,
        load=tuple(combined(load, weights) for weights in coordinates.weights),
    )


def _vector(column: sp.ImmutableMatrix, change: Symbols) -> sp.ImmutableMatrix:
    return sp.ImmutableMatrix(column.applyfunc(lambda e: sp.expand(e.xreplace(change))))
