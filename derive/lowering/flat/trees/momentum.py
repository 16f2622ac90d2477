"""The momenta of trees of bodies by the velocities of their joints, from the inertia of all bodies behind each joint.

A unit rate of a joint moves what is behind it as one rigid body: its momentum is that of the composite body. A body
that has its rotation against the inertial frame, and what is behind it, is moved without being turned. Vectors are in
the inertial frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from derive.lowering.flat.casadi_symbols import Symbols, added, multiplied
from derive.lowering.flat.trees.spatial_vectors import (
    Rotation,
    cross,
    multiply,
    null,
    plus,
    plus_matrix,
    symmetric,
    tensor_back,
    times,
    transposed,
)
from derive.lowering.vectors import Matrix, Vector
from derive.mechanics.multibody.space.tree.recursions import TreeBody


@dataclass(frozen=True)
class Composite:
    """The inertia of bodies about a point: their momentum where the point moves by T, and what turns with it by e.

    The linear momentum is mass T + e x moment, the angular momentum about the point is first x T + tensor e. `first`
    is the first moment of all bodies and `moment` that of what turns, the other bodies being masses at their joints.
    """

    mass: ca.SX
    moment: Vector
    first: Vector
    tensor: Matrix

    def __add__(self, other: Composite) -> Composite:
        moment = plus(self.moment, other.moment)
        first = moment if self.turns and other.turns else plus(self.first, other.first)
        return Composite(added(self.mass, other.mass), moment, first, plus_matrix(self.tensor, other.tensor))

    @property
    def turns(self) -> bool:
        """Whether all bodies turn, so that both moments are one, and the tensor is symmetric."""
        return self.first is self.moment

    def unturned(self) -> Composite:
        """The same bodies where they do not turn."""
        return Composite(self.mass, null(), self.first, [null() for _ in range(3)])

    def turned_back(self, rotation: Rotation) -> Composite:
        """The same along axes from which a rotation leads to these."""
        moment = rotation.back(self.moment)
        first = moment if self.turns else rotation.back(self.first)
        tensor = rotation.symmetric_back(self.tensor) if self.turns else tensor_back(rotation, self.tensor)
        return Composite(self.mass, moment, first, tensor)

    def from_point(self, r: Vector) -> Composite:
        """The same about another point, from which this one is at r."""
        mass_at = [multiplied(self.mass, x) for x in r]
        moved = plus(self.moment, mass_at)
        products = [multiplied(x, added(a, b)) for x, a, b in zip(r, self.first, moved, strict=True)]

        def entry(i: int, j: int) -> ca.SX:
            if i == j:
                return added(*(products[k] for k in range(3) if k != i))
            return -added(multiplied(r[i], self.first[j]), multiplied(moved[i], r[j]))

        shift = [[entry(i, j) for j in range(3)] for i in range(3)]
        if self.turns:
            return Composite(self.mass, moved, moved, plus_matrix(self.tensor, symmetric(shift)))
        return Composite(self.mass, moved, plus(self.first, mass_at), plus_matrix(self.tensor, shift))


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
            spin = plus(cross(behind.first, T), times(behind.tensor, e))
            result[row.name] = linear, plus(spin, cross(lever, linear))
        if motion.parent in composites:
            carried = behind if motion.turns_with_parent else behind.unturned()
            moved = carried.from_point([symbols(x) for x in motion.lever])
            composites[motion.parent] = composites[motion.parent] + moved
    return result


def _own(body: TreeBody, symbols: Symbols) -> Composite:
    """The inertia of a body about its origin."""
    Q, tensor = ([[symbols(of[i, j]) for j in range(3)] for i in range(3)] for of in (body.motion.frame, body.tensor))
    moment = times(Q, [symbols(x) for x in body.moment])
    return Composite(symbols(body.mass), moment, moment, symmetric(multiply(multiply(Q, tensor), transposed(Q))))
