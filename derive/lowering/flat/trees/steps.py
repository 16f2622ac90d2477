"""The steps from a body of a tree to the next one: shifts, rotations and single degrees of freedom.

A joint is a sequence of steps. Forces and inertias pass them from the leaves of the tree to its root, motions from the
root to the leaves. A joint of several degrees of freedom has a step for each, since all but the last may be taken for
joints of bodies without mass: only the pivots of the joint as a whole need inertia.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca

from derive.lowering.flat.casadi_symbols import added, multiplied, subtracted
from derive.lowering.flat.trees.spatial_vectors import NEXT, Rotation, SpatialInertia, cross, dot, null, plus, times
from derive.lowering.vectors import ZERO, Matrix, Vector

ONE = ca.SX(1)


@dataclass(frozen=True)
class TurnedFrame:
    """The angular velocity, the angular acceleration and the acceleration of the origin, in the frame that moves."""

    spin: Vector
    angular: Vector
    linear: Vector

    @cached_property
    def of_points(self) -> Matrix:
        """S of the acceleration S r that points at r have against the origin: [angular] + [spin] [spin]."""
        w, squares = self.spin, [multiplied(x, x) for x in self.spin]
        result = [[ZERO] * 3 for _ in range(3)]
        for k, (i, j) in enumerate(NEXT):
            result[k][k] = -added(squares[i], squares[j])
            both = multiplied(w[i], w[j])
            result[i][j] = subtracted(both, self.angular[k])
            result[j][i] = added(both, self.angular[k])
        return result


@dataclass(frozen=True)
class Wrench:
    """A force and a torque about the origin."""

    force: Vector
    torque: Vector

    def __add__(self, other: Wrench) -> Wrench:
        return Wrench(plus(self.force, other.force), plus(self.torque, other.torque))


NO_WRENCH = Wrench(null(), null())


@dataclass(frozen=True)
class Shift:
    """The origin moves to r."""

    r: Vector

    def motion(self, m: TurnedFrame) -> TurnedFrame:
        """The motion behind it."""
        return replace(m, linear=plus(m.linear, times(m.of_points, self.r))) if _any(self.r) else m

    def accelerations(self, x: Vector, y: Vector) -> tuple[Vector, Vector]:
        """The accelerations behind it, of those without velocities."""
        return plus(x, cross(y, self.r)), y

    def wrench(self, w: Wrench) -> Wrench:
        """The wrench before it."""
        return Wrench(w.force, plus(w.torque, cross(self.r, w.force)))

    def inertia(self, inertia: SpatialInertia) -> SpatialInertia:
        """The inertia before it."""
        return inertia.shifted(self.r) if _any(self.r) else inertia


@dataclass(frozen=True)
class Turn:
    """The frame turns; free: by coordinates that do not depend on the frame before, whose spin it does not share."""

    rotation: Rotation
    free: bool = False

    def motion(self, m: TurnedFrame) -> TurnedFrame:
        """The motion behind it."""
        on = self.rotation.on
        spin, angular = (null(), null()) if self.free else (on(m.spin), on(m.angular))
        return TurnedFrame(spin, angular, on(m.linear))

    def accelerations(self, x: Vector, y: Vector) -> tuple[Vector, Vector]:
        """The accelerations behind it, of those without velocities."""
        return self.rotation.on(x), null() if self.free else self.rotation.on(y)

    def wrench(self, w: Wrench) -> Wrench:
        """The wrench before it."""
        return Wrench(self.rotation.back(w.force), null() if self.free else self.rotation.back(w.torque))

    def inertia(self, inertia: SpatialInertia) -> SpatialInertia:
        """The inertia before it."""
        if self.free:
            nothing = [null() for _ in range(3)]
            return SpatialInertia(self.rotation.symmetric_back(inertia.A), nothing, nothing)
        return inertia.turned_back(self.rotation)


@dataclass(frozen=True)
class SingleFreedom:
    """A coordinate moves the frame along an axis, or turns it about the axis and moves it by `along` times the angle.

    row: its number. rate, acceleration: of the coordinate. relative: whether the frame moves against one that turns.
    """

    row: int
    axis: int
    turns: bool
    rate: ca.SX
    along: ca.SX = ZERO
    relative: bool = True

    @cached_property
    def direction(self) -> tuple[Vector, Vector]:
        """The linear and the angular motion by a unit rate."""
        linear, angular = null(), null()
        (angular if self.turns else linear)[self.axis] = ONE
        if self.turns:
            linear[self.axis] = self.along
        return linear, angular

    @property
    def place(self) -> int | None:
        """The place of its axis among three translations and three rotations; None if it moves along both."""
        if self.turns and not self.along.is_zero():
            return None
        return self.axis + (3 if self.turns else 0)

    def motion(self, m: TurnedFrame, acceleration: ca.SX) -> TurnedFrame:
        """The motion behind it."""
        linear, angular = self.direction
        spin, alpha, a = m.spin, m.angular, m.linear
        if self.relative:
            alpha = plus(alpha, cross(m.spin, [multiplied(x, self.rate) for x in angular]))
            twice = added(self.rate, self.rate)
            a = plus(a, cross(m.spin, [multiplied(x, twice) for x in linear]))
        return TurnedFrame(
            plus(spin, [multiplied(x, self.rate) for x in angular]),
            plus(alpha, [multiplied(x, acceleration) for x in angular]),
            plus(a, [multiplied(x, acceleration) for x in linear]),
        )

    def force(self, w: Wrench) -> ca.SX:
        """The generalised force of a wrench."""
        linear, angular = self.direction
        return added(dot(linear, w.force), dot(angular, w.torque))


def _any(v: Vector) -> bool:
    return not all(x.is_zero() for x in v)


@dataclass(frozen=True)
class ReleasedFreedom:
    """A degree of freedom that is eliminated: its pivot D with the inverse, and U/D of the inertia U along it."""

    pivot: ca.SX
    inverse: ca.SX
    factors: list[ca.SX]


def eliminate(freedom: SingleFreedom, inertia: SpatialInertia) -> tuple[ReleasedFreedom, SpatialInertia]:
    """A degree of freedom as eliminated, and the inertia that is left before it, by a step of LDL^T."""
    A, B, C = inertia.A, inertia.B, inertia.C
    Bt = [[B[j][i] for j in range(3)] for i in range(3)]
    rows = [[*A[i], *B[i]] for i in range(3)] + [[*Bt[i], *C[i]] for i in range(3)]
    linear, angular = freedom.direction
    direction = [*linear, *angular]
    place = freedom.place
    column = [row[place] for row in rows] if place is not None else [dot(row, direction) for row in rows]
    pivot = column[place] if place is not None else dot(column, direction)
    inverse = ca.SX.binary(ca.OP_DIV, ONE, pivot)
    factors = [ONE if i == place else multiplied(x, inverse) for i, x in enumerate(column)]

    def left(i: int, j: int) -> ca.SX:
        if place in (i, j):
            return ZERO
        i, j = min(i, j), max(i, j)
        return subtracted(rows[i][j], multiplied(factors[i], column[j]))

    known = {(i, j): left(i, j) for i in range(6) for j in range(i, 6)}
    full = [[known[min(i, j), max(i, j)] for j in range(6)] for i in range(6)]
    reduced = SpatialInertia(
        [row[:3] for row in full[:3]], [row[3:] for row in full[:3]], [row[3:] for row in full[3:]]
    )
    return ReleasedFreedom(pivot, inverse, factors), reduced
