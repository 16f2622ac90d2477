"""The settings of a simulation, and the initial values of planar bodies and of bodies in space."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True)
class Simulation:
    """The duration, output and accuracy of a simulation; `until` is a condition that ends it earlier."""

    duration: float
    output: float
    tolerance: float = 1e-9
    until: str | None = None


@dataclass(frozen=True)
class InitialValues:
    """Initial values of a body; None where the specification gives none.

    position (m), angle (rad), velocity (m/s) and spin (rad/s) are those of the origin of a body, or of the centre of
    the straight axis of a beam. deflection (m) and deflection_rate (m/s), of beams alone: displacement from that axis
    as a polynomial in xi along the whole beam. The initial state keeps what is given, see
    `derive.simulation.initial.initial_state`; with `guess` the values are where the assembly begins.
    """

    position: tuple[float, float] | None = None
    angle: float | None = None
    velocity: tuple[float, float] | None = None
    spin: float | None = None
    deflection: tuple[Fraction, ...] | None = None
    deflection_rate: tuple[Fraction, ...] | None = None
    guess: bool = False


NOT_GIVEN = InitialValues()
"""The default of initial values: none are given."""


@dataclass(frozen=True)
class SpatialStart:
    """The initial state of a body in space, SI units.

    position, velocity (3,): of the origin of the floating frame, in the inertial frame. quaternion (4,): the rotation
    of the floating frame, scalar first. angular_velocity (3,): in the floating frame. amplitudes, amplitude_rates: of
    the modes, the first ones; those that are not given are zero.
    """

    position: tuple[float, ...] = (0.0, 0.0, 0.0)
    quaternion: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0)
    velocity: tuple[float, ...] = (0.0, 0.0, 0.0)
    angular_velocity: tuple[float, ...] = (0.0, 0.0, 0.0)
    amplitudes: tuple[float, ...] = ()
    amplitude_rates: tuple[float, ...] = ()


AT_REST = SpatialStart()
"""The default initial state: at the origin, not rotated, at rest, not deformed."""
