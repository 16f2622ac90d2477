"""What is simulated: duration, rows and accuracy; the initial state of a single body in space."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Simulation:
    """How long, how often the state is written, and how exactly."""

    duration: float
    output: float
    tolerance: float = 1e-9


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
"""At the origin, not rotated, at rest, not deformed."""
