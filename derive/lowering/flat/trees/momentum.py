"""The momenta of trees of bodies by the velocities of their joints, from the inertia of all bodies behind each joint.

A unit rate of a joint moves what is behind it as one rigid body: its momentum is that of the composite body. Vectors
are in the inertial frame. A body with a quaternion of its own is not turned by the joints before it, which move it as a
mass at its joint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from derive.lowering.flat.casadi_symbols import Symbols, added, multiplied
from derive.lowering.flat.trees.spatial_vectors import (
    Matrix,
    Vector,
    cross,
    multiply,
    null,
    plus,
    plus_matrix,
    symmetric,
    times,
    transposed,
)
from derive.mechanics.multibody.space.tree.recursions import TreeBody


@dataclass(frozen=True)
class Composite:
    """The mass, the first moment and the inertia of bodies about a point."""

    mass: ca.SX
    moment: Vector
    tensor: Matrix

    def __add__(self, other: Composite) -> Composite:
        tensor = plus_matrix(self.tensor, other.tensor)
        return Composite(added(self.mass, other.mass), plus(self.moment, other.moment), tensor)

    def from_point(self, r: Vector) -> Composite:
        """The same about another point, from which this one is at r."""
        moved = plus(self.moment, [multiplied(self.mass, x) for x in r])
        squares = [multiplied(x, added(a, b)) for x, a, b in zip(r, self.moment, moved, strict=True)]

        def entry(i: int, j: int) -> ca.SX:
            if i == j:
                return added(*(squares[k] for k in range(3) if k != i))
            first, last = min(i, j), max(i, j)
            return -added(multiplied(r[first], moved[last]), multiplied(r[last], self.moment[first]))

        shift = [[entry(i, j) for j in range(3)] for i in range(3)]
        return Composite(self.mass, moved, plus_matrix(self.tensor, shift))


def momenta(bodies: Sequence[TreeBody], symbols: Symbols, centre: Vector) -> dict[str, tuple[Vector, Vector]]:
    """The linear momentum, and the angular momentum about `centre`, for a unit velocity of each row.

    bodies: those before others first.
    """
    composites = {body.name: _own(body, symbols) for body in bodies}
    result: dict[str, tuple[Vector, Vector]] = {}
    for body in reversed(bodies):
        motion, behind = body.motion, composites[body.name]
        lever = [added(symbols(x), -c) for x, c in zip(motion.position, centre, strict=True)]
        for row, v in zip(motion.own_rows, motion.own_virtual, strict=True):
            T, e = ([symbols(x) for x in of] for of in (v.translation, v.rotation))
            linear = plus([multiplied(behind.mass, x) for x in T], cross(e, behind.moment))
            spin = plus(cross(behind.moment, T), times(behind.tensor, e))
            result[row.name] = linear, plus(spin, cross(lever, linear))
        if motion.parent in composites:
            carried = behind if motion.turns_with_parent else Composite(behind.mass, null(), [null() for _ in range(3)])
            moved = carried.from_point([symbols(x) for x in motion.lever])
            composites[motion.parent] = composites[motion.parent] + moved
    return result


def _own(body: TreeBody, symbols: Symbols) -> Composite:
    """The inertia of a body about its origin."""
    Q, tensor = ([[symbols(of[i, j]) for j in range(3)] for i in range(3)] for of in (body.motion.frame, body.tensor))
    moment = times(Q, [symbols(x) for x in body.moment])
    return Composite(symbols(body.mass), moment, symmetric(multiply(multiply(Q, tensor), transposed(Q))))
