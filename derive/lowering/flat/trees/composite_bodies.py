"""The mass matrix of trees by composite bodies, each in the frame of its link, as forces pass from there to the root.

A unit rate of a degree of freedom moves all behind it as one rigid body, whose momentum is a wrench; what this does on
each degree of freedom before it is an entry.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import casadi as ca

from derive.lowering.flat.casadi_symbols import multiplied
from derive.lowering.flat.trees.links import TreeFrame
from derive.lowering.flat.trees.momentum import Composite
from derive.lowering.flat.trees.spatial_vectors import cross, null, plus, times
from derive.lowering.flat.trees.steps import Shift, SingleFreedom, Turn, Wrench

Entries = dict[tuple[int, int], ca.SX]


def mass_entries(links: Sequence[TreeFrame]) -> Entries:
    """The entries of M in the lower triangle, by rows and columns."""
    behind = [Composite(link.mass, link.moment, link.moment, link.tensor) for link in links]
    result: Entries = {}
    for n in reversed(range(len(links))):
        of, steps = behind[n], links[n].steps
        for k in reversed(range(len(steps))):
            match steps[k]:
                case SingleFreedom() as step:
                    wrench = _momentum(step, of)
                    result[step.row, step.row] = step.force(wrench)
                    for other, force in _before(links, n, k, wrench):
                        result[max(step.row, other), min(step.row, other)] = force
                case Turn() as step:
                    of = _mass_at_joint(of) if step.free else of.turned_back(step.rotation)
                case Shift() as step:
                    of = of.from_point(step.r)
        if links[n].parent >= 0:
            behind[links[n].parent] = behind[links[n].parent] + of
    return result


def _mass_at_joint(of: Composite) -> Composite:
    """The inertia of bodies for what they do not turn with, and to which they pass no torque."""
    none = null()
    return Composite(of.mass, none, none, [null() for _ in range(3)])


def _momentum(step: SingleFreedom, of: Composite) -> Wrench:
    """The momentum by a unit rate, as a force and a torque."""
    linear, angular = step.direction
    force = plus([multiplied(of.mass, x) for x in linear], cross(angular, of.moment))
    return Wrench(force, plus(cross(of.first, linear), times(of.tensor, angular)))


def _before(links: Sequence[TreeFrame], n: int, k: int, wrench: Wrench) -> Iterator[tuple[int, ca.SX]]:
    """Yield the rows before step k of link n with what a wrench there does on each."""
    steps = links[n].steps[:k]
    while True:
        for step in reversed(steps):
            if isinstance(step, SingleFreedom):
                yield step.row, step.force(wrench)
            else:
                wrench = step.wrench(wrench)
        n = links[n].parent
        if n < 0:
            return
        steps = links[n].steps
