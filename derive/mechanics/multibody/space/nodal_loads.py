"""Nodal loads on a finite-element body in space: the resultant of each component, at a point that moves as the mean.

The virtual work of forces w_a d along a direction d at nodes a is sum w_a d . delta x_a. Since x is linear in 1, X, the
modes and the Psi_ij, it is that of the force sum w_a d at a point with the weighted means of the positions, the modes
and the Psi_ij of the nodes. Forces of both signs are two such loads, so that all weights of a mean are positive.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from derive.mechanics.axes import AXES
from derive.spec.model.markers import MarkerRef
from derive.spec.model.spatial_bodies import FlexibleBody, NodalLoad
from derive.spec.model.spatial_forces import SpatialForce
from derive.spec.model.time_function import TimeFunction

SIGNS = {"p": 1, "n": -1}
"""The signs of forces by the ends of the names of their points."""


@dataclass(frozen=True)
class NodalResultant:
    """The forces of one sign along one axis (0 to 2): the name of their point, the nodes, and the forces there, N."""

    point: str
    axis: int
    load: NodalLoad
    nodes: tuple[int, ...]
    forces: tuple[Fraction, ...]


def nodal_resultants(body: FlexibleBody) -> Iterator[NodalResultant]:
    """The resultants of the loads on a body: up to two for each component."""
    for load in body.loads:
        for axis in range(3):
            for end, sign in SIGNS.items():
                pairs = zip(load.nodes, load.forces, strict=True)
                own = [(node, force[axis]) for node, force in pairs if sign * force[axis] > 0]
                if own:
                    nodes, forces = zip(*own, strict=True)
                    yield NodalResultant(load_point(load.name, axis + 1, end), axis, load, nodes, forces)


def load_point(load: str, component: int, end: str) -> str:
    """The name of the point of a resultant."""
    return f"{load}_{component}{end}"


def load_points(load: str) -> set[str]:
    """All names that the points of the resultants of a load may have."""
    return {load_point(load, component, end) for component in AXES for end in SIGNS}


def nodal_forces(body: FlexibleBody) -> Iterator[SpatialForce]:
    """The resultants of the loads on a body as forces at their points."""
    for r in nodal_resultants(body):
        total = TimeFunction("mul", (_number(sum(r.forces, Fraction(0))), r.load.time))
        zero = _number(Fraction(0))
        force = (total if r.axis == 0 else zero, total if r.axis == 1 else zero, total if r.axis == 2 else zero)
        yield SpatialForce(f"{body.name}_{r.point}", MarkerRef(body.name, r.point), force, r.load.frame)


def _number(value: Fraction) -> TimeFunction:
    return TimeFunction("number", value=value)
