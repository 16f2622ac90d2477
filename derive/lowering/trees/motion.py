"""The motion of links from the ground on, in the inertial frame, and what each needs without accelerations.

A link hangs on the one before it with the lever r from its origin; it turns by qdot e and advances by qdot T:

    w = w_before + e qdot,   xddot = a_before + alpha_before x r + T vdot + c,   wdot = alpha_before + e vdot + gamma,

with c and gamma, which accelerations do not change. Its bodies need a force and a torque about its origin for w alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from derive.ir.expressions import Element, Expr, Number
from derive.ir.indices import ElementIndex, constant
from derive.ir.statements import ForEach, Requirement, ReturnCode, Statement, StoreElement, Work
from derive.lowering.attitude import ZERO_QUATERNION
from derive.lowering.instances.loop_code.kernels import Part
from derive.lowering.instances.places import Place
from derive.lowering.trees.link_loop import LinkArrays, LinkLoop
from derive.lowering.trees.links import TURNED, UNIT, LinkInertia, Tree
from derive.lowering.vectors import (
    Matrix,
    Vector,
    applied,
    cross,
    dot,
    packed,
    plus,
    product,
    scaled,
    symmetric,
    transposed,
)

FRAME, SPIN, LEVER, BIAS = "frame", "spin", "lever", "bias"
"""The arrays of the axes of links by rows, their angular velocities, levers, and of c and gamma."""
MOMENT, INERTIA, NEEDED = "moment", "inertia", "needed"
"""The arrays of first moments and inertias about the origins of links, and of the forces and torques for w."""
STILL = "still"
"""The array of velocities that are all zero."""
ORIGIN, SPEED = "origin", "speed"
"""The arrays of the positions and velocities of the origins of links."""


@dataclass(frozen=True)
class TreeMotion:
    """The loops of the motion of a tree; q, v: the arrays of coordinates and velocities, and where these begin."""

    tree: Tree
    arrays: LinkArrays
    q: tuple[str, int] = ("q", 0)
    v: tuple[str, int] = ("v", 0)

    @cached_property
    def joints(self) -> list[int]:
        """The links that hang on others or on the ground."""
        return [n for n, link in enumerate(self.tree.links) if not link.is_free]

    @cached_property
    def free(self) -> list[int]:
        """The links of free bodies."""
        return [n for n, link in enumerate(self.tree.links) if link.is_free]

    @cached_property
    def balls(self) -> list[int]:
        """The links that are the first of a joint that leaves all rotations."""
        return [n for n in self.joints if self.tree.links[n].ball == 0]

    @cached_property
    def massive(self) -> list[int]:
        """The links that have bodies."""
        return [n for n, link in enumerate(self.tree.links) if link.inertia != LinkInertia()]

    def loop(self, name: str, links: Sequence[int]) -> LinkLoop:
        """A loop over links."""
        return LinkLoop(self.arrays, name, links)

    def work(self, *arrays: tuple[str, int], cleared: bool = False) -> list[Statement]:
        """The declarations of arrays with so many components of each link."""
        return [Work(array, count * self.arrays.spacing, cleared, self.arrays.spacing) for array, count in arrays]

    def at_ground(self, array: str, values: Sequence[Expr]) -> Iterator[Statement]:
        """Yield the statements that write the components of the ground."""
        return self.at_link(array, -1, values)

    def at_link(self, array: str, link: int, values: Sequence[Expr]) -> Iterator[Statement]:
        """Yield the statements that write the components of a link, -1 for the ground."""
        for k, value in enumerate(values):
            yield StoreElement(Element(array, constant(k * self.arrays.spacing + self.arrays.slot(link))), value)

    def coordinate(self, loop: LinkLoop, k: int = 0) -> ca.SX:
        """A coordinate of each link."""
        place = loop.place("coordinate", [self.tree.links[n].coordinate for n in loop.links])
        return loop.element(self.q[0], place.at(k + self.q[1]))

    def velocity(self, loop: LinkLoop, k: int = 0) -> ca.SX:
        """A velocity of each link."""
        return loop.element(self.v[0], self.row(loop, k + self.v[1]))

    def row(self, loop: LinkLoop, k: int = 0) -> ElementIndex:
        """The index of a row of each link."""
        return loop.place("row", [self.tree.links[n].row for n in loop.links]).at(k)

    # ---- frames and angular velocities ----

    def frames(self, moving: bool, placed: bool = False, in_tree: bool = False) -> Part:
        """The frames and levers of all links; moving: with their angular velocities; placed: with their positions.

        in_tree: positions count from the origin of the tree.
        """
        arrays = [(FRAME, 9), (LEVER, 3), *([(SPIN, 3)] * moving)]
        arrays += [(ORIGIN, 3), *([(SPEED, 3)] * moving)] if placed else []
        ground = [*self.at_ground(FRAME, [Number(x) for row in UNIT for x in row])]
        for array, _ in arrays[2:]:
            ground += self.at_ground(array, [Number(x) for x in (UNIT[0][1],) * 3])
        loops = [self._free_frames(moving, placed, in_tree)] if self.free else []
        if self.balls:
            loops += self._frames_between_balls(moving, placed)
        elif self.joints:
            loops.append(self._frames(self.joints, moving, placed))
        text = "frames of the links" + (" and their angular velocities" if moving else "")
        return "motion", "(1)", text, [*self.work(*arrays), *ground, *loops]

    def _frames(self, links: Sequence[int], moving: bool, placed: bool) -> ForEach:
        loop = self.loop("frames", links)
        here, before = loop.of_links(), loop.of_parents()
        Q = matrix(loop.vector(FRAME, before, 9))
        axes = product(Q, loop.matrix(lambda of: of.axes))
        lever = applied(Q, loop.numbers(lambda of: of.offset))
        q = self.coordinate(loop)
        first, second, e = transposed(axes)
        turns, advances = loop.number(lambda of: of.turns), loop.number(lambda of: of.advances)
        if not turns.is_zero():
            sine, cosine = turns * ca.sin(q), 1 + turns * (ca.cos(q) - 1) if not turns.is_one() else ca.cos(q)
            first, second = (
                plus(scaled(cosine, first), scaled(sine, second)),
                plus(scaled(cosine, second), scaled(-sine, first)),
            )
        if not advances.is_zero():
            lever = plus(lever, scaled(advances * q, e))
        loop.store_vector(FRAME, here, [x for row in transposed([first, second, e]) for x in row])
        loop.store_vector(LEVER, here, lever)
        self._carried(loop, e, lever, moving, placed)
        return loop.made()

    def _carried(self, loop: LinkLoop, e: Vector, lever: Vector, moving: bool, placed: bool) -> None:
        """The angular velocities, positions and velocities of links; e: their axes."""
        here, before = loop.of_links(), loop.of_parents()
        w = loop.vector(SPIN, before) if moving else []
        if moving:
            v = self.velocity(loop)
            turns, advances = loop.number(lambda of: of.turns), loop.number(lambda of: of.advances)
            follows = loop.number(lambda of: of.follows)
            loop.store_vector(SPIN, here, plus(scaled(follows, w), scaled(turns * v, e)))
        if placed:
            loop.store_vector(ORIGIN, here, plus(loop.vector(ORIGIN, before), lever))
        if placed and moving:
            speed = plus(loop.vector(SPEED, before), cross(w, lever), scaled(advances * v, e))
            loop.store_vector(SPEED, here, speed)

    def _frames_between_balls(self, moving: bool, placed: bool) -> Iterator[ForEach]:
        """Yield the loops of the frames of balls, of those of other links, and of what these and balls hang on."""
        loop = self.loop("ball_frames", self.balls)
        columns = transposed(self._of_quaternion(loop, 0))
        for number, turn in TURNED.items():
            here = loop.place(f"slot_{number}", [self.arrays.slot(n + number) for n in loop.links], self.arrays.spacing)
            turned = [columns[[row[k] for row in turn].index(1)] for k in range(3)]
            loop.store_vector(FRAME, here, [x for row in transposed(turned) for x in row])
        yield loop.made(independent=True)
        if others := [n for n in self.joints if self.tree.links[n].ball < 0]:
            yield self._frames(others, moving=False, placed=False)
        loop = self.loop("ball_levers", [n for n in self.joints if self.tree.links[n].ball >= 0])
        Q = matrix(loop.vector(FRAME, loop.of_parents(), 9))
        loop.store_vector(LEVER, loop.of_links(), applied(Q, loop.numbers(lambda of: of.offset)))
        yield loop.made(independent=True)
        if moving or placed:
            loop = self.loop("carried_frames", self.joints)
            here = loop.of_links()
            self._carried(loop, axis(loop, here), loop.vector(LEVER, here), moving, placed)
            yield loop.made()

    def _of_quaternion(self, loop: LinkLoop, first: int) -> Matrix:
        """The rotation tensors of the quaternions whose first components are so far behind the coordinates of links."""
        quaternion = [self.coordinate(loop, first + k) for k in range(4)]
        squares = quaternion[0] ** 2 + quaternion[1] ** 2 + quaternion[2] ** 2 + quaternion[3] ** 2
        loop.require(Requirement.POSITIVE, squares, ReturnCode.NOT_FINITE, ZERO_QUATERNION)
        return of_quaternion(quaternion)

    def _free_frames(self, moving: bool, placed: bool, in_tree: bool) -> ForEach:
        loop = self.loop("free_frames", self.free)
        here = loop.of_links()
        Q = self._of_quaternion(loop, 3)
        loop.store_vector(FRAME, here, [x for row in Q for x in row])
        loop.store_vector(LEVER, here, [ca.SX(0)] * 3)
        if moving:
            loop.store_vector(SPIN, here, applied(Q, [self.velocity(loop, 3 + k) for k in range(3)]))
        if placed:
            at = [ca.SX(0)] * 3 if in_tree else [self.coordinate(loop, k) for k in range(3)]
            loop.store_vector(ORIGIN, here, at)
        if placed and moving:
            loop.store_vector(SPEED, here, [self.velocity(loop, k) for k in range(3)])
        return loop.made()

    # ---- inertia, and what is needed without accelerations ----

    def inertias(self, moving: bool) -> Part:
        """The inertias of all links; moving: with c and gamma, and the forces and torques for w."""
        arrays = [(MOMENT, 3), (INERTIA, 6), *([(NEEDED, 6), (BIAS, 6)] * moving)]
        together = self.joints == self.massive
        loops: list[Statement] = []
        loop = self.loop("moving_links" if together and moving else "links", self.massive)  # with numbers of joints
        self._inertia(loop, moving)
        if together and moving:
            self._bias(loop)
        loops.append(loop.made(independent=True))
        if moving and not together and self.joints:
            loop = self.loop("joints", self.joints)
            self._bias(loop)
            loops.append(loop.made(independent=True))
        clears = len(self.massive) < len(self.tree.links)
        text = "inertia of each link" + (", and what it needs without accelerations" if moving else "")
        kept = arrays[:3] if moving else arrays
        declared = [*self.work(*kept, cleared=clears), *self.work(*arrays[len(kept) :], cleared=bool(self.free))]
        return "links", "(15)", text, [*declared, *loops]

    def _inertia(self, loop: LinkLoop, moving: bool) -> None:
        here = loop.of_links()
        Q = matrix(loop.vector(FRAME, here, 9))
        moment = applied(Q, loop.numbers(lambda of: of.inertia.moment))
        own = loop.matrix(lambda of: of.inertia.tensor)
        half = product(Q, own)
        tensor = packed([[dot(a, b) for b in Q] for a in half])
        loop.store_vector(MOMENT, here, moment)
        loop.store_vector(INERTIA, here, tensor)
        if moving:
            w = loop.vector(SPIN, here)
            force = cross(w, cross(w, moment))
            torque = cross(w, applied(symmetric(tensor), w))
            loop.store_vector(NEEDED, here, [*force, *torque])

    def _bias(self, loop: LinkLoop) -> None:
        here, before = loop.of_links(), loop.of_parents()
        w, lever = loop.vector(SPIN, before), loop.vector(LEVER, here)
        e, v = axis(loop, here), self.velocity(loop)
        across = cross(w, e)
        c = cross(w, cross(w, lever))
        advances = loop.number(lambda of: of.advances)
        if not advances.is_zero():
            c = plus(c, scaled(2 * (advances * v), across))
        relative = loop.number(lambda of: of.turns * of.is_relative)
        loop.store_vector(BIAS, here, [*c, *scaled(relative * v, across)])


def axis(loop: LinkLoop, here: Place) -> Vector:
    """The axis of each link."""
    return [loop.element(FRAME, here.at(3 * i + 2)) for i in range(3)]


def matrix(entries: Sequence[ca.SX]) -> Matrix:
    """The matrix with these entries by rows."""
    return [list(entries[3 * i : 3 * i + 3]) for i in range(3)]


def of_quaternion(p: Vector) -> Matrix:
    """The rotation tensor of a quaternion, whose real part comes first."""
    a, b, c, d = p
    return [
        [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
        [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
        [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
    ]
