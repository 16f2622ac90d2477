"""Lateral buckling of beams in space: the stiffness that bending and twisting moments take away at second order.

A beam of first order knows no such coupling. At second order a bending moment M in the stiffer plane, here along e2,
couples the twist with the bending in the other plane, and a twisting moment T the bendings of both planes, by

    int M sqrt(1 - EI_2/EI_3) theta w'' dx + 1/2 int T (v' w'' - v'' w') dx

in the potential; the square root is due to the curvature of the beam in its stiffer plane. Divided by the strain energy
of the deformations that the joints admit, the largest value mu of this form is 1 where the beam buckles. What is
coupled loses the fraction mu^2 of its stiffness. As far as the shapes can represent the buckled beam, mu is 1 under an
end load 4.013 sqrt(EI_2 GJ)/l^2 on a cantilever, and under a torque 8.99 EI/l on a shaft between clamps. Between hinges
it is 1 at pi^2/2 EI/l, where a torque buckles the shaft that turns with its ends by half; one about a fixed axis does
that at Greenhill's 2 pi EI/l.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import eigvalsh, orth

from derive.mechanics.bodies.section_fields import Direction, SectionShape, section_shapes
from derive.mechanics.symbols import amplitude_of
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import undeformed
from derive.simulation.observables.beams import function_values
from derive.simulation.observables.motion import si_value
from derive.simulation.validity.bending_planes import spatial_beams
from derive.simulation.validity.held_beam import admitted_velocities
from derive.simulation.validity.implied_errors import STRAIGHT
from derive.simulation.validity.monitors import Cause, Monitor
from derive.simulation.validity.piece_shapes import gauss_points
from derive.spec.model.beam_pieces import piece_name
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.specification import AnyScene

MOST_ROWS = 300
"""The states of a run that are looked at, evenly spaced."""
ORDERS = {Direction.ALONG_E2: 2, Direction.ALONG_E3: 2, Direction.TORSION: 1, Direction.AXIAL: 1}
"""The derivatives in the strain energy."""


def lateral_monitors(scene: AnyScene, native: NativeScene, k: Vector, t: Vector, q: Matrix) -> Iterator[Monitor]:
    """The monitors of the beams of first order that twist, in the states q (n, nq) at t (n,), s."""
    some = np.unique(np.linspace(0, len(t) - 1, min(len(t), MOST_ROWS)).round().astype(int))
    for beam in spatial_beams(scene):
        if beam.order is DisplacementOrder.FIRST_ORDER and beam.torsion is not None:
            yield _Buckling(beam, native, k).monitor(t[some], q[some])


@dataclass(frozen=True, eq=False)
class _Buckling:
    """The couplings of the amplitudes of a beam in a scene."""

    beam: SpatialBeam
    native: NativeScene
    k: Vector

    def monitor(self, t: Vector, q: Matrix) -> Monitor:
        """The largest loss of stiffness, and the error of the deflection in the weaker plane that it implies."""
        admitted = self._admitted(float(t[0]), q[0])
        losses = np.array([self._loss(admitted, state) for state in q])
        bent = self._lateral(q)
        peak, worst = float(bent.max()), int(losses.argmax())
        error = float(np.sqrt(np.mean((np.minimum(losses, 1) * bent) ** 2)) / peak) if peak else 0.0
        if losses[worst] >= 1:
            error = np.inf
        elif peak < STRAIGHT * self.length * self.beam.pieces:
            error = 0.0
        return Monitor(
            self.beam.name,
            self.beam.pieces,
            Cause.LATERAL,
            self.beam.order,
            float(losses[worst]),
            error,
            float(t[worst]),
            self.weaker,
        )

    @property
    def length(self) -> float:
        """The length of a piece, m."""
        return si_value(self.beam.length) / self.beam.pieces

    @cached_property
    def stiffnesses(self) -> dict[Direction, float]:
        """EI of both deflections and GJ, N m^2, and EA, N."""
        values = dict(zip((Direction.ALONG_E2, Direction.ALONG_E3), self.beam.bending_stiffnesses, strict=True))
        assert self.beam.torsion is not None
        values[Direction.TORSION] = self.beam.torsion.stiffness
        if self.beam.axial:
            values[Direction.AXIAL] = self.beam.axial.stiffness
        return {direction: si_value(value) for direction, value in values.items()}

    @property
    def weaker(self) -> int:
        """The axis along which the beam is weaker."""
        return 3 if self.stiffnesses[Direction.ALONG_E3] <= self.stiffnesses[Direction.ALONG_E2] else 2

    @cached_property
    def shapes(self) -> tuple[SectionShape, ...]:
        """The shapes of a piece."""
        return section_shapes(self.beam)

    @cached_property
    def columns(self) -> list[list[int]]:
        """The numbers of the amplitudes of each piece among the coordinates."""
        return [[self.native.coordinates.index(amplitude_of(p, i + 1).shown) for i in self._all] for p in self._pieces]

    @property
    def _all(self) -> range:
        return range(len(self.shapes))

    @property
    def _pieces(self) -> list[str]:
        return [piece_name(self.beam.name, self.beam.pieces, i) for i in range(self.beam.pieces)]

    def _of(self, direction: Direction, order: int) -> Matrix:
        """(shapes, points): the derivatives by x of the shapes of a direction at the Gauss points, zero for others."""
        xi, _ = gauss_points()
        factor = (2 / self.length) ** (order + (direction is Direction.TORSION))
        rows = [
            factor * function_values(shape.of.derivative(order), xi) if shape.direction is direction else 0 * xi
            for shape in self.shapes
        ]
        return np.array(rows)

    @cached_property
    def stiffness(self) -> Matrix:
        """K (shapes, shapes) of a piece, N/m."""
        total = np.zeros((len(self.shapes),) * 2)
        for direction, value in self.stiffnesses.items():
            own = self._of(direction, ORDERS[direction])
            total += value * self.length / 2 * (own * gauss_points()[1]) @ own.T
        return total

    def _coupling(self, a: Vector) -> Matrix:
        """The form (shapes, shapes) of the coupling in a piece with the amplitudes a."""
        weights = gauss_points()[1] * self.length / 2
        v2, w2 = (self._of(d, 2) for d in (Direction.ALONG_E2, Direction.ALONG_E3))
        v1, w1 = (self._of(d, 1) for d in (Direction.ALONG_E2, Direction.ALONG_E3))
        theta, stiff = self._of(Direction.TORSION, 0), self.stiffnesses
        first, second = stiff[Direction.ALONG_E2], stiff[Direction.ALONG_E3]
        strong, weak = (v2, w2) if self.weaker == 3 else (w2, v2)
        ratio = min(first, second) / max(first, second)
        moment = max(first, second) * np.sqrt(1 - ratio) * (a @ strong)
        torque = stiff[Direction.TORSION] * (a @ self._of(Direction.TORSION, 1)) / 2
        form = (theta * (moment * weights)) @ weak.T
        form += (v1 * (torque * weights)) @ w2.T - (v2 * (torque * weights)) @ w1.T
        result: Matrix = form + form.T
        return result

    def _admitted(self, t: float, q: Vector) -> Matrix:
        """The amplitudes (of all pieces, n), orthonormal, that joints admit in the undeformed state."""
        native = self.native
        rates = [native.velocities.index(amplitude_of(p, i + 1, 1).shown) for p in self._pieces for i in self._all]
        straight = undeformed(native, q)
        result: Matrix = orth(admitted_velocities(native, self.k, t, straight, rates)[rates], rcond=1e-9)
        return result

    def _loss(self, admitted: Matrix, q: Vector) -> float:
        """mu^2 in a state q (nq,)."""
        if not admitted.size:
            return 0.0
        n = len(self.shapes)
        K, C = np.zeros((2, n * len(self.columns), n * len(self.columns)))
        for i, columns in enumerate(self.columns):
            own = slice(n * i, n * (i + 1))
            K[own, own], C[own, own] = self.stiffness, self._coupling(q[columns])
        reduced = [admitted.T @ x @ admitted for x in (C, K)]
        try:
            return float(np.abs(eigvalsh(*reduced)).max()) ** 2
        except np.linalg.LinAlgError:  # shapes without stiffness
            return 0.0

    def _lateral(self, q: Matrix) -> Vector:
        """(n,): the size of the deflection in the weaker plane, m."""
        of = Direction.ALONG_E3 if self.weaker == 3 else Direction.ALONG_E2
        values = self._of(of, 0)
        each = [np.abs(q[:, columns] @ values).max(axis=1) for columns in self.columns]
        result: Vector = np.max(each, axis=0)
        return result
