"""Recursions along links: the forces that a motion needs (Newton and Euler), and accelerations (articulated bodies).

The second solves M x = b without M. From the leaves to the root, each link gets the inertia that the bodies behind it
have for what carries them, in which the degrees of freedom behind are free: a block of LDL^T for each joint.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from derive.lowering.flat.casadi_symbols import added, multiplied, subtracted
from derive.lowering.flat.trees.links import TreeFrame
from derive.lowering.flat.trees.spatial_vectors import NEXT, SpatialInertia, cross, null, plus, times
from derive.lowering.flat.trees.steps import NO_WRENCH, ReleasedFreedom, SingleFreedom, TurnedFrame, Wrench, eliminate
from derive.lowering.vectors import ZERO, Vector

Wrenches = Sequence[Wrench]


def motions(links: Sequence[TreeFrame], accelerations: Mapping[int, ca.SX]) -> list[TurnedFrame]:
    """The motions of all links; accelerations: of the rows that have one."""
    result: list[TurnedFrame] = []
    for link in links:
        m = link.base if link.parent < 0 else result[link.parent]
        for step in link.steps:
            m = step.motion(m, accelerations.get(step.row, ZERO)) if isinstance(step, SingleFreedom) else step.motion(m)
        result.append(m)
    return result


def needed(link: TreeFrame, m: TurnedFrame) -> Wrench:
    """The wrench that the motion of a link needs: int (a + S X) and int X x (a + S X) over its mass."""
    S, half = m.of_points, link.half_trace
    second = [[subtracted(half, x) if i == j else -x for j, x in enumerate(row)] for i, row in enumerate(link.tensor)]
    force = plus([multiplied(link.mass, x) for x in m.linear], times(S, link.moment))
    torque = cross(link.moment, m.linear)
    for k, (i, j) in enumerate(NEXT):
        unequal = subtracted(S[j][j], S[i][i])
        parts = (
            subtracted(multiplied(S[j][i], second[i][i]), multiplied(S[i][j], second[j][j])),
            multiplied(unequal, second[i][j]),
            subtracted(multiplied(S[j][k], second[k][i]), multiplied(S[i][k], second[k][j])),
        )
        for part in parts:
            torque[k] = added(torque[k], part)
    return Wrench(force, torque)


def forces(links: Sequence[TreeFrame], wrenches: Wrenches) -> dict[int, ca.SX]:
    """The generalised forces of wrenches on all links, by row."""
    behind, result = [*wrenches], dict[int, ca.SX]()
    for n in reversed(range(len(links))):
        w = behind[n]
        for step in reversed(links[n].steps):
            if isinstance(step, SingleFreedom):
                result[step.row] = step.force(w)
            else:
                w = step.wrench(w)
        if links[n].parent >= 0:
            behind[links[n].parent] = behind[links[n].parent] + w
    return result


@dataclass(frozen=True)
class ArticulatedBodies:
    """The factors of M along links: each degree of freedom as eliminated, by row."""

    links: Sequence[TreeFrame]
    eliminated: Mapping[int, ReleasedFreedom]

    def forward(self, right: Mapping[int, ca.SX], wrenches: Wrenches = ()) -> dict[int, ca.SX]:
        """L^-1 (right - what the wrenches contribute to the rows): the forces that accelerate each row alone."""
        behind = [*wrenches] or [NO_WRENCH] * len(self.links)
        rests: dict[int, ca.SX] = {}
        for n in reversed(range(len(self.links))):
            w = behind[n]
            for step in reversed(self.links[n].steps):
                if isinstance(step, SingleFreedom):
                    w = self._released(step, w, right.get(step.row, ZERO), rests)
                else:
                    w = step.wrench(w)
            parent = self.links[n].parent
            if parent >= 0:
                behind[parent] = behind[parent] + w
        return rests

    def _released(self, step: SingleFreedom, w: Wrench, right: ca.SX, rests: dict[int, ca.SX]) -> Wrench:
        """The wrench before a degree of freedom, the force that accelerates which alone enters `rests`."""
        of = self.eliminated[step.row]
        rest = rests[step.row] = subtracted(right, step.force(w))
        total = [added(x, multiplied(f, rest)) for x, f in zip([*w.force, *w.torque], of.factors, strict=True)]
        if step.place is not None:
            total[step.place] = right
        return Wrench(total[:3], total[3:])

    def backward(self, rests: Mapping[int, ca.SX]) -> tuple[dict[int, ca.SX], list[tuple[Vector, Vector]]]:
        """L^-T D^-1 rests: the accelerations of rows, and those of the links, linear and angular."""
        known: list[tuple[Vector, Vector]] = []
        result: dict[int, ca.SX] = {}
        for link in self.links:
            x, y = (null(), null()) if link.parent < 0 else known[link.parent]
            for step in link.steps:
                if isinstance(step, SingleFreedom):
                    free = multiplied(rests[step.row], self.eliminated[step.row].inverse)
                    x, y, result[step.row] = self._moved(step, x, y, free)
                else:
                    x, y = step.accelerations(x, y)
            known.append((x, y))
        return result, known

    def _moved(self, step: SingleFreedom, x: Vector, y: Vector, free: ca.SX) -> tuple[Vector, Vector, ca.SX]:
        """The accelerations behind a degree of freedom, and its own."""
        of, both = self.eliminated[step.row], [*x, *y]
        if (place := step.place) is not None:
            total = free
            for k, (factor, value) in enumerate(zip(of.factors, both, strict=True)):
                if k != place:
                    total = subtracted(total, multiplied(factor, value))
            own = subtracted(total, both[place])
            both[place] = total
            return both[:3], both[3:], own
        own = free
        for factor, value in zip(of.factors, both, strict=True):
            own = subtracted(own, multiplied(factor, value))
        linear, angular = step.direction
        moved = [added(value, multiplied(d, own)) for value, d in zip(both, [*linear, *angular], strict=True)]
        return moved[:3], moved[3:], own


def articulated_bodies(
    links: Sequence[TreeFrame], more: Sequence[tuple[int, SpatialInertia]] = ()
) -> ArticulatedBodies:
    """The factors of M along links; more: inertias that links have besides their own, by number."""
    inertias = [link.inertia for link in links]
    for n, of in more:
        inertias[n] = inertias[n] + of
    eliminated: dict[int, ReleasedFreedom] = {}
    for n in reversed(range(len(links))):
        inertia: SpatialInertia = inertias[n]
        for step in reversed(links[n].steps):
            if isinstance(step, SingleFreedom):
                eliminated[step.row], inertia = eliminate(step, inertia)
            else:
                inertia = step.inertia(inertia)
        if links[n].parent >= 0:
            inertias[links[n].parent] = inertias[links[n].parent] + inertia
    return ArticulatedBodies(links, eliminated)
