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


@dataclass(frozen=True, eq=False)
class MissedForms:
    """The fields that the shapes of a beam miss in a plane, as forms of z = [q; v; outputs; t].

    moments (., z), deflections (PLACES, z): in sections, and along the beam. energies (., z): square roots of parts of
    the strain energy. slopes (pieces, POINTS, z): those of the deflections.
    """

    moments: Matrix
    deflections: Matrix
    energies: Matrix
    slopes: Matrix


class Plane(Protocol):
    """A plane in which a beam bends, or its twist: the numbers of its amplitudes and of all their rates."""

    shapes: PieceShapes
    amplitudes: list[list[int]]
    rates: list[int]

    @property
    def missed(self) -> MissedForms:
        """The fields that its shapes miss."""
        ...

    def stiffened(self, motions: Matrix) -> Iterator[tuple[int, Matrix]]:
        """The numbers in z of axial forces, and what each unit of them adds to the stiffness for motions (n, nq)."""
        ...

    def stiffened_fields(self, fields: Matrix) -> Iterator[tuple[int, Matrix]]:
        """The same for what the shapes miss in changes of z, columns of `fields` (z, n)."""
        ...

    def softened(self, motions: Matrix) -> tuple[Vector, Matrix]:
        """The spin in this plane as a form (z,), and what the square of a unit of it takes away of the stiffness."""
        ...


@dataclass(frozen=True, eq=False)
class Vibration:
    """A vibration of a beam: the motion (nq,) of all coordinates of its scene.

    frequency: that of its strain energy alone, rad/s. missed: the strain energy that the shapes miss, relative to it.
    columns, part: the numbers in z of the rates of all its amplitudes, and the factors of these that give how much of
    the motion it is. axial: the factors of axial forces, by their numbers in z, in the stiffness that they add to it,
    relative to that of its strain energy. axial_missed: the same of what is missed. turns: forms (z,);
    the square of each is the part of the stiffness that a spin takes away.
    """

    motion: Vector
    frequency: float
    missed: float
    columns: list[int]
    part: Matrix
    axial: dict[int, float]
    axial_missed: dict[int, float]
    turns: list[Vector]


def vibrations_of(
    modes: Sequence[HeldMode], planes: Sequence[Plane], response: StaticResponse, start: Vector
) -> tuple[Vibration, ...]:
    """The vibrations of a beam whose modes without axial forces are known; start (z,): the begin of the run.

    With respect to the strain energy these modes are orthogonal, so that each is a part of the motion.
    """
    if not modes:
        return ()
    motions = np.array([mode.motion for mode in modes])
    squares = np.array([mode.frequency**2 for mode in modes])
    columns = [column for plane in planes for column in plane.rates]
    parts = [
        np.concatenate([(mode.motion[p.amplitudes] @ p.shapes.stiffness).ravel() for p in planes]) / mode.frequency**2
        for mode in modes
    ]
    added = defaultdict[int, Matrix](lambda: np.zeros((len(modes),) * 2))
    for plane in planes:
        for force, stiffness in plane.stiffened(motions):
            added[force] += stiffness
    softened = [plane.softened(motions) for plane in planes]
    total = np.diag(squares) + sum(start[force] * of for force, of in added.items())
    total -= sum((spin @ start) ** 2 * of for spin, of in softened)

    changes = np.array([response(motion) for motion in motions]).T
    fields = np.vstack([np.sqrt(2) * plane.missed.energies @ changes for plane in planes])
    stiffer = defaultdict[int, Matrix](lambda: np.zeros((len(modes),) * 2))
    for plane in planes:
        for force, stiffness in plane.stiffened_fields(changes):
            stiffer[force] += stiffness

    def of_modes(c: Vector) -> Vibration:
        kept, missed = float(c**2 @ squares), float(np.sum((fields @ c) ** 2))
        axial = {force: float(c @ of @ c) / kept for force, of in added.items()}
        of_missed = {force: float(c @ of @ c) / missed for force, of in stiffer.items() if missed}
        turns = [spin * np.sqrt(c @ of @ c / kept) for spin, of in softened if spin.any()]
        return Vibration(c @ motions, np.sqrt(kept), missed / kept, columns, c[None] @ parts, axial, of_missed, turns)

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
