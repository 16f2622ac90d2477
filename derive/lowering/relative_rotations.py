"""Rotations of bodies in space, relative to each other, along the axes that their joints leave.

The rows of the KKT matrix [M, -G^T; -G, 0] for the rotation of a body are turned into the inertial frame, where the
factors of a joint of points are levers and those of a rotation that a joint removes, n . (w2 - w1), are equal and
opposite. Along a tree of joints that remove rotations, the angular acceleration of a body then is that of the one
before it and a relative one, e: the sums of rows that follow are the composite inertias behind each joint, and the rows
n of the joint have entries in e alone. Two of them leave e = z y + what they prescribe, with z = n1 x n2, three of them
nothing. M stays symmetric and positive definite, and what divides, |z|^2 or the determinant of three n, vanishes only
where the rows of the joint depend on each other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import casadi as ca

from derive.lowering.congruences import AddedRow, Columns, Entries, columns_of, lower_triangle
from derive.lowering.vectors import ZERO, Vector, cross, dot, transposed

Triple = tuple[int, int, int]
SPACE = range(3)


def turned(vector: Sequence[ca.SX], matrix: Sequence[Sequence[ca.SX]]) -> Vector:
    """The product of a matrix and a vector; zero if the vector is."""
    return [ZERO] * 3 if all(x.is_zero() for x in vector) else [dot(row, vector) for row in matrix]


@dataclass(frozen=True)
class InertialRotations:
    """The change of the rows of rotations from components in bodies to inertial ones.

    tensors: the rotation tensor Q of each body, by its rows in the KKT matrix. known: the changed entries of the rows
    of multipliers, as far as they are known; the others are multiplied by Q.
    """

    tensors: Mapping[Triple, Sequence[Vector]]
    known: Mapping[tuple[int, Triple], Vector]

    def change(self, entries: Entries) -> None:
        """Change the entries of the lower triangle."""
        columns = columns_of(entries)
        for rows, Q in self.tensors.items():
            of_inertia = [turned([columns[i].get(j, ZERO) for j in rows], Q) for i in rows]
            inertia = [turned(row, Q) for row in transposed(of_inertia)]
            for j in [j for j, of in columns.items() if j not in rows and not of.keys().isdisjoint(rows)]:
                old = [columns[j].pop(i, ZERO) for i in rows]
                new = self.known[j, rows] if (j, rows) in self.known else turned(old, Q)
                for i, value in zip(rows, new, strict=True):
                    columns[i].pop(j, None)
                    if not value.is_zero():
                        columns[i][j] = columns[j][i] = value
            for a in SPACE:
                for b in range(a + 1):
                    columns[rows[a]][rows[b]] = columns[rows[b]][rows[a]] = inertia[a][b]
        entries.clear()
        entries.update(lower_triangle(columns))

    def forward(self, right: Sequence[ca.SX]) -> list[ca.SX]:
        """The right-hand side in inertial components."""
        return self._turned(right, self.tensors)

    def backward(self, solution: Sequence[ca.SX]) -> list[ca.SX]:
        """The solution in components in bodies."""
        return self._turned(solution, {rows: transposed(Q) for rows, Q in self.tensors.items()})

    def _turned(self, values: Sequence[ca.SX], by: Mapping[Triple, Sequence[Vector]]) -> list[ca.SX]:
        result = list(values)
        for rows, matrix in by.items():
            for i, value in zip(rows, turned([values[i] for i in rows], matrix), strict=True):
                result[i] = value
        return result


@dataclass(frozen=True)
class RelativeTurn:
    """A joint of a tree that removes rotations of a body relative to another one.

    rows: those of the rotation of the body in the KKT matrix. parent: those of the other one, None if its rotation is
    not free. others: further rows that turn the other one, with their factors in its angular velocity. multipliers:
    the rows of the removed rotations.
    """

    rows: Triple
    parent: Triple | None
    others: tuple[tuple[int, Vector], ...]
    multipliers: tuple[int, ...]

    @property
    def turning(self) -> tuple[int, ...]:
        """The rows of the rotations of both bodies, which have to be there when rotations become relative ones."""
        return (*self.rows, *(self.parent or ()), *(row for row, _ in self.others))

    @property
    def gone(self) -> tuple[int, ...]:
        """The rows that are eliminated with the joint; if it leaves one rotation, that has the last of `rows`."""
        count = len(self.multipliers)
        return (*self.rows[:count], *self.multipliers) if count > 1 else ()


@dataclass
class _Step:
    """The elimination of a joint: its axes, the entries of its rows before, z or products of the axes, the divisor."""

    turn: RelativeTurn
    axes: list[Vector]
    inertia: list[Vector]
    coupled: dict[int, Vector]
    z: Vector
    divisor: ca.SX
    prescribed: Vector = field(default_factory=list)
    right: Vector = field(default_factory=list)

    @property
    def leaves_one(self) -> bool:
        """Whether a rotation about z is left."""
        return len(self.axes) == 2


@dataclass
class RelativeElimination:
    """The change to relative rotations and the elimination of those that joints remove.

    entries: the lower triangle of the KKT matrix with inertial components, which is changed. turns: joints of a tree,
    the bodies that carry no others first.
    """

    entries: Entries
    turns: Sequence[RelativeTurn]
    steps: list[_Step] = field(default_factory=list)

    def __post_init__(self) -> None:
        columns = columns_of(self.entries)
        for turn in self.turns:
            self._relative(turn, columns)
        for turn in self.turns:
            if turn.gone:
                self.steps.append(_eliminated(turn, columns))
        self.entries.clear()
        self.entries.update(lower_triangle(columns))

    @property
    def gone(self) -> tuple[int, ...]:
        """The rows that are eliminated with the joints."""
        return tuple(row for step in self.steps for row in step.turn.gone)

    def _relative(self, turn: RelativeTurn, columns: Columns) -> None:
        """Change the rows of a body to those of its rotation relative to the body before it."""
        for added in _sums(turn):
            added.change(columns)
        for of in turn.multipliers:
            for j in (*(turn.parent or ()), *(row for row, _ in turn.others)):
                columns[of].pop(j, None)  # n . (w2 - w1) = n . e
                columns[j].pop(of, None)

    def forward(self, right: Sequence[ca.SX]) -> list[ca.SX]:
        """The right-hand side of the rows that are left."""
        b = list(right)
        for turn in self.turns:
            for added in _sums(turn):
                added.change_right(b)
        for step in self.steps:
            _prescribe(step, b)
        return b

    def backward(self, eliminated: Sequence[ca.SX], solution: Mapping[int, ca.SX]) -> list[ca.SX]:
        """All unknowns from those of the rows that are left, with inertial components; eliminated: of `forward`."""
        x = list(eliminated)
        for i, value in solution.items():
            x[i] = value
        for step in reversed(self.steps):
            _recover(step, x)
        for turn in reversed(self.turns):
            for added in reversed(_sums(turn)):
                added.recover(x)
        return x


def _sums(turn: RelativeTurn) -> list[AddedRow]:
    """The rows of a body, added to those that turn the body before it."""
    sums = [AddedRow(i, p) for i, p in zip(turn.rows, turn.parent or (), strict=False)]
    for row, factors in turn.others:
        sums += [AddedRow(i, row, f) for i, f in zip(turn.rows, factors, strict=True) if not f.is_zero()]
    return sums


def _eliminated(turn: RelativeTurn, columns: Columns) -> _Step:
    """Eliminate the rotations that a joint removes."""
    axes = [[columns[m].get(i, ZERO) for i in turn.rows] for m in turn.multipliers]
    inertia = [[columns[i].get(j, ZERO) for j in turn.rows] for i in turn.rows]
    for row in turn.multipliers:
        columns.pop(row)
    coupled: dict[int, Vector] = {}
    for i in turn.rows:
        for j in columns.pop(i):
            if j in columns and j not in turn.rows:
                coupled.setdefault(j, [columns[j].pop(k, ZERO) for k in turn.rows])
    z = cross(axes[0], axes[1])
    step = _Step(turn, axes, inertia, coupled, z, dot(z, z) if len(axes) == 2 else dot(z, axes[2]))
    if step.leaves_one:
        y = turn.rows[-1]
        columns[y] = {y: dot(z, turned(z, inertia))}
        for j, factors in coupled.items():
            columns[y][j] = columns[j][y] = dot(factors, z)
    return step


def _prescribe(step: _Step, b: list[ca.SX]) -> None:
    """Eliminate what a joint prescribes of a relative rotation from the right-hand side."""
    given = [b[m] for m in step.turn.multipliers]
    if step.leaves_one:
        first, second = step.axes
        across = [(given[0] * y - given[1] * x) / step.divisor for x, y in zip(first, second, strict=True)]
        step.prescribed = cross(across, step.z)
    else:
        dual = _dual(step)
        step.prescribed = [
            (given[0] * dual[0][k] + given[1] * dual[1][k] + given[2] * dual[2][k]) / step.divisor for k in SPACE
        ]
    step.right = [b[i] for i in step.turn.rows]
    for j, factors in step.coupled.items():
        b[j] = b[j] - dot(factors, step.prescribed)
    if step.leaves_one:
        b[step.turn.rows[-1]] = dot(step.z, step.right) - dot(turned(step.z, step.inertia), step.prescribed)


def _recover(step: _Step, x: list[ca.SX]) -> None:
    """The relative rotation of a joint and its multipliers."""
    turn = step.turn
    e = step.prescribed
    if step.leaves_one:
        e = [z * x[turn.rows[-1]] + of for z, of in zip(step.z, e, strict=True)]
    rest = [r - of for r, of in zip(step.right, turned(e, step.inertia), strict=True)]
    for j, factors in step.coupled.items():
        rest = [r - factor * x[j] for r, factor in zip(rest, factors, strict=True)]
    if step.leaves_one:
        across = [of / step.divisor for of in cross(step.z, rest)]
        x[turn.multipliers[0]], x[turn.multipliers[1]] = dot(step.axes[1], across), -dot(step.axes[0], across)
    else:
        for m, of in zip(turn.multipliers, _dual(step), strict=True):
            x[m] = dot(of, rest) / step.divisor
    for i, value in zip(turn.rows, e, strict=True):
        x[i] = value


def _dual(step: _Step) -> list[Vector]:
    """The vectors whose products with the axes are 0 or the divisor: those of their pairs."""
    a, b, c = step.axes
    return [cross(b, c), cross(c, a), step.z]
