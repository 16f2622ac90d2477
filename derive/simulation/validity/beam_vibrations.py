"""The vibrations of a beam in all planes in which it bends, under the axial force with which a run starts.

Joints and offsets couple the deflections of a beam with each other and with its twist, where their frequencies are near
each other. At second order an axial force N changes those of the deflections, by the integral of N s'^2 for the slope
s' of a vibration against the direction of the force. A blade that spins has deflections that are many times as stiff as
they are at rest; there its joints may couple them with a twist that they have nothing to do with while it spins.
"""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.linalg import eigh

from derive.runtime.native_call import Matrix, Vector
from derive.simulation.validity.held_beam import HeldMode, StaticResponse
from derive.simulation.validity.piece_shapes import PieceShapes

NEAR = 0.1
"""Frequencies that differ by less are almost equal."""


class Plane(Protocol):
    """A plane in which a beam bends, or its twist: the numbers of its amplitudes and of all their rates.

    missed: forms of z = [q; v; outputs; t], of which the last are square roots of the strain energy that shapes miss.
    """

    shapes: PieceShapes
    amplitudes: list[list[int]]
    rates: list[int]

    @property
    def missed(self) -> tuple[Matrix, Matrix, Matrix]:
        """The moments, deflections and energies that its shapes miss."""
        ...

    def stiffened(self, velocities: Matrix) -> Iterator[tuple[int, Matrix]]:
        """The numbers in z of axial forces, and what each unit of them adds to the stiffness for motions (n, nv)."""
        ...


@dataclass(frozen=True, eq=False)
class Vibration:
    """A vibration of a beam: the motion (nq,) of all coordinates of its scene.

    frequency: that of its strain energy alone, rad/s. missed: the strain energy that the shapes miss, relative to it.
    columns, part: the numbers in z of the rates of all its amplitudes, and the factors of these that give how much of
    the motion it is. axial: the factors of axial forces, by their numbers in z, in the stiffness that they add to it,
    relative to that of its strain energy.
    """

    motion: Vector
    frequency: float
    missed: float
    columns: list[int]
    part: Matrix
    axial: dict[int, float]


def vibrations_of(
    modes: Sequence[HeldMode], planes: Sequence[Plane], response: StaticResponse, start: Vector
) -> tuple[Vibration, ...]:
    """The vibrations of a beam whose modes without axial forces are known; start (z,): the begin of the run.

    With respect to the strain energy these modes are orthogonal, so that each is a part of the motion.
    """
    if not modes:
        return ()
    motions, velocities = (np.array([getattr(mode, of) for mode in modes]) for of in ("motion", "velocities"))
    squares = np.array([mode.frequency**2 for mode in modes])
    columns = [column for plane in planes for column in plane.rates]
    parts = [
        np.concatenate([(mode.motion[p.amplitudes] @ p.shapes.stiffness).ravel() for p in planes]) / mode.frequency**2
        for mode in modes
    ]
    added = defaultdict[int, Matrix](lambda: np.zeros((len(modes),) * 2))
    for plane in planes:
        for force, stiffness in plane.stiffened(velocities):
            added[force] += stiffness
    total = np.diag(squares) + sum(start[force] * of for force, of in added.items())

    changes = np.array([response(motion) for motion in motions]).T
    fields = np.vstack([np.sqrt(2) * plane.missed[2] @ changes for plane in planes])

    def of_modes(c: Vector) -> Vibration:
        kept, missed = float(c**2 @ squares), float(np.sum((fields @ c) ** 2))
        axial = {force: float(c @ of @ c) / kept for force, of in added.items()}
        return Vibration(c @ motions, np.sqrt(kept), missed / kept, columns, c[None] @ parts, axial)

    stiffnesses, combinations = eigh(total)
    return tuple(map(of_modes, _apart(stiffnesses, combinations, fields)))


def _apart(stiffness: Vector, modes: Matrix, fields: Matrix) -> Iterator[Vector]:
    """The columns of modes (n, n), whose stiffnesses (n,) increase, in groups with almost equal frequencies.

    Such vibrations do not lose their phases against each other for some periods. Any combinations of them will do, and
    the ones that are late by themselves are those whose missed fields (., n) are orthogonal.
    """
    begins = [0, *(np.flatnonzero(stiffness[1:] > (1 + NEAR) ** 2 * np.maximum(stiffness[:-1], 0)) + 1)]
    for begin, end in itertools.pairwise([*begins, len(stiffness)]):
        group = modes[:, begin:end]
        missed = fields @ group
        yield from (group @ eigh(missed.T @ missed)[1]).T
