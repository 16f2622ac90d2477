"""The equations of motion of a scene: those of its bodies one after the other, with constraints and multipliers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain

import sympy as sp

from derive.errors import Problem, SpecError
from derive.mechanics import quantity
from derive.mechanics.bodies.beam import shape_text
from derive.mechanics.equations import (
    Coefficient,
    Constraint,
    Coordinate,
    Definition,
    Equations,
    LeftOut,
    MarkerEquations,
    Pose,
    Row,
    Term,
)
from derive.mechanics.multibody import components as members
from derive.mechanics.multibody import coordinates as held
from derive.mechanics.multibody import forces as actions
from derive.mechanics.multibody.components import BASE, Member
from derive.mechanics.multibody.constraints import constraints, drive_motion
from derive.mechanics.multibody.instances import Placed, placed
from derive.mechanics.multibody.joint_elimination import Reduced, ground, reduced
from derive.mechanics.multibody.point_motion import PointMotion
from derive.mechanics.multibody.time_functions import function
from derive.mechanics.reference_conditions import assumed_shapes
from derive.mechanics.symbols import Symbol, element, t
from derive.mechanics.virtual_work_equations import equations as equations_of
from derive.spec.model.body import Parameter, Quantity
from derive.spec.model.scene import (
    GROUND,
    SPRING_UNITS,
    BeamBody,
    Drive,
    Joint,
    MarkerRef,
    RigidBody,
    Scene,
    TimeFunction,
)

Points = Mapping[str, Mapping[str, PointMotion]]

BETWEEN_BODIES = "bodies share no inertia: joints couple them through constraints"


def derive(scene: Scene) -> Equations:
    """The equations of motion of a scene. Raises SpecError with what does not go together."""
    return _Assembly(scene).equations()


class _Assembly:
    """A scene while its bodies are placed, one after the other."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.parameters = members.parameters(scene)
        self.constants: list[Coefficient] = []
        self.gravity, _ = quantity.gravity(scene.gravity)
        self.rods = {body.name: body for body in scene.bodies if isinstance(body, BeamBody)}
        self.joints = [*scene.joints, *chain.from_iterable(members.welds(rod) for rod in self.rods.values())]
        self.joints = [replace(j, first=self._place(j.first), second=self._place(j.second)) for j in self.joints]
        self.drives = {d.joint: drive_motion(self._motion(d), d.name) for d in scene.drives}
        self.points: dict[str, Mapping[str, PointMotion]] = {GROUND: ground(self._ground())}
        self.bodies: dict[str, Placed] = {}
        self.left_out = [LeftOut(GROUND, "it does not move: no coordinates")]
        self.used_joints: set[str] = set()
        self.used_drives: set[str] = set()

    def equations(self) -> Equations:
        """Place all bodies, then join them."""
        self._place_held()
        for body in self.scene.bodies:
            if body.name in self.bodies:
                continue
            if isinstance(body, BeamBody):
                self._place_rod(body)
            else:
                self._weighed(body)
                member = members.rigid_member(body, None, self.gravity)
                self._add(member, held.free(body.name, member.body.motion))
        self._order()
        rows = tuple(row for body in self.bodies.values() for row in body.rows)
        if not rows:
            raise SpecError((Problem("drives", "all motion is prescribed; nothing is left to be computed"),))
        own, found = self._constraints(rows)
        forces = self._actions(rows)
        return self._gathered(rows, own, found, forces)

    # ---- bodies ----

    def _place_held(self) -> None:
        """Bodies that joints hold to what is known already, until no more are found."""
        waiting = [b for b in self.scene.bodies if isinstance(b, RigidBody) and not b.keep_coordinates]
        while step := next(filter(None, (self._held(b, j) for b in waiting for j in self.joints)), None):
            body, one = step
            waiting.remove(body)
            self.used_joints.add(one.joint)
            self.used_drives |= {one.drive} if one.drive else set()
            self.left_out.append(one.left_out)
            if one.held.rows:
                self._weighed(body)
            self._add(one.member, one.held)

    def _held(self, body: RigidBody, joint: Joint) -> tuple[RigidBody, Reduced] | None:
        if joint.name in self.used_joints:
            return None
        known = {name: self.points[name] for name in self.points if name == GROUND or not self.bodies[name].rows}
        one = reduced(body, joint, known, self.drives.get(joint.name), self.gravity)
        return (body, one) if one else None

    def _weighed(self, body: RigidBody) -> None:
        """A body that moves needs what it weighs."""
        missing = [what for what in ("mass", "inertia") if getattr(body, what) is None]
        if missing:
            text = f"{body.name} moves freely and needs {' and '.join(missing)}"
            raise SpecError((Problem(f"bodies.{body.name}", text),))

    def _place_rod(self, rod: BeamBody) -> None:
        pieces = members.beam_members(rod, self.gravity)
        derived = equations_of(pieces[0].body)  # once for all pieces
        for k, piece in enumerate(pieces):
            self._add(piece, held.free(piece.name, piece.body.motion), derived)
            if k:  # what holds of the first piece holds of all
                self.bodies[piece.name] = replace(self.bodies[piece.name], vanished=(), mass_zeros=())

    def _add(self, member: Member, keeps: held.Held, derived: Equations | None = None) -> None:
        body = placed(member, derived or equations_of(member.body), keeps)
        self.bodies[member.name] = body
        self.points[member.name] = body.points

    def _order(self) -> None:
        """Bodies in the order of the specification; definitions of held ones come first, since others build on them."""
        names = [n for b in self.scene.bodies for n in self._names(b)]
        self.made = tuple(self.bodies)
        self.bodies = {name: self.bodies[name] for name in names}

    def _names(self, body: RigidBody | BeamBody) -> list[str]:
        if isinstance(body, RigidBody):
            return [body.name]
        return [members.piece_name(body, k) for k in range(body.pieces)]

    # ---- joints, drives and forces ----

    def _constraints(self, rows: tuple[Row, ...]) -> tuple[tuple[Definition, ...], tuple[Constraint, ...]]:
        definitions: list[Definition] = []
        found: list[Constraint] = []
        for joint in self.joints:
            if joint.name in self.used_joints:
                continue
            first, second = self._at(joint.first), self._at(joint.second)
            own, some = constraints(joint, first, second, self.drives.get(joint.name), rows)
            definitions += own
            found += some
        idle = [c for c in found if not c.jacobian]
        if idle:
            text = (
                "no coordinate can meet it, since the motion of both bodies is prescribed; leave out a drive or a joint"
            )
            raise SpecError(tuple(Problem(f"joints.{c.of}", f"{c.doc}: {text}") for c in idle))
        return tuple(definitions), tuple(found)

    def _actions(self, rows: tuple[Row, ...]) -> list[actions.Action]:
        scene = self.scene
        for name, of in _functions_of(scene):
            _function(of, name)
        found = [actions.force(f, self._at(self._place(f.at)), rows) for f in scene.forces]
        for torque in scene.torques:
            against = self._at(self._place(torque.against)) if torque.against else None
            found.append(actions.torque(torque, self._at(self._place(torque.at)), against, rows))
        for spring in scene.springs:
            constants = tuple(
                self._constant(
                    element(spring.name, what), getattr(spring, what), f"{what} of spring {spring.name}", unit
                )
                for what, unit in SPRING_UNITS[spring.kind].items()
            )
            ends = self._at(self._place(spring.first)), self._at(self._place(spring.second))
            found.append(actions.spring(spring, *ends, constants, rows))
        return found

    def _at(self, place: MarkerRef) -> PointMotion:
        return self.points[place.body][place.marker]

    def _place(self, place: MarkerRef) -> MarkerRef:
        return members.place_of(place, self.rods)

    def _ground(self) -> dict[str, sp.Matrix]:
        doc = "point of the ground along e"
        return {
            p.name: sp.Matrix(
                [self._constant(element(GROUND, p.name, k), x, f"{doc}{k}", "m") for k, x in enumerate((p.x, p.y), 1)]
            )
            for p in self.scene.ground
        }

    def _motion(self, drive: Drive) -> sp.Expr:
        if drive.motion is not None:
            return _function(drive.motion, f"drives.{drive.name}.motion")
        assert drive.speed is not None
        speed = self._constant(element(drive.name, "speed"), drive.speed, f"speed of drive {drive.name}", "")
        return speed * t + sp.Rational(drive.offset)

    def _constant(self, symbol: Symbol, value: Quantity, doc: str, unit: str) -> sp.Expr:
        """A number as it is; a parameter as a coefficient, under which kernels know it."""
        if not isinstance(value, Parameter):
            return sp.Rational(value)
        self.constants.append(Coefficient(symbol, quantity.value(value, False), "", doc, unit or value.unit))
        return symbol

    # ---- all together ----

    def _gathered(
        self,
        rows: tuple[Row, ...],
        of_joints: tuple[Definition, ...],
        found: tuple[Constraint, ...],
        forces: list[actions.Action],
    ) -> Equations:
        bodies = list(self.bodies.values())
        made = [self.bodies[name] for name in self.made]
        definitions = tuple(chain(*(b.definitions for b in made), of_joints, *(a.definitions for a in forces)))
        moving = _moving(definitions)
        coefficients = self._coefficients(bodies)
        _distinct(rows, found, coefficients, definitions)

        def summed(of: Iterable[sp.Expr]) -> sp.Expr:
            """What does not depend on time alone; a prescribed motion brings and takes energy as it needs."""
            return sp.Add(*(e for e in of if not e.free_symbols & moving))

        terms = (*chain.from_iterable(b.terms for b in bodies), *chain.from_iterable(a.terms for a in forces))
        of_bodies = [b for b in bodies if b.rows]
        kinetic, strain, weight = (summed(b.energies[k] for b in of_bodies) for k in range(3))
        place = {row.name: i for i, row in enumerate(rows)}
        coordinates = tuple(c for b in bodies for c in b.coordinates)
        return Equations(
            name=self.scene.name,
            doc=_doc(self.scene, coordinates, found),
            origin=_origin(self.scene),
            coordinates=coordinates,
            rows=rows,
            rates=tuple(row.v for row in rows),
            parameters=self.parameters,
            coefficients=coefficients,
            definitions=definitions,
            terms=terms,
            vanished=tuple(v for b in bodies for v in b.vanished),
            mass=_mass(rows, terms),
            mass_zeros=tuple((place[i], place[j], why) for b in bodies for i, j, why in b.mass_zeros),
            kinetic_energy=kinetic,
            strain_energy=strain + summed(a.potential for a in forces),
            weight_energy=weight if self.scene.gravity else None,
            linear_momentum=tuple(summed(b.linear[k] for b in of_bodies) for k in range(2)),
            angular_momentum=(summed(b.angular[0] for b in of_bodies),),
            markers=tuple(m for m in _markers(bodies) if not _depends(m.definitions, m.position, moving)),
            constraints=found,
            poses=self._poses(),
            left_out=(*self.left_out, *self._carried(moving)),
        )

    def _carried(self, moving: frozenset[sp.Symbol]) -> list[LeftOut]:
        """Bodies that stand on what a drive moves: functions without t cannot speak of them."""
        reason = "a drive carries it along, and these functions know no time"
        names = [name for name, body in self.bodies.items() if body.rows and _of_time(body, moving)]
        return [LeftOut(f"{name} in energy, momentum and markers", reason) for name in names]

    def _coefficients(self, bodies: list[Placed]) -> tuple[Coefficient, ...]:
        """Each symbol once, with one symbol for each parameter, whatever it is assumed to be where it is used."""
        canonical = {p.symbol.name: p.symbol for p in self.parameters}
        found: dict[sp.Symbol, Coefficient] = {}
        for c in (*self.constants, *chain.from_iterable(b.coefficients for b in bodies)):
            known = {s: canonical[s.name] for s in c.value.free_symbols if s.name in canonical}
            found.setdefault(c.symbol, replace(c, value=c.value.xreplace(known)))
        return tuple(found.values())

    def _poses(self) -> tuple[Pose, ...]:
        found = []
        for name, body in self.bodies.items():
            if BASE in body.points:
                base = body.points[BASE]
                found.append(Pose(name, (base.position[0], base.position[1]), base.turn))
            else:
                c1, c2, phi = (c.q for c in body.coordinates[:3])
                found.append(Pose(name, (c1, c2), phi))
        return tuple(found)


def _distinct(
    rows: tuple[Row, ...],
    found: tuple[Constraint, ...],
    coefficients: tuple[Coefficient, ...],
    definitions: tuple[Definition, ...],
) -> None:
    """Names that are joined of others may meet; then one of the two has to be called otherwise."""
    names = [str(s) for row in rows for s in (row.name, row.v, row.a)]
    names += [c.name for c in found] + [str(c.symbol) for c in coefficients] + [str(d.symbol) for d in definitions]
    twice = sorted(name for name, count in Counter(names).items() if count > 1)
    if twice:
        text = f"two things of this scene would be called {', '.join(twice)} in the code; give one another name"
        raise SpecError((Problem("bodies", text),))


def _moving(definitions: tuple[Definition, ...]) -> frozenset[sp.Symbol]:
    """The time, and all symbols that are made of it."""
    found = {t}
    for d in definitions:
        if d.expr.free_symbols & found:
            found.add(d.symbol)
    return frozenset(found)


def _depends(definitions: tuple[Definition, ...], position: sp.ImmutableMatrix, moving: frozenset[sp.Symbol]) -> bool:
    """Whether a marker needs the time, which markers do not get."""
    every = (position.free_symbols, *(d.expr.free_symbols for d in definitions))
    return any(symbols & moving for symbols in every)


def _markers(bodies: Iterable[Placed]) -> Iterator[MarkerEquations]:
    """The markers of all bodies, with a column and a row for each coordinate of the scene."""
    bodies = tuple(bodies)
    own = [len(body.rows) for body in bodies]
    for k, body in enumerate(bodies):
        before, after = sum(own[:k]), sum(own[k + 1 :])
        for m in body.markers:
            columns = sp.zeros(2, before), m.jacobian, sp.zeros(2, after)
            load = (*[sp.S.Zero] * before, *m.load, *[sp.S.Zero] * after)
            yield replace(m, jacobian=sp.ImmutableMatrix.hstack(*columns), load=load)


def _mass(rows: tuple[Row, ...], terms: tuple[Term, ...]) -> sp.ImmutableMatrix:
    """The factors of the accelerations in each row."""
    column = {row.a: j for j, row in enumerate(rows)}
    place = {row.name: i for i, row in enumerate(rows)}
    accelerations = frozenset(column)
    entries = sp.MutableSparseMatrix(len(rows), len(rows), {})
    for term in terms:
        for a in term.expr.free_symbols & accelerations:
            entries[place[term.row], column[a]] += term.expr.coeff(a)
    return sp.ImmutableMatrix(entries.applyfunc(sp.expand))


def _functions_of(scene: Scene) -> Iterator[tuple[str, TimeFunction]]:
    """Where functions of t stand in forces and torques, and these."""
    for force in scene.forces:
        yield from ((f"forces.{force.name}.components", component) for component in force.components)
    for torque in scene.torques:
        yield f"torques.{torque.name}.value", torque.value


def _function(of: TimeFunction, path: str) -> sp.Expr:
    """A function of t. Raises SpecError where it has no value for any t."""
    expr = function(of)
    if expr.has(sp.zoo, sp.nan, sp.oo, -sp.oo, sp.I):
        raise SpecError((Problem(path, f"this is {expr} for every t; a finite function of t is needed"),))
    return expr


def _of_time(body: Placed, moving: frozenset[sp.Symbol]) -> bool:
    """Whether energy or momentum of a body depend on the time: it stands on what a drive moves."""
    return any(e.free_symbols & moving for e in (*body.energies, *body.linear, *body.angular))


def _origin(scene: Scene) -> str:
    """What one should know of the bodies' equations, in words."""
    cut = [f"{b.name}_1" for b in scene.bodies if isinstance(b, BeamBody) and b.pieces > 1]
    alike = f" What is told of {', '.join(cut)} holds of the other pieces as well." if cut else ""
    centre = "Of beams c is where the centre of the undeformed beam lies in the floating frame."
    shapes = "".join(f"\n{_shapes(b)}" for b in scene.bodies if isinstance(b, BeamBody))
    return f"{centre}{shapes}\nIn M {BETWEEN_BODIES}.{alike}"


def _shapes(rod: BeamBody) -> str:
    """The shapes of a rod as a user of the code needs them to draw it."""
    shapes = assumed_shapes(rod.beam.ansatz, rod.beam.frame, rod.beam.orthogonal)
    said = ", ".join(f"phi_{i} = {shape_text(shape)}" for i, shape in enumerate(shapes, 1))
    each = f"{rod.name}, each of {rod.pieces} pieces" if rod.pieces > 1 else rod.name
    return f"Deflection of {each}, along its e2: alpha1 phi_1 + ..., {said}; xi = 2 x / length."


def _doc(scene: Scene, coordinates: tuple[Coordinate, ...], found: tuple[Constraint, ...]) -> str:
    return (
        f"scene of {_count(scene.bodies, 'planar bod', 'y', 'ies')}: {_count(coordinates, 'coordinate')}, "
        f"{_count(found, 'constraint')}, {_count(coordinates[len(found) :], 'degree')} of freedom"
    )


def _count(things: Sequence[object], noun: str, one: str = "", many: str = "s") -> str:
    return f"{len(things)} {noun}{one if len(things) == 1 else many}"
