"""The bodies of trees as links in code: their inertias, and the steps from one to the next.

The frame of a link is that of its own marker of the joint before it, in which the axes of the joint are axes of the
frame; what follows from parameters alone becomes a constant of setup. A fixed rotation between the axes of two joints
is a permutation of axes, and planar turns if it is none.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from derive.algebra import sp
from derive.lowering.flat.casadi_symbols import Symbols, added, multiplied
from derive.lowering.flat.trees.spatial_vectors import (
    NEXT,
    FullRotation,
    Permutation,
    PlanarTurn,
    SpatialInertia,
    multiply,
    null,
    plus,
    times,
    transposed,
)
from derive.lowering.flat.trees.steps import Shift, SingleFreedom, Turn, TurnedFrame
from derive.lowering.vectors import ZERO, Matrix, Vector
from derive.mechanics.multibody.space.joint_coordinate import AXES_OF, JointCoordinate
from derive.mechanics.multibody.space.tree.carried_motion import Hinge
from derive.mechanics.multibody.space.tree.recursions import TreeBody
from derive.mechanics.symbols import Family, Identity, identity
from derive.mechanics.terms import ConstrainedFrame, EquationOfMotion

Step = Shift | Turn | SingleFreedom

SMALL = 1e-15
"""Entries of rotations below this are rounding errors of numbers that are zero."""


@dataclass(frozen=True)
class TreeFrame:
    """A body of a tree: its inertia about the origin, in its frame, and the steps to it from its parent.

    parent: its place among the links, -1 at the root. base: the motion from which the steps of a root start. place: the
    part of the shift from the parent that is constant. half: the number 1/2.
    """

    name: str
    parent: int
    steps: tuple[Step, ...]
    base: TurnedFrame
    place: Vector
    mass: ca.SX
    moment: Vector
    tensor: Matrix
    half: ca.SX

    @property
    def half_trace(self) -> ca.SX:
        """Half of the sum of its moments of inertia, which none of them exceeds."""
        trace = added(added(self.tensor[0][0], self.tensor[1][1]), self.tensor[2][2])
        return multiplied(self.half, trace)  # CasADi would round the derivative of a quotient

    @property
    def inertia(self) -> SpatialInertia:
        """Its inertia as of a rigid body."""
        A = [[self.mass if i == j else ZERO for j in range(3)] for i in range(3)]
        x, y, z = self.moment
        return SpatialInertia(A, [[ZERO, z, -y], [-z, ZERO, x], [y, -x, ZERO]], self.tensor)


class TreeFrames:
    """The links of trees.

    rows: the numbers of rows by name. accelerations: those of the rows, by number. gravity: the acceleration of free
    fall; a root accelerates against it.
    """

    def __init__(
        self, symbols: Symbols, bodies: Sequence[TreeBody], rows: Mapping[str, int], gravity: sp.Matrix
    ) -> None:
        self.symbols, self.rows = symbols, rows
        self.upwards = [-symbols(g) for g in gravity]
        self.numbers = {body.name: n for n, body in enumerate(bodies)}
        self.axes = {body.name: _own_axes(body) for body in bodies}
        self.turns = {body.name: body.motion.frame for body in bodies}
        self.every = tuple(self._link(body) for body in bodies)

    def resolved(self, body: str, vector: Vector) -> Vector:
        """The components of an inertial vector along the axes of a link."""
        along = times(transposed(self._matrix(self.turns[body])), vector)
        return times(transposed(self._matrix(self.axes[body])), along)

    def place(self, frame: ConstrainedFrame) -> Vector:
        """The place of a frame of a tree in the link that has it."""
        assert frame.place is not None
        return times(transposed(self._matrix(self.axes[frame.carrier])), [self.symbols(x) for x in frame.place[0]])

    def frame_axes(self, frame: ConstrainedFrame) -> Matrix:
        """The axes of a frame of a tree in the link that has it, as columns."""
        assert frame.place is not None
        return self._matrix(cleaned(self.axes[frame.carrier].T * sp.Matrix(frame.place[1])))

    def rotation(self, body: str) -> Matrix:
        """The axes of a link in the inertial frame, as columns."""
        turn, own = self._matrix(self.turns[body]), self.axes[body]
        return turn if own == sp.eye(3) else multiply(turn, self._matrix(own))

    def _link(self, body: TreeBody) -> TreeFrame:
        hinge, of = body.motion.hinge, self.symbols
        parent = self.numbers.get(body.motion.parent, -1)
        base, place = TurnedFrame(null(), null(), self.upwards), null()
        if hinge is None:
            steps = tuple(self._free(body))
        else:
            if parent < 0:
                base = self._of_marker(hinge)
            else:
                own = self._matrix(self.axes[body.motion.parent])
                place = times(transposed(own), [of(x) for x in hinge.place])
            steps = (*self._carried(body, hinge, place), *self._own(body, hinge))
        own_axes = self._matrix(self.axes[body.name])
        tensor = self._matrix(body.tensor)
        if self.axes[body.name] != sp.eye(3):
            tensor = FullRotation(transposed(own_axes)).symmetric_back(tensor)
        moment = times(transposed(own_axes), [of(x) for x in body.moment])
        half = of.number(Fraction(1, 2))
        return TreeFrame(body.name, parent, steps, base, place, of(body.mass), moment, tensor, half)

    def _matrix(self, matrix: sp.Matrix) -> Matrix:
        return [[self.symbols(matrix[i, j]) for j in range(3)] for i in range(3)]

    def _of_marker(self, hinge: Hinge) -> TurnedFrame:
        """The motion of a marker of a body that moves as prescribed, or of the ground, without gravity."""
        known, of = hinge.known, self.symbols
        linear = plus([of(x) for x in known.acceleration], self.upwards)
        return TurnedFrame([of(x) for x in known.angular_velocity], [of(x) for x in known.angular_acceleration], linear)

    def _free(self, body: TreeBody) -> Iterator[Step]:
        rows = body.motion.own_rows
        for axis, row in enumerate(rows[:3]):
            yield SingleFreedom(self.rows[row.name], axis, False, self.symbols(row.v), relative=False)
        yield Turn(FullRotation(self._matrix(body.motion.frame)), free=True)
        yield from self._spins(rows[3:])

    def _spins(self, rows: Sequence[EquationOfMotion]) -> Iterator[SingleFreedom]:
        for axis, row in enumerate(rows):
            yield SingleFreedom(self.rows[row.name], axis, True, self.symbols(row.v), relative=False)

    def _carried(self, body: TreeBody, hinge: Hinge, place: Vector) -> Iterator[Step]:
        """The steps to the marker that carries a body, and along its axes; place: of the marker."""
        before = self.axes.get(body.motion.parent, sp.eye(3))
        axes = cleaned(before.T * sp.Matrix(hinge.axes))
        r = place
        for c in hinge.motions:
            factor = c.along if c.is_rotation else sp.S.One
            if factor != 0:
                s = multiplied(self.symbols(c.values[0]), self.symbols(factor))
                axis = AXES_OF["z" if c.is_rotation else c.motion]
                r = plus(r, [multiplied(s, self.symbols(axes[i, axis])) for i in range(3)])
        yield Shift(r)
        if not hinge.ball or hinge.motions:
            yield from fixed_turns(self.symbols, axes)

    def _own(self, body: TreeBody, hinge: Hinge) -> Iterator[Step]:
        """The steps by the coordinates of a body."""
        of = self.symbols
        for c in hinge.motions:
            if c.row and not c.is_rotation:
                yield SingleFreedom(self.rows[c.row.name], AXES_OF[c.motion], False, of(c.values[1]))
        if hinge.ball:
            axes = (
                hinge.known.axes if hinge.motions else hinge.known.frame * self.axes.get(body.motion.parent, sp.eye(3))
            )
            before = self._matrix(sp.Matrix(axes))
            yield Turn(FullRotation(multiply(transposed(before), self._matrix(body.motion.frame))), free=True)
            yield from self._spins(body.motion.own_rows[-3:])
            return
        for c in hinge.motions:
            if c.row and c.is_rotation:
                axis = AXES_OF[c.motion]
                yield Turn(PlanarTurn(axis, *self._cosine_and_sine(body.name, c)))
                yield SingleFreedom(self.rows[c.row.name], axis, True, of(c.values[1]), of(c.along))

    def _cosine_and_sine(self, body: str, c: JointCoordinate) -> tuple[ca.SX, ca.SX]:
        assert c.coordinate, "no drive prescribes a motion in a tree"
        components = identity(c.coordinate.q).components
        cosine, sine = (Identity(f, components=components, owner=body).symbol for f in (Family.COSINE, Family.SINE))
        return self.symbols.values[cosine], self.symbols.values[sine]


def _own_axes(body: TreeBody) -> sp.Matrix:
    """The axes of the frame of a link in that of the body."""
    hinge = body.motion.hinge
    return sp.eye(3) if hinge is None or hinge.ball else sp.Matrix(hinge.own_axes)


def cleaned(axes: sp.Matrix) -> sp.Matrix:
    """A rotation matrix of numbers without rounding errors of its entries 0, 1 and -1."""
    return axes.applyfunc(lambda x: sp.Integer(round(x)) if x.is_Rational and abs(x - round(x)) < SMALL else x)


def fixed_turns(symbols: Symbols, axes: sp.Matrix) -> Iterator[Turn]:
    """The turns that make a rotation whose axes are the columns of a matrix."""
    if not all(x.is_Rational for x in axes):
        yield Turn(FullRotation([[symbols(axes[i, j]) for j in range(3)] for i in range(3)]))
        return
    for k in (2, 0, 1):
        if sorted(abs(x) for x in axes[:, k]) == [0, 0, 1]:
            yield from _planar(symbols, axes, k)
            return
    first = math.atan2(float(axes[0, 2]), -float(axes[1, 2]))
    tilt = math.atan2(math.hypot(float(axes[0, 2]), float(axes[1, 2])), float(axes[2, 2]))
    last = math.atan2(float(axes[2, 0]), float(axes[2, 1]))
    for axis, angle in ((2, first), (0, tilt), (2, last)):
        numbers = (symbols.number(Fraction(f(angle))) for f in (math.cos, math.sin))
        yield Turn(PlanarTurn(axis, *numbers))


def _planar(symbols: Symbols, axes: sp.Matrix, k: int) -> Iterator[Turn]:
    """The permutation of axes, and the turn about axis k behind it, that make a rotation."""
    i, j = NEXT[k]
    at = [next(a for a in range(3) if axes[a, k] != 0), max(range(3), key=lambda a: abs(axes[a, i]))]
    sign = [1 if axes[at[0], k] > 0 else -1, 1 if axes[at[1], i] > 0 else -1]
    third = 3 - at[0] - at[1]
    parity = 1 if (at[0], at[1], third) in ((0, 1, 2), (1, 2, 0), (2, 0, 1)) else -1
    places, signs = [0] * 3, [0] * 3
    for axis, place, of in ((k, at[0], sign[0]), (i, at[1], sign[1]), (j, third, parity * sign[0] * sign[1])):
        places[axis], signs[axis] = place, of
    if (places, signs) != ([0, 1, 2], [1, 1, 1]):
        yield Turn(Permutation(tuple(places), tuple(signs)))
    cosine, sine = axes[places[i], i] * signs[i], axes[places[j], i] * signs[j]
    if sine != 0:
        yield Turn(PlanarTurn(k, symbols(cosine), symbols(sine)))
