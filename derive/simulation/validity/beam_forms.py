"""The forms of a beam in a plane in which it bends, or of its twist: its deflection, and what changes its stiffness.

What a model leaves out is compared with the stiffness of the beam in the shape of its lowest mode, as the joints hold
it. First order leaves out what an axial force N(xi) adds: the integral of N v'^2 along the beam. All models leave out
what a large deflection adds: in an inextensible beam the curvature is v''/sqrt(1 - v'^2), and the strain energy has a
further part, the integral of 1/2 EI v''^2 v'^2.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property

import numpy as np

from derive.runtime.native_call import Matrix, Vector
from derive.simulation.observables.beams import piece_names
from derive.simulation.validity.beam_line import PLACES, deflections_along, twists_along
from derive.simulation.validity.beam_vibrations import MissedForms
from derive.simulation.validity.held_beam import HeldMode, StaticResponse
from derive.simulation.validity.known_gaps import known_gaps
from derive.simulation.validity.missed_moment import missed_fields
from derive.simulation.validity.piece_frames import PieceFrames
from derive.simulation.validity.piece_shapes import PieceShapes, gauss_points
from derive.simulation.validity.surroundings import Surroundings
from derive.simulation.validity.turned_stiffness import TurnedStiffness
from derive.simulation.validity.watched_forms import WatchedForms
from derive.spec.model.body import DisplacementOrder

SLOPE = 1e-9
"""Shapes with smaller slopes at an end, per amplitude over the length, do not rotate it."""


class BeamForms:
    """The forms of a beam in a plane; modes: its vibrations there alone; response: to such motions."""

    def __init__(
        self,
        around: Surroundings,
        forms: WatchedForms,
        shapes: PieceShapes,
        modes: Sequence[HeldMode],
        response: StaticResponse,
        frames: PieceFrames,
    ) -> None:
        self.around, self.forms, self.shapes = around, forms, shapes
        beam, native = shapes.beam, forms.native
        self.pieces = piece_names(beam)
        self.amplitudes = [shapes.amplitudes_in(native, piece) for piece in self.pieces]
        self.columns = [column for columns in self.amplitudes for column in columns]
        self.rates = [native.nq + column for piece in self.pieces for column in shapes.rates_in(native, piece)]
        self.turned = TurnedStiffness(around, forms, shapes, frames, self.pieces, self.amplitudes)
        if modes:
            self.frequency, self.lowest = modes[0].frequency, modes[0].motion[self.amplitudes]
            self.motion: Vector | None = modes[0].motion
            self.change = response(modes[0].motion)[:, None]
        else:  # nothing deforms it alone: its first shape stands for that of the loads
            self.motion, self.change = None, np.zeros((forms.size, 0))
            self.frequency, self.lowest = np.inf, np.tile(np.eye(len(shapes.stiffness))[0], (beam.pieces, 1))
        ends = around.held
        self.clamped = ends[0] if len(ends) == 1 else None
        self.rotations_act = len(self.pieces) > 1 or any(
            np.abs(shapes.slopes(np.array([float(end)])) * shapes.length).max() > SLOPE for end in ends
        )

    def along(self, values: Matrix, slopes: Matrix) -> Matrix:
        """The deflection of the beam per unit of fields of its pieces; of torsion see `twists_along`."""
        if self.shapes.twists:
            return twists_along(values, len(self.pieces), self.clamped)
        return deflections_along(values, slopes, self.shapes.length, len(self.pieces), self.clamped)

    @cached_property
    def missed(self) -> MissedForms:
        """The fields that the shapes miss: in sections of all pieces, along the beam, and in energies."""
        moments, deflections, energies = list[Matrix](), np.zeros((PLACES, self.forms.size)), list[Matrix]()
        slopes, turned = list[Matrix](), np.zeros(self.forms.size)
        for i, known in enumerate(known_gaps(self.around, self.forms, self.shapes, self.amplitudes)):
            form = np.array([gap.form for gap in known])
            missed = missed_fields(self.shapes, [(gap.xi, gap.order) for gap in known])
            moments.append(missed.moments.T @ form)
            energies.append(missed.energies @ form)
            deflections += self.along(missed.values, missed.slopes).reshape(PLACES, -1, len(known))[:, i] @ form
            slopes.append((missed.along - missed.slopes[:, :1]).T @ form + turned)
            turned = turned + (missed.slopes[:, 1] - missed.slopes[:, 0]) @ form
        along = np.array(slopes)
        if self.clamped is None:  # slopes from the chord
            along -= np.mean(gauss_points()[1] @ along, axis=0) / 2
        elif self.clamped == 1:
            along -= turned
        return MissedForms(np.vstack(moments), deflections, np.vstack(energies), along)

    @property
    def strain(self) -> float:
        """Twice the strain energy of the mode."""
        a = self.lowest
        return float(np.sum(a * (a @ self.shapes.stiffness)))

    def hardening(self, bent: Matrix) -> float:
        """The stiffness that a large deflection adds, relative to that of the mode, over its square, 1/m^2."""
        if self.shapes.twists:
            return 0.0
        xi, weights = gauss_points()
        a, shapes = self.lowest, self.shapes
        squares = (a @ shapes.moments(xi)) ** 2 * weights
        added = 2 * float(np.sum(squares * (a @ shapes.slopes(xi)) ** 2) / np.sum(squares))
        return added / float(np.abs(bent @ a.ravel()).max()) ** 2

    def axial(self) -> tuple[list[int], Matrix]:
        """The stiffness that the axial force adds to the lowest mode, relative to it: the factors of elements of z."""
        slopes = self.lowest @ self.shapes.slopes(gauss_points()[0])  # relative to the frames of the pieces
        return _factors(self.turned.of_slopes(lambda piece: slopes[[piece]]), self.strain)

    def whole_axial(self) -> tuple[list[int], Matrix]:
        """The stiffness that the axial force adds to the lowest mode with the rotations of pieces, relative to it."""
        return _factors(self.turned.added(self.motion[None]) if self.motion is not None else (), self.strain)

    def axial_missed(self) -> tuple[list[int], Matrix]:
        """The stiffness that the axial force adds to what the shapes miss of the lowest mode, alike."""
        missed = 2 * float(np.sum((self.missed.energies @ self.change) ** 2))
        return _factors(self.stiffened_fields(self.change) if missed else (), missed)

    @property
    def second_order(self) -> bool:
        """Whether the model knows what axial forces and spins add to its stiffness in bending."""
        return not self.shapes.twists and self.shapes.beam.beam.order is not DisplacementOrder.FIRST_ORDER

    def stiffened(self, motions: Matrix) -> Iterator[tuple[int, Matrix]]:
        """The numbers in z of axial forces, and what each unit of them adds to the stiffness for motions (n, nq).

        It is that of second order, which a model of first order does not have.
        """
        return self.turned.added(motions) if self.second_order else iter(())

    def stiffened_fields(self, changes: Matrix) -> Iterator[tuple[int, Matrix]]:
        """The same for what the shapes miss in changes of z, columns of `changes` (z, n)."""
        slopes = self.missed.slopes
        return self.turned.of_slopes(lambda piece: (slopes[piece] @ changes).T) if self.second_order else iter(())

    def softened(self, motions: Matrix) -> tuple[Vector, Matrix]:
        """The spin in this plane as a form (z,), and what the square of a unit of it takes away of the stiffness."""
        if self.second_order:
            return self.turned.taken(motions)
        return np.zeros(self.forms.size), np.zeros((len(motions),) * 2)


def _factors(added: Iterable[tuple[int, Matrix]], stiffness: float) -> tuple[list[int], Matrix]:
    """The numbers in z of axial forces and their factors (1, forces) in what they add, relative to a stiffness."""
    forces = [*added]
    factors = np.array([[float(of[0, 0]) / stiffness for _, of in forces]])
    return [column for column, _ in forces], factors
