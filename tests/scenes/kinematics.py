"""The kinematics of the oracle: positions in a scene as functions of t and q, in numbers of 50 digits.

Which coordinates and constraints there are it is told by their names; what has no coordinates is placed by its joint.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import mpmath
from shapes import at, gauss, shapes

from derive.spec.model.joints import Joint
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.planar_bodies import BeamBody, RigidBody
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.model.scene import Scene
from derive.spec.model.time_function import TimeFunction

DIGITS = 50
Real = Any
Point = tuple[Real, Real]

CALLS: dict[str, Callable[..., Real]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "pow": lambda a, b: a**b,
    "neg": lambda a: -a,
    "sin": mpmath.sin,
    "cos": mpmath.cos,
    "sqrt": mpmath.sqrt,
    "exp": mpmath.exp,
    "log": mpmath.log,
    "tanh": mpmath.tanh,
    "abs": abs,
    "min": min,
    "max": max,
    "atan2": mpmath.atan2,
    "less": lambda a, b: a < b,
    "step": lambda x, x0, x1: smooth(min(max((x - x0) / (x1 - x0), mpmath.mpf(0)), mpmath.mpf(1))),
}


def smooth(s: Real) -> Real:
    """The integral of 30 s^2 (1 - s)^2 from 0."""
    return 10 * s**3 - 15 * s**4 + 6 * s**5


@dataclass(frozen=True)
class Pose:
    """The position of the origin of a body's frame, and the rotation angle of the frame."""

    c: Point
    phi: Real
    cos: Real
    sin: Real

    def turned(self, r: Point) -> Point:
        """Q r."""
        return self.cos * r[0] - self.sin * r[1], self.sin * r[0] + self.cos * r[1]

    def to_world(self, r: Point) -> Point:
        """c + Q r."""
        x, y = self.turned(r)
        return self.c[0] + x, self.c[1] + y


def pose(c: Point, phi: Real) -> Pose:
    """A pose with its rotation."""
    return Pose(c, phi, mpmath.cos(phi), mpmath.sin(phi))


@dataclass(frozen=True)
class Piece:
    """A piece of a rod, with the columns of its amplitudes."""

    name: str
    mass: Real
    length: Real
    bending: Real
    shapes: tuple[Any, ...]
    columns: tuple[int, ...]

    def basis(self, xi: Real) -> tuple[list[Real], list[Real]]:
        """The shapes at xi, and their derivatives by x."""
        return [at(s, xi) for s in self.shapes], [at(s, xi, 1) * 2 / self.length for s in self.shapes]


@dataclass(frozen=True)
class Spot:
    """A point of a body: r of the undeformed body, shapes and their slopes there, columns of the amplitudes."""

    body: str
    r: Point
    shapes: Sequence[Real] = ()
    slopes: Sequence[Real] = ()
    columns: Sequence[int] = ()
    arm: Real = 0

    def place(self, q: Sequence[Real]) -> Point:
        """r with the deflection, at the end of an arm that stands on the section and turns with it."""
        if not self.shapes:
            return self.r
        x, y = self.r[0], self.r[1] + sum(a * q[j] for a, j in zip(self.shapes, self.columns, strict=True))
        if not self.arm:
            return x, y
        return x - self.arm * mpmath.sin(self.slope(q)), y + self.arm * mpmath.cos(self.slope(q))

    def slope(self, q: Sequence[Real]) -> Real:
        """dv/dx."""
        return sum((a * q[j] for a, j in zip(self.slopes, self.columns, strict=True)), mpmath.mpf(0))


class Kinematics:
    """A scene as functions of t and q. `p` gives the parameters, by symbol, that are not at their defaults."""

    def __init__(
        self,
        scene: Scene,
        coordinates: Sequence[str],
        multipliers: Sequence[str],
        markers: Sequence[str] = (),
        p: Mapping[str, float] | None = None,
    ) -> None:
        self.scene, self.p, self.markers = scene, dict(p or {}), tuple(markers)
        self.column = {name: j for j, name in enumerate(coordinates)}
        self.row = {name: i for i, name in enumerate(multipliers)}
        with mpmath.workdps(DIGITS):
            self.rigid = {b.name: b for b in scene.bodies if isinstance(b, RigidBody)}
            self.rods = {b.name: self._pieces(b) for b in scene.bodies if isinstance(b, BeamBody)}
            self.pieces = {p.name: p for pieces in self.rods.values() for p in pieces}
            self.gravity = tuple(map(self.number, scene.gravity or ())) or (mpmath.mpf(0), mpmath.mpf(0))
            self.driven = {d.joint: d for d in scene.drives}
            self.cloud = self._cloud()
            self.spots = {place: self._spot(place) for place in self._places()}

    def number(self, x: Quantity | None) -> Real:
        """A quantity as it is in SI units; None is nothing."""
        if isinstance(x, Parameter):
            return mpmath.mpf(self.p.get(x.symbol, x.default))
        return mpmath.mpf(0) if x is None else mpmath.mpf(x.numerator) / x.denominator

    # ---- bodies

    def _pieces(self, rod: BeamBody) -> list[Piece]:
        beam, n = rod.beam, rod.pieces
        names = [rod.name] if n == 1 else [f"{rod.name}_{k}" for k in range(1, n + 1)]
        mass, length, bending = map(self.number, (beam.mass, beam.length, beam.bending_stiffness))
        found = shapes(beam)
        columns = [tuple(self.column[f"{name}_alpha{i}"] for i in range(1, len(found) + 1)) for name in names]
        return [
            Piece(name, mass / n, length / n, bending, found, own) for name, own in zip(names, columns, strict=True)
        ]

    def _cloud(self) -> list[tuple[Real, Spot]]:
        """Masses and their places."""
        found = [
            (piece.mass * w / 2, self._in_piece(piece, xi)) for piece in self.pieces.values() for xi, w in gauss(DIGITS)
        ]
        self.on_axes = len(found)  # what follows are attached masses and rigid bodies
        for name, pieces in self.rods.items():
            rod = next(b for b in self.scene.bodies if b.name == name)
            for m in rod.beam.masses:
                mass, inertia = self.number(m.mass), self.number(m.inertia)
                spot, arm = self._in_rod(pieces, m.at), mpmath.sqrt(inertia / mass)
                found += [(mass / 2, replace(spot, arm=side * arm)) for side in (1, -1)]
        for name, body in self.rigid.items():
            mass, inertia = self.number(body.mass), self.number(body.inertia)
            if mass:
                x, y, arm = *map(self.number, body.centre), mpmath.sqrt(inertia / mass)
                found += [(mass / 2, Spot(name, (x, y + side * arm))) for side in (1, -1)]
        return found

    def _in_piece(self, piece: Piece, xi: Real) -> Spot:
        return Spot(piece.name, (xi * piece.length / 2, mpmath.mpf(0)), *piece.basis(xi), piece.columns)

    def _in_rod(self, pieces: Sequence[Piece], at_xi: Any) -> Spot:
        """The point of a rod at xi; where two pieces meet, that of the left one."""
        along = (at_xi + 1) / 2 * len(pieces)
        k = next(k for k in range(len(pieces)) if along <= k + 1)
        xi = 2 * (along - k) - 1
        return self._in_piece(pieces[k], mpmath.mpf(xi.numerator) / xi.denominator)

    def _places(self) -> set[MarkerRef]:
        """All places that anybody speaks of."""
        scene = self.scene
        pairs = [p for one in (*scene.joints, *scene.springs) for p in (one.first, one.second)]
        return {*pairs, *self._acted_on()}

    def _spot(self, place: MarkerRef) -> Spot:
        """The point of a body, or of a piece of a rod; where two pieces meet, that of the left one."""
        if place.body in self.rods:
            pieces = self.rods[place.body]
            rod = next(b for b in self.scene.bodies if b.name == place.body)
            return self._in_rod(pieces, next(m.at for m in rod.beam.markers if m.name == place.marker))
        points = self.scene.ground if place.body == GROUND else self.rigid[place.body].markers
        point = next(m for m in points if m.name == place.marker)
        return Spot(place.body, (self.number(point.x), self.number(point.y)))

    # ---- kinematics: functions of t and q

    def motion(self, name: str, t: Real) -> Real:
        """The displacement or rotation that a drive prescribes."""
        drive = self.driven[name]
        if drive.motion is not None:
            return self.of_time(drive.motion, t)
        return self.number(drive.speed) * t + self.number(drive.offset)

    def of_time(self, f: TimeFunction, t: Real) -> Real:
        """A function of t."""
        match f.kind:
            case "number":
                return self.number(f.value)
            case "t":
                return t
            case "parameter":
                return self.number(f.parameter)
            case "piecewise":
                pairs = zip(f.args[:-1:2], f.args[1::2], strict=True)
                return self.of_time(next((then for when, then in pairs if self.of_time(when, t)), f.args[-1]), t)
            case "spline":
                x = self.of_time(f.args[0], t)
                knots = f.spline.knots
                x = min(max(x, mpmath.mpf(knots[0])), mpmath.mpf(knots[-1]))
                i = next(i for i in range(len(knots) - 1) if x <= knots[i + 1])
                return sum(c * (x - knots[i]) ** n for n, c in enumerate(map(mpmath.mpf, f.spline.coefficients[i])))
        return CALLS[f.kind](*(self.of_time(a, t) for a in f.args))

    def poses(self, t: Real, q: Sequence[Real]) -> dict[str, Pose]:
        """The poses of all bodies. Beams have their origin in their middle, rigid bodies where markers count from."""
        zero = mpmath.mpf(0)
        found = {GROUND: pose((zero, zero), zero)}
        for name in self.pieces:
            found[name] = pose(*self._coordinates(name, q))
        waiting = []
        for name, body in self.rigid.items():
            if f"{name}_c1" in self.column:  # a free body: its coordinates are those of its centre of mass
                c, phi = self._coordinates(name, q)
                x, y = pose(c, phi).turned(tuple(map(self.number, body.centre)))
                found[name] = pose((c[0] - x, c[1] - y), phi)
            else:
                waiting.append(name)
        while waiting:
            name = next(n for n in waiting if self._held_by(n, found))
            found[name] = self._held(name, self._held_by(name, found), t, q, found)
            waiting.remove(name)
        return found

    def _coordinates(self, name: str, q: Sequence[Real]) -> tuple[Point, Real]:
        c1, c2, phi = (q[self.column[f"{name}_{x}"]] for x in ("c1", "c2", "phi"))
        return (c1, c2), phi

    def _held_by(self, name: str, known: Mapping[str, Pose]) -> Joint | None:
        """The joint that places a body: one without multipliers, to a body that is placed already."""
        for joint in self.scene.joints:
            ends = {joint.first.body, joint.second.body}
            if name in ends and ends - {name} <= set(known) and not self._names(joint) & set(self.row):
                return joint
        return None

    def _held(self, name: str, joint: Joint, t: Real, q: Sequence[Real], known: Mapping[str, Pose]) -> Pose:
        """The pose that the joint asks for, with the coordinate that is left."""
        other, here = (joint.first, joint.second) if joint.second.body == name else (joint.second, joint.first)
        sign = 1 if joint.second.body == name else -1
        base = known[other.body]
        x = base.to_world(self.spots[other].r)
        if joint.kind == "revolute":
            drive = joint.name in self.driven
            phi = base.phi + sign * self.motion(joint.name, t) if drive else q[self.column[f"{name}_phi"]]
        else:
            phi = base.phi + sign * mpmath.mpf(joint.angle)
        if joint.kind == "translational":
            assert sign == 1
            s = self.motion(joint.name, t) if joint.name in self.driven else q[self.column[f"{name}_s"]]
            along = base.turned(self._axis(joint))
            x = (x[0] + s * along[0], x[1] + s * along[1])
        arm = pose(x, phi).turned(self.spots[here].r)
        return pose((x[0] - arm[0], x[1] - arm[1]), phi)

    def _axis(self, joint: Joint) -> Point:
        x, y = map(self.number, joint.axis)
        length = mpmath.sqrt(x * x + y * y)
        return x / length, y / length

    def _names(self, joint: Joint) -> set[str]:
        """All multipliers that a joint may have."""
        ends = ("_1", "_2") if joint.kind == "revolute" else ("_1", "_2", "_turn")
        ends = ("_normal", "_turn") if joint.kind == "translational" else ends
        names = {f"{joint.name}{end}" for end in ends}
        return names | ({self.driven[joint.name].name} if joint.name in self.driven else set())

    def constraints(self, t: Real, q: Sequence[Real], at_pose: Mapping[str, Pose]) -> dict[str, Real]:
        """g of every joint and of every cut, by the names of multipliers: the second place less the first."""
        found: dict[str, Real] = {}
        for joint in self.scene.joints:
            first, second = (self._section(self.spots[p], q, at_pose) for p in (joint.first, joint.second))
            drive = self.driven.get(joint.name)
            apart = (second[0] - first[0], second[1] - first[1])
            turn = second[2] - first[2]
            if joint.kind == "translational":
                x, y = pose(first, first[2]).turned(self._axis(joint))
                found[f"{joint.name}_normal"] = -y * apart[0] + x * apart[1]
                moved = x * apart[0] + y * apart[1]
            else:
                found[f"{joint.name}_1"], found[f"{joint.name}_2"] = apart
                moved = turn
            if joint.kind != "revolute":
                found[f"{joint.name}_turn"] = turn - mpmath.mpf(joint.angle)
            if drive:
                found[drive.name] = moved - self.motion(joint.name, t)
        for rod, pieces in self.rods.items():
            for k, (left, right) in enumerate(pairwise(pieces), 1):
                one, other = self._in_piece(left, mpmath.mpf(1)), self._in_piece(right, mpmath.mpf(-1))
                ends = (self._section(spot, q, at_pose) for spot in (one, other))
                for end, a, b in zip(("1", "2", "turn"), *ends, strict=True):
                    found[f"{rod}_cut_{k}_{end}"] = b - a
        return found

    def _section(self, spot: Spot, q: Sequence[Real], at_pose: Mapping[str, Pose]) -> tuple[Real, ...]:
        """Position of a point, and rotation of the section there."""
        here = at_pose[spot.body]
        return *here.to_world(spot.place(q)), here.phi + spot.slope(q)

    def everything(self, t: Real, q: Sequence[Real]) -> list[Real]:
        """All functions of t and q that the equations of motion are made of, one after the other."""
        at_pose = self.poses(t, q)
        found: list[Real] = []
        for _, spot in self.cloud:
            found += at_pose[spot.body].to_world(spot.place(q))
        g = self.constraints(t, q, at_pose)
        found += [g[name] for name in self.row]
        for place in self._acted_on():
            found += self._section(self.spots[place], q, at_pose)
        for spring in self.scene.springs:
            one, other = (self._section(self.spots[p], q, at_pose) for p in (spring.first, spring.second))
            if spring.kind == "bushing":
                apart = other[0] - one[0], other[1] - one[1]
                x, y = pose(one, -one[2]).turned(apart)
                found += [x, y, other[2] - one[2]]
            elif spring.kind == "rotational":
                found.append(other[2] - one[2])
            else:
                found.append(mpmath.hypot(other[0] - one[0], other[1] - one[1]))
        return found

    def sprung(self) -> list[tuple[Any, str]]:
        """The springs, those of bushings one by one, in the order of the last functions of `everything`."""
        ends = {"bushing": ("_x", "_y", "_rotation")}
        return [(spring, end) for spring in self.scene.springs for end in ends.get(spring.kind, ("",))]

    def _acted_on(self) -> list[MarkerRef]:
        scene = self.scene
        ends = [p for t in scene.torques for p in ((t.at, t.against) if t.against else (t.at,))]
        return [f.at for f in scene.forces] + ends + [self._marker(name) for name in self.markers]

    def _marker(self, name: str) -> MarkerRef:
        every = ((b.name, m.name) for b in self.scene.bodies for m in getattr(b, "beam", b).markers)
        return next(MarkerRef(body, marker) for body, marker in every if f"{body}_{marker}" == name)
