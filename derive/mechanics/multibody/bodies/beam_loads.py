"""Distributed loads on a rod, exactly: the resultant of each, at a point that moves as the mean over the load does.

The virtual work of a load p(xi) along a direction d is int p d . delta x dx. Since x is linear in 1, X, the shapes and
the psi_ij, it is that of the force int p dx at a point with the position int p X dx and the shapes int p phi_i dx, both
over int p dx, and likewise int p psi_ij dx. A load without resultant is the sum of two that have one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.mechanics.bodies.beam_functions import ONE, BeamFunction, fraction, rational
from derive.mechanics.bodies.reference_conditions import on_piece
from derive.mechanics.multibody.bodies.body_type import CrossSection
from derive.spec.model.forces import Force
from derive.spec.model.markers import MarkerRef
from derive.spec.model.planar_bodies import BeamBody, DistributedLoad
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.model.spatial_beam_parts import SpatialDistributedLoad
from derive.spec.model.time_function import TimeFunction

if TYPE_CHECKING:
    from derive.algebra import sp

MOST_POINTS = 64
"""The largest number of sections of a piece on which a torque per length may act."""

AnyLoad = DistributedLoad | SpatialDistributedLoad
"""A distributed load in the plane or in space."""


@dataclass(frozen=True)
class LoadResultant:
    """A load with a resultant on a piece: the name of its point, the component (from 0), and p(xi) of the piece."""

    point: str
    component: int
    load: AnyLoad
    density: BeamFunction

    @property
    def total(self) -> Fraction:
        """The resultant on a piece of half the length 1, N/m."""
        return fraction(self.density.integral()) / 2

    def mean(self, of: BeamFunction) -> sp.Rational:
        """The mean of a function of xi over the load."""
        return rational((self.density * of).integral() / self.density.integral())


def resultants(loads: Iterable[AnyLoad], pieces: int, piece: int) -> Iterator[LoadResultant]:
    """The loads on a piece of a rod, counted from 0: one or two with a resultant for each component."""
    for load in loads:
        for component, of_rod in enumerate(load.force):
            density = on_piece(of_rod, pieces, piece)
            if density.is_zero:
                continue
            parts = [density] if density.integral() else [density + ONE, -ONE]
            for part, of_part in enumerate(parts):
                yield LoadResultant(point_name(load.name, component, part, piece), component, load, of_part)


def point_name(load: str, component: int, part: int, piece: int) -> str:
    """The name of the point of a resultant; the pieces of a rod share the names of their constants, but not these."""
    return f"{load}_{piece + 1}_{component + 1}{'ab'[part]}"


def point_names(load: str, pieces: int) -> set[str]:
    """All names that the points of the resultants of a load may have."""
    return {point_name(load, c, part, piece) for c in (0, 1, 2) for part in (0, 1) for piece in range(pieces)}


def torque_name(load: str, piece: int, k: int) -> str:
    """The name of the section of a piece, counted from 0, on which torque k of a load in space acts."""
    return f"{load}_{piece + 1}_t{k}"


def section_names(load: str, pieces: int) -> set[str]:
    """All names that the sections on which a load in space acts may have."""
    of_torques = {torque_name(load, piece, k) for piece in range(pieces) for k in range(1, MOST_POINTS + 1)}
    return of_torques | point_names(load, pieces)


def load_points(body: BeamBody, piece: int) -> dict[str, CrossSection]:
    """The points of a piece of a rod, counted from 0, at which the resultants of its loads act; they turn with Q."""
    from derive.mechanics.bodies.beam import point_that_sees

    result = {}
    for r in resultants(body.loads, body.pieces, piece):
        docs = (f"point of load {r.load.name}", f"mean position of load {r.load.name}")
        point = point_that_sees(r.point, docs, body.beam, body.pieces, r.mean, "the load is symmetric")
        result[r.point] = CrossSection(point)
    return result


def load_forces(body: BeamBody, piece: int, name: str) -> Iterator[Force]:
    """The resultants of the loads on a piece, which is called `name`."""
    zero = number_function(Fraction(0))
    for r in resultants(body.loads, body.pieces, piece):
        force = per_length(r.total / body.pieces, body.beam.length, r.load.time)
        components = (zero, force) if r.component else (force, zero)
        yield Force(f"{name}_{r.point}", MarkerRef(name, r.point), components, r.load.frame)


def per_length(value: Fraction, length: Quantity, time: TimeFunction) -> TimeFunction:
    """A load per length times the length of a beam and a function of time."""
    return TimeFunction("mul", (TimeFunction("mul", (number_function(value), _quantity(length))), time))


def number_function(value: Fraction) -> TimeFunction:
    """The constant function of time."""
    return TimeFunction("number", value=value)


def _quantity(value: Quantity) -> TimeFunction:
    return TimeFunction("parameter", parameter=value) if isinstance(value, Parameter) else number_function(value)
