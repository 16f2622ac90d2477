"""Bodies that hang on one body of a tree, as an inertia and a force that they add to it.

With the factors R of the acceleration of that body in the constraints of the leaf, and the compliance S = G M^-1 G^T of
the leaf in them, the multipliers are S^-1 (gamma' - R a), where gamma' is what the leaf without them would lack. The
body feels R^T S^-1 R as inertia, and the force R^T S^-1 gamma'.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from derive.lowering.flat.casadi_symbols import multiplied, subtracted
from derive.lowering.flat.trees.compliance import Compliance
from derive.lowering.flat.trees.joint_rows import JointRow
from derive.lowering.flat.trees.links import TreeFrames
from derive.lowering.flat.trees.other_bodies import TreeLeaf
from derive.lowering.flat.trees.spatial_vectors import SpatialInertia, dot
from derive.lowering.flat.trees.steps import NO_WRENCH, Shift, Wrench
from derive.lowering.ldlt import backward, forward
from derive.lowering.vectors import Vector


@dataclass(frozen=True)
class HungBodies:
    """A leaf on the body of a tree with the number `link`: see above. shift: to the point about which wrenches are.

    reactions: L^-1 R by columns, six vectors, with the factors L D L^T of S. lacking: L^-1 gamma'.
    """

    leaf: TreeLeaf
    link: int
    shift: Shift
    compliance: Compliance
    reactions: Sequence[Sequence[ca.SX]]
    lacking: Sequence[ca.SX]

    @property
    def _scaled(self) -> list[list[ca.SX]]:
        factors = self.compliance.factors
        inverses = dict(zip(factors.order, factors.inverses, strict=True))
        return [[multiplied(x, inverses[k]) for k, x in enumerate(column)] for column in self.reactions]

    @property
    def inertia(self) -> SpatialInertia:
        """The inertia that the body feels."""
        scaled = self._scaled
        known = {(i, j): dot(scaled[i], self.reactions[j]) for i in range(6) for j in range(i, 6)}
        full = [[known[min(i, j), max(i, j)] for j in range(6)] for i in range(6)]
        upper, lower = full[:3], full[3:]
        of = SpatialInertia([row[:3] for row in upper], [row[3:] for row in upper], [row[3:] for row in lower])
        return self.shift.inertia(of)

    @property
    def needed(self) -> Wrench:
        """The wrench that the leaf needs from the body without an acceleration of that."""
        total = [-dot(column, self.lacking) for column in self._scaled]
        return self.shift.wrench(Wrench(total[:3], total[3:]))

    def multipliers(self, acceleration: tuple[Vector, Vector]) -> dict[int, ca.SX]:
        """The multipliers by constraint; acceleration: of the body."""
        linear, angular = self.shift.accelerations(*acceleration)
        both = [*linear, *angular]
        left = [
            subtracted(lack, dot(both, [column[k] for column in self.reactions])) for k, lack in enumerate(self.lacking)
        ]
        return dict(zip(self.leaf.constraints, backward(self.compliance.factors, left), strict=True))


def hung_bodies(
    frames: TreeFrames, leaf: TreeLeaf, rows: Sequence[JointRow], compliance: Compliance, lacking: Sequence[ca.SX]
) -> HungBodies:
    """A leaf with the rows of its constraints; lacking: gamma'."""
    link, factors = frames.numbers[leaf.carrier], compliance.factors
    loads = [row.on_links.get(link) for row in rows]
    origin = next(place for place, _ in filter(None, loads))
    wrenches = [_about(origin, *load) if load else NO_WRENCH for load in loads]
    columns = zip(*([*w.force, *w.torque] for w in wrenches), strict=True)
    reactions = [forward(factors, list(column)) for column in columns]
    return HungBodies(leaf, link, Shift(origin), compliance, reactions, forward(factors, list(lacking)))


def _about(origin: Vector, place: Vector, wrench: Wrench) -> Wrench:
    """A wrench about a place as one about another origin."""
    return Shift([subtracted(x, of) for x, of in zip(place, origin, strict=True)]).wrench(wrench)
