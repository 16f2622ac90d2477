"""The motion and the speed that a drive prescribes, as functions of time."""

from __future__ import annotations

from functools import lru_cache

from derive.mechanics.time_integrals.kept import kept_integral
from derive.spec.model.joints import Drive
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.model.time_function import TimeFunction


def drive_speed(drive: Drive) -> TimeFunction | None:
    """The speed of a drive as a function of t, s; None if a motion is specified instead."""
    constant = drive.constant_speed
    return drive.speed if isinstance(drive.speed, TimeFunction) else None if constant is None else _constant(constant)


@lru_cache(maxsize=128)
def drive_motion(drive: Drive) -> TimeFunction:
    """The rotation (rad) or displacement (m) that a drive prescribes, as a function of t (s).

    Raises NoClosedForm where the speed has no known integral; reading a specification refuses such a speed.
    """
    if drive.motion is not None:
        return drive.motion
    speed = drive_speed(drive)
    assert speed is not None, "a drive has a motion or a speed"
    integral = kept_integral(speed)
    return integral if drive.offset == 0 else TimeFunction("add", (integral, _constant(drive.offset)))


def _constant(value: Quantity) -> TimeFunction:
    if isinstance(value, Parameter):
        return TimeFunction("parameter", parameter=value)
    return TimeFunction("number", value=value)
