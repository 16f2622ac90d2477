"""The error of a beam of second order by the energy of higher order that its truncated terms leave out.

A section is displaced by w across the axis and, since the beam shortens, by -s along it, where s is quadratic in the
amplitudes. In a frame that turns with W, the terms of third and fourth order of the kinetic energy are the integrals of

    W (w s' - s w')   and   1/2 (s'^2 + W^2 s^2),

primes by time. That is all that is left out: they depend on W and the amplitudes alone, not on how the frame moves.
The strain energy lacks 1/2 EI v''^2 v'^2, see `watched_beam`, which often acts against them: what makes a vibration
stiffer makes up for the inertia that it lacks. What both would do to the motion of a run is a load on its vibrations,
from which follows the error of each. In space each plane has its own w and s, and the spin about its normal.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from derive.runtime.native_call import Matrix, Vector
from derive.simulation.observables.beams import function_values, piece_names, shortening_functions
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.validity.held_beam import moved_by_velocities
from derive.simulation.validity.piece_frames import PieceFrames
from derive.simulation.validity.piece_shapes import PieceShapes, gauss_points
from derive.simulation.validity.surroundings import surroundings
from derive.simulation.validity.watched_beam import SceneWatch, WatchedBeam


def truncated_energy_error(
    scene: SceneWatch, watched: WatchedBeam, motion: SceneMotion, frequencies: Vector, hardening: float
) -> float:
    """The error of the deflection of a beam, m: the largest root mean square along it in the rows of a motion.

    frequencies (n,), rad/s: those of its vibrations in the run. hardening: the part of the strain energy that counts.
    """
    motions = np.array([of.motion for of in watched.vibrations])
    momentum, force = 0.0, 0.0
    for left_out, amplitudes, turns in _of_pieces(motion, watched, motions, hardening):
        p, spin, f = left_out
        momentum = momentum + p @ motions[:, amplitudes].T + np.outer(spin, turns)
        force = force + f @ motions[:, amplitudes].T
    errors = _responses(motion.t, -np.asarray(momentum), np.asarray(force), frequencies)
    forms = scene.watch.quantities[watched.deflection].forms[:, : motion.native.nq]
    return float(np.sqrt(np.mean((errors @ (motions @ forms.T)) ** 2, axis=0)).max())


def _of_pieces(
    motion: SceneMotion, watched: WatchedBeam, motions: Matrix, hardening: float
) -> Iterator[tuple[tuple[Matrix, Vector, Matrix], list[int], Vector]]:
    """The energies that each piece leaves out, the numbers of its amplitudes, and its turn in each motion."""
    native, shapes = motion.native, watched.shapes
    frames = PieceFrames(native, motion.k, float(motion.t[0]), motion.q[0])
    unit = moved_by_velocities(native, motion.q[0], motion.k).T
    masses = surroundings(motion.scene, shapes).masses
    for number, piece in enumerate(piece_names(shapes.beam)):
        of = _Truncated.of(shapes, [(at, mass) for i, at, mass in masses if i == number])
        amplitudes, rates = shapes.amplitudes_in(native, piece), shapes.rates_in(native, piece)
        spin = motion.v @ frames.motion(shapes, piece, unit)[:, 1]
        left_out = of.left_out(motion.q[:, amplitudes], motion.v[:, rates], spin, hardening)
        yield left_out, amplitudes, frames.motion(shapes, piece, motions)[:, 1]


@dataclass(frozen=True, eq=False)
class _Truncated:
    """The integrals over the mass of a piece with s = 1/2 a S a: of w S (n, n, n), and of S S (n, n, n, n).

    strain (n, n, n, n): the integral of EI times two curvatures and two slopes.
    """

    third: Matrix
    fourth: Matrix
    strain: Matrix

    @classmethod
    def of(cls, shapes: PieceShapes, attached: list[tuple[float, float]]) -> _Truncated:
        """The integrals of a piece with its attached masses, kg, by their places."""
        points, weights = gauss_points()
        xi = np.append(points, [at for at, _ in attached])
        masses = np.append(shapes.mass / 2 * weights, [mass for _, mass in attached])
        w = shapes.values(xi)
        S = np.zeros((len(w), len(w), len(xi)))
        for i, j, shortening in shortening_functions(shapes.beam):
            S[i, j] = S[j, i] = -function_values(shortening, xi) * 2 / shapes.length
        bending = np.einsum("ip,jp->ijp", shapes.moments(points), shapes.moments(points)) / shapes.bending_stiffness
        turning = np.einsum("ip,jp->ijp", shapes.slopes(points), shapes.slopes(points)) * weights * shapes.length / 2
        return cls(
            np.einsum("kp,ijp,p->kij", w, S, masses),
            np.einsum("ijp,klp,p->ijkl", S, S, masses),
            np.einsum("ijp,klp->ijkl", bending, turning),
        )

    def left_out(self, a: Matrix, rates: Matrix, spin: Vector, hardening: float) -> tuple[Matrix, Vector, Matrix]:
        """The derivatives of what is left out of the Lagrangian by the rates (rows, n), the spin and the amplitudes."""
        n, W = a.shape[1], spin[:, None]
        squares, products = (np.einsum("ti,tj->tij", a, x).reshape(-1, n * n) for x in (a, rates))
        third, fourth = self.third.reshape(n, n * n), self.fourth.reshape(n * n, n * n)
        strain = self.strain.reshape(n * n, n * n)
        w_S, rate_S = (np.einsum("kij,tk->tij", self.third, x) for x in (a, rates))
        s_S, turned_S = ((x @ fourth).reshape(-1, n, n) for x in (products, squares))

        def times(of: Matrix, x: Matrix) -> Matrix:
            """(rows, n): matrices (rows, n, n), which are symmetric, times vectors (rows, n)."""
            result: Matrix = np.einsum("tij,tj->ti", of, x)
            return result

        momentum = W * (times(w_S, a) - squares @ third.T / 2) + times(s_S, a)
        force = W * (products @ third.T + times(w_S, rates) - times(rate_S, a))
        force += times(s_S, rates) + W**2 * times(turned_S, a) / 2
        force -= hardening * times((squares @ (strain + strain.T)).reshape(-1, n, n), a)
        of_spin = np.sum(products * w_S.reshape(-1, n * n) - squares * rate_S.reshape(-1, n * n) / 2, axis=1)
        of_spin += spin * np.sum(squares * turned_S.reshape(-1, n * n), axis=1) / 4
        return momentum, of_spin, force


def _responses(t: Vector, impulse: Matrix, force: Matrix, frequencies: Vector) -> Matrix:
    """(rows, n): vibrations y from rest under y'' + w^2 y = f + dp/dt in rows at t (rows,), s; p: `impulse`.

    With z = y' - p, u = z + i w y has u' = i w u + f + i w p; loads are constant between two rows.
    """
    turned = 1j * frequencies
    load = force + turned * (impulse - impulse[0])
    phases = np.exp(np.outer(t - t[0], turned))
    steps = (load[1:] + load[:-1]) / 2 * (phases[1:] / phases[:-1] - 1) / turned
    u = phases[1:] * np.cumsum(steps / phases[1:], axis=0)
    return np.vstack([np.zeros(len(frequencies)), u.imag / frequencies])
