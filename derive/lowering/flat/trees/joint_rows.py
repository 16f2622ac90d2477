"""Constraints between trees and other bodies: what their multipliers exert on links and on the rows of other bodies.

A unit multiplier exerts a wrench on each of its two frames, along the axes of the body that has the frame: the levers
of a body and the shapes of its modes are constants or short sums there. The three multipliers of points that coincide
are a force, whose components are taken along the axes of the second body, if this is none of a tree, or the first one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import casadi as ca

from derive.algebra import sp
from derive.lowering.flat.casadi_symbols import Symbols, added, subtracted
from derive.lowering.flat.context import Context
from derive.lowering.flat.trees.other_bodies import Triple, rigid_rows, tensor
from derive.lowering.flat.trees.spatial_vectors import dot, multiply, null, times, transposed
from derive.lowering.flat.trees.steps import ONE, Wrench
from derive.lowering.flat.trees.tree_dynamics import TreeDynamics
from derive.lowering.vectors import ZERO, Matrix, Vector
from derive.mechanics.multibody.space.rows import row_variables
from derive.mechanics.terms import ConstrainedFrame, Constraint, FramePair, load_symbols

UNIT = [[ONE if i == j else ZERO for j in range(3)] for i in range(3)]


@dataclass
class JointRow:
    """A row of the constraints G vdot = gamma.

    others: the factors of the rows of bodies beside trees, whose translations are along the axes in `OtherBodies`.
    on_links: for the numbers of links, a point and the wrench of a unit multiplier about it. of_trees: the factors of
    the rows of trees, where the constraint does not act on frames of other bodies.
    """

    gamma: ca.SX = ZERO
    others: dict[int, ca.SX] = field(default_factory=dict)
    on_links: dict[int, tuple[Vector, Wrench]] = field(default_factory=dict)
    of_trees: dict[int, ca.SX] = field(default_factory=dict)


@dataclass(frozen=True)
class _Load:
    """An inertial force and torque; along: the rows of the body along whose axis `axis` the force is, times `sign`."""

    force: Vector
    torque: Vector
    along: Triple | None = None
    axis: int = 0
    sign: int = 1


class JointRows:
    """The rows of all constraints of a scene.

    turned: the rotation tensors of the bodies whose translations are along their own axes. bases: for the first of the
    three constraints of points that coincide, the axes along which their multipliers are.
    """

    def __init__(self, context: Context, symbols: Symbols, tree: TreeDynamics, turned: Mapping[Triple, Matrix]) -> None:
        self.context, self.symbols, self.tree, self.turned = context, symbols, tree, turned
        self.numbers = {name: n for n, name in enumerate(context.rows)}
        self.at_rest = {row.a: sp.S.Zero for row in context.equations.rows}
        self.bases: dict[int, Matrix] = {}
        self.every = list(self._rows())

    def _rows(self) -> Iterator[JointRow]:
        constraints = self.context.equations.constraints
        n = 0
        while n < len(constraints):
            three = constraints[n : n + 3]
            basis = self._basis(three)
            if basis is None:
                yield self._row(constraints[n])
                n += 1
                continue
            self.bases[n] = axes = self.turned[basis]
            for k, column in enumerate(transposed(axes)):
                yield self._of_point(three[0], _Load(column, null(), basis, k))
            n += 3

    def multipliers(self, known: Mapping[int, ca.SX]) -> list[ca.SX]:
        """The multipliers of all constraints; known: those of the rows."""
        result = [known[n] for n in range(len(known))]
        for n, axes in self.bases.items():
            result[n : n + 3] = times(axes, result[n : n + 3])
        return result

    def _basis(self, three: Sequence[Constraint]) -> Triple | None:
        """The translations of the body along whose axes the multipliers of three constraints are; None for others."""
        if len(three) < 3 or any(not _is_coincidence(c, k) or c.of != three[0].of for k, c in enumerate(three)):
            return None
        pair = three[0].frames
        assert pair is not None
        bodies = (rigid_rows(self.context, frame.own) for frame in (pair.second, pair.first) if frame.own)
        return next((of for of in bodies if of in self.turned), None)

    def _row(self, c: Constraint) -> JointRow:
        if c.frames is None or not any(frame.own for frame in (c.frames.first, c.frames.second)):
            row = JointRow(-self.symbols(c.bias))
            for name, factor in c.jacobian:
                number = self.numbers[name]
                (row.of_trees if number in self.tree.rows else row.others)[number] = self.symbols(factor)
            for rows, Q in self.turned.items():
                if row.others.keys() & {*rows}:
                    along = times(transposed(Q), [row.others.get(i, ZERO) for i in rows])
                    row.others |= dict(zip(rows, along, strict=True))
            return row
        if c.frames.axis is not None and all(frame.own or frame.carrier for frame in (c.frames.first, c.frames.second)):
            return self._of_rotation(c.frames)
        row = JointRow(-self.symbols(c.frames.bias))
        for frame in (c.frames.first, c.frames.second):
            force, torque = ([self.symbols(x) for x in of] for of in (frame.force, frame.torque))
            self._add(row, frame, _Load(force, torque))
        return row

    def _of_rotation(self, pair: FramePair) -> JointRow:
        """The row of a rotation between two bodies, along the axes of the link, or of the first if both are none."""
        here, there = (pair.second, pair.first) if pair.second.carrier else (pair.first, pair.second)
        Q = [self._rotation(frame) for frame in (here, there)]
        turn = multiply(transposed(Q[0]), Q[1])
        of, values = row_variables(), dict[sp.Symbol, ca.SX]()
        for frame in (pair.first, pair.second):
            axes, spin, _ = self._turning(frame)
            if frame is there:
                axes, spin = multiply(turn, axes), times(turn, spin)
            variables = of.first if frame is pair.first else of.second
            for i in range(3):
                values[variables.w[i]] = spin[i]
                values |= {variables.A[i, j]: axes[i][j] for j in range(3)}
        values |= {symbol: self.symbols(x) for symbol, x in pair.prescribed}
        *torque, bias = self.symbols.evaluated(pair.formula, values)
        row = JointRow(-bias)
        for frame in (pair.first, pair.second):
            own = torque if frame is here else times(transposed(turn), torque)
            own = own if frame is pair.second else [-x for x in own]
            if frame.carrier:
                place = self.tree.frames.place(frame)
                row.on_links[self.tree.frames.numbers[frame.carrier]] = place, Wrench(null(), own)
            elif frame.own:
                self._work(row, frame.own.work, null(), own)
            row.gamma = subtracted(row.gamma, dot(own, self._turning(frame)[2]))
        return row

    def _rotation(self, frame: ConstrainedFrame) -> Matrix:
        """The axes of the body that has a frame."""
        return tensor(self.symbols, frame.own) if frame.own else self.tree.frames.rotation(frame.carrier)

    def _turning(self, frame: ConstrainedFrame) -> tuple[Matrix, Vector, Vector]:
        """The axes, the angular velocity and the acceleration without those of rows of a frame, in its body."""
        if frame.own is None:
            m = self.tree.still[self.tree.frames.numbers[frame.carrier]]
            return self.tree.frames.frame_axes(frame), m.spin, m.angular
        A = frame.own.axes
        axes = [[self.symbols(A[i, j]) for j in range(3)] for i in range(3)]
        return axes, [self.symbols(x) for x in frame.own.angular_velocity], self._values(frame.own.angular_acceleration)

    def _of_point(self, c: Constraint, load: _Load) -> JointRow:
        row, pair = JointRow(), c.frames
        assert pair is not None
        self._add(row, pair.second, load)
        opposite = [-x for x in load.force]
        self._add(row, pair.first, _Load(opposite, load.torque, load.along, load.axis, -1))
        return row

    def _add(self, row: JointRow, frame: ConstrainedFrame, load: _Load) -> None:
        """Add what a unit multiplier exerts on a frame, and the acceleration of the frame without those of rows."""
        force, torque = load.force, load.torque
        if frame.carrier:
            frames = self.tree.frames
            link, place = frames.numbers[frame.carrier], frames.place(frame)
            force, torque = (frames.resolved(frame.carrier, of) for of in (force, torque))
            row.on_links[link] = place, Wrench(force, torque)
            linear, angular = self.tree.bias(frame.carrier, place)
        elif frame.own is not None:
            rows, Q = rigid_rows(self.context, frame.own), tensor(self.symbols, frame.own)
            force, torque = (times(transposed(Q), of) for of in (force, torque))
            if rows == load.along:
                force = [load.sign * x for x in UNIT[load.axis]]
            self._work(row, frame.own.work, force, torque)
            if rows not in self.turned:
                row.others |= dict(zip(rows, load.force, strict=True))  # inertial, as their rows of M
            linear, angular = self._values(frame.own.acceleration), self._values(frame.own.angular_acceleration)
        else:
            self._work(row, frame.work, force, torque)
            linear, angular = self._values(frame.acceleration), self._values(frame.angular_acceleration)
        for of, a in ((force, linear), (torque, angular)):
            row.gamma = subtracted(row.gamma, dot(of, a))

    def _values(self, vector: sp.Matrix) -> Vector:
        """The values of a vector without the accelerations of rows."""
        return [self.symbols(x.xreplace(self.at_rest)) for x in vector]

    def _work(self, row: JointRow, work: Sequence[tuple[str, sp.Expr]], force: Vector, torque: Vector) -> None:
        loads = dict(zip(load_symbols(), [*force, *torque], strict=True))
        for (name, _), value in zip(work, self.symbols.evaluated((expr for _, expr in work), loads), strict=True):
            if not value.is_zero():
                number = self.numbers[name]
                row.others[number] = added(row.others.get(number, ZERO), value)


def _is_coincidence(c: Constraint, k: int) -> bool:
    """Whether a constraint is that two points have the same inertial component k."""
    if c.frames is None or c.frames.bias != 0:
        return False
    unit = sp.eye(3)[:, k]
    second, first = c.frames.second, c.frames.first
    return (
        sp.Matrix(second.force) == unit and sp.Matrix(first.force) == -unit and not any((*second.torque, *first.torque))
    )
