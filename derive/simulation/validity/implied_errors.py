"""The error of the deflection of a beam that something missing in its model implies.

All errors are of one kind: the root mean square over the run of what the deflection of the beam is wrong by, over its
peak. Something that changes the stiffness by a ratio e(t) changes a deflection v under given loads by e v at once. It
also changes the frequency of a free vibration, by e/2, so that after the time t the vibration is late by e t/2: this
part grows with the time, until nothing is in phase. Of e(t) the mean counts for it, since what changes its sign is late
and early in turn.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.runtime.integrators.watch import Watched
from derive.runtime.native_call import Vector
from derive.simulation.validity.lost_inertia import LostInertia
from derive.simulation.validity.watched_beam import WatchedBeam, WatchedVibration
from derive.spec.model.body import DisplacementOrder

FIRST, TRUNCATED, FULL = DisplacementOrder.FIRST_ORDER, DisplacementOrder.TRUNCATED, DisplacementOrder.FULL
STRAIGHT = 1e-6
"""A beam whose deflections are smaller than this fraction of its length is straight."""
NEARLY_BUCKLED = 0.1
"""The least stiffness that an axial force is taken to leave, relative to that in bending."""
VIBRATION = 1.5
"""A stiffness that grows with the square of the deflection counts by 3/4 of its peak in a vibration, whose mean square
is half of that of its peak."""
COARSE = 1.5
"""The largest angle, rad, by which a vibration turns between two rows from which what it lacks is known."""
ROTATING = {FIRST: 1 / 3, TRUNCATED: 1 / 6, FULL: 1 / 6}
"""The part of the hardening by which beams err if joints act on the rotations of their ends, or of pieces.

Such joints take the slope v' as an angle. As an angle it gives the right curvature, and what is wrong is the position,
at second order by v'^3/6, which changes its sign along the beam. Measured on such beams, see `bench/monitors.py`.
"""


@dataclass(frozen=True, eq=False)
class ImpliedErrors:
    """The implied errors of a beam, from the quantities that were watched in a run.

    buckling: the error by an axial force that buckles it for moments, see `buckling_error`.
    """

    watched: WatchedBeam
    seen: Watched
    buckling: float = 0.0

    @property
    def peak(self) -> float:
        """The largest deflection, m."""
        return float(self.seen.largest[self.watched.deflection])

    @property
    def straight(self) -> bool:
        """Whether the beam never bends."""
        return self.peak < STRAIGHT * self.watched.length

    @property
    def ought_to_bend(self) -> bool:
        """Whether the beam bends, or would with other shapes."""
        return not self.straight or self.seen.largest[self.watched.missed] > STRAIGHT * self.watched.length

    @property
    def of_deflection(self) -> float:
        """The error from the strain energy that a large deflection adds."""
        hardening = self.watched.hardening * self.hardens
        return self._error(
            hardening * self._rms(self.watched.cubed), VIBRATION * hardening * self._rms(self.watched.deflection) ** 2
        )

    @property
    def hardens(self) -> float:
        """The part of the hardening that counts."""
        return ROTATING[self.watched.beam.beam.order] if self.watched.rotations_act else 1.0

    @property
    def of_axial_force(self) -> float:
        """The error from the stiffness that axial forces add at second order; of a straight beam that stiffness.

        A beam in space that bends in one plane alone is right to stay straight in the other until it buckles there.
        """
        if self.watched.beam.beam.order is not FIRST:
            return 0.0
        if self.straight:
            stiffness = float(self.seen.largest[self.watched.axial])
            buckles = stiffness >= 1 and self.seen.means[self.watched.axial] < 0
            return stiffness if buckles or not self.watched.shapes.axis else 0.0
        steady = self._error(self._rms(self.watched.axial_product), float(self.seen.means[self.watched.axial]))
        return max(steady, self.buckling)

    @property
    def of_shapes(self) -> float:
        """The error from the deflection that the shapes miss, which makes the beam stiffer than it is.

        Each vibration is too stiff by the share of its strain energy that is missed, and late by that: a force that
        bends the beam into another shape does not make it late. Where the vibration with the largest error is largest,
        the others have half of their mean squares. The stiffness that axial forces add at second order is
        not affected. Of a beam that never bends, since joints admit none of its shapes, all is missed.
        """
        watched = self.watched
        missed, rms = self._rms(watched.missed), self._rms(watched.deflection)
        if self.straight:
            return missed / (rms + missed)
        flexibility, share = 1 / self._stiffness(watched.axial_missed), missed / (rms + missed)
        late = sorted(map(self._late, watched.vibrations))
        together = np.hypot(late[-1], np.linalg.norm(late[:-1]) / np.sqrt(2)) if late else 0.0
        return float(np.hypot(flexibility * share * rms, together) / self.peak)

    def _late(self, of: WatchedVibration) -> float:
        """The lateness of a vibration by the strain energy that its shapes miss (rms, m)."""
        stiffness, missed = self._of_vibration(of), of.missed / self._stiffness(of.axial_missed)
        return self._late_by(of, missed / (stiffness + missed) / 2)

    def _late_by(self, of: WatchedVibration, faster: float) -> float:
        """The lateness of a vibration (rms, m) with this relative error of its frequency.

        It is at most that of one that is never in phase.
        """
        return float(min(faster * self._rms(of.late), np.sqrt(2) * self._rms(of.rate) / self._frequency(of)))

    def _frequency(self, of: WatchedVibration) -> float:
        """The frequency of a vibration with the axial force and the spin, rad/s."""
        return of.frequency * float(np.sqrt(self._of_vibration(of)))

    def _of_vibration(self, of: WatchedVibration) -> float:
        """The stiffness of a vibration with the axial force and the spin, relative to that without them."""
        return self._stiffness(of.axial, sum(float(self.seen.mean_squares[turn]) for turn in of.turns))

    def _stiffness(self, axial: int, softened: float = 0.0) -> float:
        """The stiffness with the axial force, whose mean adds a part at second order, relative to that without it.

        softened: the part that a spin takes away.
        """
        if self.watched.beam.beam.order is FIRST:
            return 1.0
        return max(1 + float(self.seen.means[axial]) - softened, NEARLY_BUCKLED)

    def of_lost_inertia(self, lost: LostInertia) -> float:
        """The error from the kinetic energy that deflections remove; it affects vibrations only.

        Each vibration is too fast by half of its own change in the deflected state.
        """
        if not lost.largest < 1:
            return np.inf
        if self.straight:
            return 0.0
        late = [self._late_by(of, lost.of_frequency(of.frequency) / 2) for of in self.watched.vibrations]
        return float(np.linalg.norm(late) / self.peak)

    def of_truncated_energy(self, difference: float) -> float:
        """The error from a difference (rms, m) of deflections, which is at most that of one that is never in phase."""
        return min(difference, float(np.sqrt(2)) * self._rms(self.watched.deflection)) / self.peak

    @property
    def frequencies(self) -> Vector:
        """The frequencies of the vibrations in the run, rad/s."""
        return np.array([self._frequency(of) for of in self.watched.vibrations])

    def seen_in(self, t: Vector) -> bool:
        """Whether rows at t (n,), s, are close enough to follow how the beam vibrates."""
        size, rate = self._middle
        return len(t) > 1 and rate * float(np.diff(t).max()) < COARSE * size

    def _error(self, difference: float, stiffness: float) -> float:
        """The error from a difference (rms, m) of deflections and from a mean relative change of the stiffness."""
        never_in_phase = np.sqrt(2) * self._rms(self.watched.deflection)
        late = min(abs(stiffness) / 2 * self._rms(self.watched.late), never_in_phase)
        return float(np.hypot(difference, self._vibrating * late) / self.peak)

    @property
    def _vibrating(self) -> float:
        """The fraction of free vibration in the motion, by its rate, if the lowest frequency is its frequency."""
        size, rate = self._middle
        vibration = self.watched.frequency * size if size > 0 else 0.0  # a frequency may be infinite
        return float(rate / max(rate, vibration)) if rate > 0 else 1.0

    @property
    def _middle(self) -> tuple[float, float]:
        """How far the middle of the lowest mode moves about its mean (rms, m), and its rate (rms, m/s)."""
        mean, squares = self.seen.means[self.watched.middle], self.seen.mean_squares
        return float(np.sqrt(max(squares[self.watched.middle] - mean**2, 0.0))), self._rms(self.watched.middle_rate)

    def _rms(self, quantity: int) -> float:
        return float(np.sqrt(self.seen.mean_squares[quantity]))
