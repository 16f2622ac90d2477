"""The stiffness that axial forces add to the motions of a beam in a plane, and that its spin takes away."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from derive.runtime.native_call import Matrix, Vector
from derive.simulation.validity.held_beam import moved_by_velocities
from derive.simulation.validity.piece_frames import PieceFrames
from derive.simulation.validity.piece_shapes import PieceShapes, gauss_points
from derive.simulation.validity.surroundings import Surroundings
from derive.simulation.validity.watched_forms import WatchedForms


@dataclass(frozen=True, eq=False)
class TurnedStiffness:
    """A beam in a plane, with the names of its pieces and the numbers of their amplitudes among the coordinates."""

    around: Surroundings
    forms: WatchedForms
    shapes: PieceShapes
    frames: PieceFrames
    pieces: Sequence[str]
    amplitudes: Sequence[list[int]]

    def added(self, motions: Matrix) -> Iterator[tuple[int, Matrix]]:
        """The numbers in z of axial forces, and what each unit of them adds to the stiffness for motions (n, nq)."""
        shapes, xi = self.shapes, gauss_points()[0]

        def slopes(piece: int) -> Matrix:
            turned: Matrix = self.frames.motion(shapes, self.pieces[piece], motions)[:, 1:]
            return motions[:, self.amplitudes[piece]] @ shapes.slopes(xi) + turned

        yield from self.of_slopes(slopes)

    def of_slopes(self, slopes: Callable[[int], Matrix]) -> Iterator[tuple[int, Matrix]]:
        """The same for fields with the slopes (n, POINTS) along a piece, by its number."""
        weights = self.shapes.length / 2 * gauss_points()[1]
        for column, power, near in self._axial_forces():
            weighted = np.hstack([weights * self._along(power, piece) for piece in near])
            along = np.hstack([slopes(piece) for piece in near])
            yield column, (along * weighted) @ along.T

    def _along(self, power: int, piece: int) -> Vector:
        """(POINTS,): the axial force along a piece for a unit of the factor of xi^power.

        Where an attached mass moves with the beam, the force jumps by the mass times its acceleration, which these
        factors give as they give that of the beam: (2 N_1 + 4 N_2 xi)/m. In the middle xi = 0 the force is that on the
        right, which is the one of N_0.
        """
        xi, _ = gauss_points()
        force = xi**power
        for of, at, mass in self.around.masses:
            if of == piece and power:
                beyond = (xi > at).astype(float) - (at <= 0)
                force = force + mass / self.shapes.mass * 2 * power * at ** (power - 1) * beyond
        return force

    def _axial_forces(self) -> Iterator[tuple[int, int, list[int]]]:
        """The factors of xi^power in axial forces: their numbers in z, the powers, and the pieces that have them.

        Pieces that are not monitored have the force of the nearest.
        """
        if not self.around.axial:
            return
        where = np.array([self.pieces.index(piece) for piece in self.around.axial])
        nearest = [int(np.abs(where - i).argmin()) for i in range(len(self.pieces))]
        for number, outputs in enumerate(self.around.axial.values()):
            near = [i for i, of in enumerate(nearest) if of == number]
            for power, output in enumerate(outputs):
                yield self.forms.output(output), power, near

    def taken(self, motions: Matrix) -> tuple[Vector, Matrix]:
        """The spin about the normal of the plane as a form (z,), and what the square of a unit of it takes away.

        The centrifugal force of a beam that spins in the plane in which it deflects has a part along the deflection.
        """
        native, (xi, weights) = self.forms.native, gauss_points()
        shapes, spin, taken = self.shapes, np.zeros(self.forms.size), np.zeros((len(motions),) * 2)
        unit = moved_by_velocities(native, self.frames.q, self.frames.k).T
        for number, (piece, amplitudes) in enumerate(zip(self.pieces, self.amplitudes, strict=True)):
            spin[native.nq : native.nq + native.nv] += self.frames.motion(shapes, piece, unit)[:, 1] / len(self.pieces)
            rise, slope = self.frames.motion(shapes, piece, motions).T
            attached = [(at, mass) for of, at, mass in self.around.masses if of == number]
            every = np.append(xi, [at for at, _ in attached])
            masses = np.append(shapes.mass / 2 * weights, [mass for _, mass in attached])
            along = motions[:, amplitudes] @ shapes.values(every) + np.outer(slope, shapes.length / 2 * every)
            along += rise[:, None]
            taken += (along * masses) @ along.T
        return spin, taken
