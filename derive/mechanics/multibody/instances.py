"""The equations of an instance of a body: those of its kind in the coordinates and symbols of the mechanism."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeAlias

from derive.algebra import sp
from derive.mechanics.motion.material_points import marker
from derive.mechanics.motion.vectors import cross
from derive.mechanics.multibody.kinds import KEPT, BodyInstance, BodyKind
from derive.mechanics.multibody.point_motion import PointMotion, point_motion
from derive.mechanics.multibody.space.frame_motion import FrameMotion, frame_motion
from derive.mechanics.multibody.space.own_axes import own_axes
from derive.mechanics.multibody.space.tree.carried_motion import CarriedMotion, TreeDefinitions, carried_frame
from derive.mechanics.quantity import rounded
from derive.mechanics.symbols import Family, identity, owned
from derive.spec.model.instances import identifier, joined

if TYPE_CHECKING:
    from derive.mechanics.equations import Equations
    from derive.mechanics.multibody.coordinates import CoordinateMap
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

Symbols: TypeAlias = "dict[sp.Basic, sp.Basic]"
SPACE = 3
"""The dimension of space, in which the markers of bodies are frames."""


@dataclass(frozen=True)
class InstanceEquations:
    """The contribution of an instance to the equations of a mechanism.

    `points` are the motions of its markers, in space `frames`, and `origin` is c; `rates` are the time derivatives of
    the coordinates. `free_residual` are the rows of c1, c2 and phi of the free
    body: the force and the torque about c that move it as it moves, besides gravity (N, N m); only if it is `complete`.
    `moved_by` are the rows that move it, in the order of the columns of its markers.
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
    mass_moments: tuple[sp.Expr, ...]
    markers: tuple[MarkerEquations, ...]
    points: Mapping[str, PointMotion]
    frames: Mapping[str, FrameMotion]
    rates: tuple[sp.Expr, ...]
    origin: tuple[sp.Expr, ...]
    free_residual: tuple[sp.Expr, ...]
    moved_by: tuple[EquationOfMotion, ...]

    @property
    def motions(self) -> Mapping[str, Any]:
        """The motions of its markers: those of points in the plane, of frames in space."""
        return self.points or self.frames


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
        *(coordinates.reason, coordinates.attitude, coordinates.carried, instance.complete, kind.body),
    )


@lru_cache(KEPT)
def _equations(request: _Request) -> InstanceEquations:
    instance, kind, repeated = request.instance, request.kind, request.repeated
    component, coordinates, equations = instance.component, instance.coordinates, kind.equations.expanded()
    change, motions = _moved(instance, kind)
    of_body = component.body.constants if instance.has_inertia else ()
    in_space = kind.motion.rotation.rows == SPACE
    energies = (equations.kinetic_energy, equations.strain_energy, equations.weight_energy)
    changed = change if coordinates.carried is None else change.named  # names of the tree leave nothing to expand
    return InstanceEquations(
        coordinates=coordinates.coordinates,
        rows=coordinates.rows,
        coefficients=tuple(_coefficient(component.group, c) for c in (*of_body, *component.point_constants)),
        definitions=tuple(change.definitions),
        terms=tuple(_terms(equations, coordinates, change)),
        vanished=() if repeated else tuple(_vanished(equations, coordinates)),
        mass_zeros=() if repeated else tuple(_mass_zeros(equations, coordinates)),
        energies=tuple(changed(e or sp.S.Zero) for e in energies),
        linear=tuple(map(changed, equations.linear_momentum)),
        angular=tuple(map(changed, equations.angular_momentum)),
        mass_moments=tuple(map(change, equations.mass_moments)),
        markers=tuple(_markers(instance, kind, change, motions)) if instance.moves else (),
        points={} if in_space else motions,
        frames=motions if in_space else {},
        rates=_rates(coordinates, kind, change),
        origin=tuple(coordinates.values[c.q] for c in kind.motion.coordinates[: kind.motion.rotation.rows]),
        free_residual=tuple(changed(equations.sum_of(row.name)) for row in kind.motion.rigid_rows)
        if instance.complete
        else (),
        moved_by=coordinates.rows if coordinates.carried is None else coordinates.carried.rows,
    )


def point_motions(instance: BodyInstance, kind: BodyKind) -> Mapping[str, Any]:
    """The motions of the markers of an instance in the coordinates of the mechanism; in space those of their frames."""
    _, points = _moved(instance, kind)
    return points


def _rates(coordinates: CoordinateMap, kind: BodyKind, change: _Change) -> tuple[sp.Expr, ...]:
    """The time derivatives of the coordinates: velocities, but those of a quaternion follow from the spin."""
    own = {
        coordinates.values.get(c.q): rate for c, rate in zip(kind.motion.coordinates, kind.motion.rates, strict=True)
    }
    rows = {row.v.identity: row.v for row in coordinates.rows}
    result = []
    for c in coordinates.coordinates:
        rate = rows.get(replace(c.q.identity, derivative=1))
        result.append(change(own[c.q]) if rate is None else rate)
    return tuple(result)


class _Change:
    """A change of symbols from those of a kind to those of an instance, which applies to expressions of the kind.

    It renames the symbols of an instance that keeps its coordinates. Where a joint supports the instance, symbols
    become expressions or numbers, and definitions that are numbers then have no symbols of their own. `definitions` are
    those of the instance, in the order in which they follow from each other.
    """

    def __init__(self, name: str, values: Symbols, definitions: Iterable[Intermediate] = ()) -> None:
        self.name, self.values, self.definitions = name, dict(values), list(definitions)
        self._renames = all(value.is_Symbol for value in self.values.values())

    def __call__(self, expr: sp.Expr) -> sp.Expr:
        """An expanded expression of the kind in symbols of the instance, expanded, which new names alone leave it."""
        changed = expr.xreplace(self.values)
        return changed if self._renames else sp.expand(changed)

    def named(self, expr: sp.Expr) -> sp.Expr:
        """An expression of the kind in symbols of the instance, not expanded."""
        return expr.xreplace(self.values)

    def define(self, definitions: Iterable[Intermediate], point: str = "") -> None:
        """Add definitions of the kind, or of one of its points, under names of the instance."""
        for d in definitions:
            if d.zero:
                continue
            expr = rounded(sp.expand(d.expr.xreplace(self.values)))
            if expr.is_Rational or expr.is_Symbol:
                self.values[d.symbol] = expr
                self._renames &= expr.is_Symbol
                continue
            symbol = self.values[d.symbol] = owned(d.symbol, self.name, point)
            where = f"{self.name}_{point}" if point else self.name
            self.definitions.append(replace(d, symbol=symbol, expr=expr, section=f"{where} {d.section}"))


def _moved(instance: BodyInstance, kind: BodyKind) -> tuple[_Change, Mapping[str, Any]]:
    """The kinematics of an instance: what the symbols of its kind become, and the motions of its cross-sections."""
    in_space = kind.motion.rotation.rows == SPACE
    component, coordinates = instance.component, instance.coordinates
    constants = (*component.body.constants, *component.point_constants)
    renamed = {c.symbol: owned(c.symbol, component.group) for c in constants if not _is_shared(c)}
    change = _Change(component.name, {**coordinates.values, **renamed}, coordinates.definitions)
    if coordinates.attitude is not None:
        change.values |= dict(zip(kind.motion.rotation, coordinates.attitude, strict=True))
    rotation = () if coordinates.attitude is not None else kind.motion.rotation_definitions
    definitions = kind.equations.expanded().definitions if instance.has_inertia else rotation
    entries = set() if coordinates.attitude is None else set(kind.motion.rotation)
    if coordinates.carried is not None:
        change.define(rotation)
        change.definitions += coordinates.carried.definitions
        entries |= change.values.keys()
    change.define(d for d in definitions if d.symbol not in entries)
    if coordinates.carried is not None:
        return change, _carried_frames(instance, change, coordinates.carried)
    points: dict[str, Any] = {}
    weights = [(row.name, of) for row, of in zip(coordinates.rows, coordinates.weights, strict=True)]
    free = coordinates.weights == tuple({row.name: sp.S.One} for row in kind.motion.rows)
    names = {old.name: row.name for old, row in zip(kind.motion.rows, coordinates.rows, strict=False)}
    for name, section in component.sections.items():
        if in_space:
            moving = frame_motion(kind.motion, section)
            change.define(d for d in moving.definitions if d.symbol not in change.values)
            own = own_axes(kind.motion, section, names, change.named) if free else None
            points[name] = replace(moving.replaced(change.named, weights), own=own)
            continue
        motion = point_motion(kind.motion, section.point, section.rotations)
        change.define(motion.definitions)
        points[name] = motion.replaced(change.values)
    return change, points


def _carried_frames(instance: BodyInstance, change: _Change, of: CarriedMotion) -> dict[str, FrameMotion]:
    """The motions of the marker frames of a body in a tree, whose definitions are added to those of the body."""
    frames = {}
    for name, section in instance.component.sections.items():
        vanishing = {c.symbol: sp.S.Zero for c in section.point.coefficients if c.zero}
        position = sp.Matrix(section.point.position.xreplace(vanishing)).applyfunc(change.named)
        define = TreeDefinitions(instance.name)
        frames[name] = carried_frame(of, section, position, name, define)
        change.definitions += define.made
    return frames


def _is_shared(c: ModelConstant) -> bool:
    """Whether all bodies share a coefficient: gravity is resolved in the inertial frame."""
    return identity(c.symbol).family is Family.GRAVITY


def _coefficient(group: str, c: ModelConstant) -> ModelConstant:
    if _is_shared(c):
        return c
    return replace(c, symbol=owned(c.symbol, group), doc=f"{c.doc}; {group}")


def _terms(equations: Equations, coordinates: CoordinateMap, change: _Change) -> Iterator[Term]:
    for row, weights in zip(coordinates.rows, coordinates.weights, strict=True):
        for old, weight in weights.items():
            for term in (term for term in equations.terms if term.row == old):
                expr = change(weight * term.expr)
                if expr != 0:
                    yield replace(term, row=row.name, expr=expr)


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


def _markers(
    instance: BodyInstance, kind: BodyKind, change: _Change, motions: Mapping[str, Any]
) -> Iterator[MarkerEquations]:
    """The markers that the specification declares."""
    carried = instance.coordinates.carried
    for name in instance.component.markers:
        if carried is None:
            yield _marker(instance, kind, name, change, motions[name])
        else:
            yield _carried_marker(instance, kind, name, motions[name], carried)


def _carried_marker(
    instance: BodyInstance, kind: BodyKind, name: str, frame: FrameMotion, of: CarriedMotion
) -> MarkerEquations:
    """A marker of a body in a tree, with a column of its Jacobian for each row that moves the body."""
    free = marker(kind.motion, instance.component.sections[name].point)
    columns = [v.translation + cross(v.rotation, frame.lever) for v in of.virtual]
    force = sp.Matrix(free.force)
    return replace(
        free,
        name=identifier(instance.component.specified, name),
        shown=joined(instance.component.specified, name),
        doc=f"{free.doc} of {instance.component.name}",
        definitions=(),
        position=frame.position,
        velocity=frame.velocity,
        jacobian=sp.ImmutableMatrix.hstack(*columns),
        force_definitions=(),
        load=tuple(total for _, total in _works(frame, force)),
        angular_velocity=frame.angular_velocity,
    )


def _works(frame: FrameMotion, force: sp.Matrix) -> Iterator[tuple[str, sp.Expr]]:
    """The virtual work of a force at a marker on each row that moves its body, zero as well."""
    works = dict(frame.work(force, sp.zeros(3, 1)))
    yield from ((v.row, works.get(v.row, sp.S.Zero)) for v in frame.virtual)


def _marker(instance: BodyInstance, kind: BodyKind, name: str, change: _Change, motion: Any) -> MarkerEquations:
    """A marker with its Jacobian and load in the coordinates that the body keeps; motion: that of its frame."""
    component, free = instance.component, marker(kind.motion, instance.component.sections[name].point)
    own = _Change(component.name, change.values)
    own.define(free.definitions, name)
    of_force = _Change(component.name, own.values)
    of_force.define(free.force_definitions, name)
    numbers = {row.name: i for i, row in enumerate(kind.motion.rows)}

    def combined(values: Sequence[sp.Expr]) -> list[sp.Expr]:
        """The sums of the values of the rows of the free body that make up each row of the instance."""
        every = instance.coordinates.weights
        return [of_force(sp.Add(*(w * values[numbers[row]] for row, w in weights.items()))) for weights in every]

    return replace(
        free,
        name=identifier(component.specified, name),
        shown=joined(component.specified, name),
        doc=f"{free.doc} of {component.name}",
        definitions=tuple(own.definitions),
        position=free.position.applyfunc(own),
        velocity=free.velocity.applyfunc(own),
        jacobian=sp.ImmutableMatrix([combined(free.jacobian[i, :]) for i in range(free.jacobian.rows)]),
        force_definitions=tuple(of_force.definitions),
        load=tuple(combined(free.load)),
        angular_velocity=sp.ImmutableMatrix([motion.angular_velocity]),
    )
