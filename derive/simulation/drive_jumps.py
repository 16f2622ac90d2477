"""Prescribed motions that no finite force can make: drives whose position or speed jumps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise

import numpy as np

from derive.errors import Problem, SpecError
from derive.mechanics.prescribed_motion import drive_speed
from derive.simulation.observables.motion import drive_unit
from derive.spec.model.joints import Drive
from derive.spec.model.specification import AnyScene
from derive.spec.model.time_function import TimeFunction, break_times, value_at

BESIDE = 64
"""The distance of the times before and after a break from it, in units in the last place of its time."""
ROUNDING = 1e-9
"""A jump is larger than this part of the largest position or speed of the drive; smaller ones are rounding errors."""
SAMPLES = 9
"""The number of times between two breaks at which the largest position and speed are sought."""

BEHIND = 1e-300
"""s: a time after t = 0 until which a speed that does not jump stays below SLOW (rad/s or m/s)."""
SLOW = 1e-100

PARTIAL: Mapping[str, Callable[..., tuple[float, ...]]] = {
    "add": lambda a, b: (1.0, 1.0),
    "sub": lambda a, b: (1.0, -1.0),
    "mul": lambda a, b: (b, a),
    "div": lambda a, b: (1.0 / b, -a / b**2),
    "pow": lambda a, b: (b * math.pow(a, b - 1.0) if b else 0.0, 0.0),
    "neg": lambda a: (-1.0,),
    "sin": lambda a: (math.cos(a),),
    "cos": lambda a: (-math.sin(a),),
    "sqrt": lambda a: (0.5 / math.sqrt(a),),
    "exp": lambda a: (math.exp(a),),
    "log": lambda a: (1.0 / a,),
    "tanh": lambda a: (1.0 - math.tanh(a) ** 2,),
    "abs": lambda a: (float(np.sign(a)),),
    "min": lambda a, b: (float(a < b), float(a >= b)),
    "max": lambda a, b: (float(a >= b), float(a < b)),
    "atan2": lambda y, x: (x / (x**2 + y**2), -y / (x**2 + y**2)),
    "step": lambda x, x0, x1: (_step_rate((x - x0) / (x1 - x0)) / (x1 - x0), 0.0, 0.0),
}
"""The partial derivatives of each kind of function of time, at kinks those of the generated code.

Powers and the ends of steps are constant.
"""


def _step_rate(s: float) -> float:
    return 30.0 * (s * (1.0 - s)) ** 2 if 0.0 < s < 1.0 else 0.0


def rate_at(function: TimeFunction, t: float) -> float:
    """The derivative of a function at t (s), with the defaults of its parameters.

    Raises ArithmeticError or ValueError where it has none.
    """
    match function.kind:
        case "number" | "parameter":
            return 0.0
        case "t":
            return 1.0
        case "spline":
            assert function.spline is not None
            return function.spline(value_at(function.args[0], t), 1) * rate_at(function.args[0], t)
        case "piecewise":
            pairs = zip(function.args[:-1:2], function.args[1::2], strict=True)
            return rate_at(next((then for when, then in pairs if value_at(when, t)), function.args[-1]), t)
        case kind:
            rates = [rate_at(arg, t) for arg in function.args]
            if not any(rates):
                return 0.0
            partial = PARTIAL[kind](*(value_at(arg, t) for arg in function.args))
            return sum(d * rate for d, rate in zip(partial, rates, strict=True) if rate)


def check_drives(scene: AnyScene) -> None:
    """Raise SpecError if the position or the speed of a drive jumps within the simulation of a scene.

    Drives that follow run-time inputs are not checked, since their functions are not known here.
    """
    assert scene.simulation is not None
    duration = scene.simulation.duration
    problems = [problem for drive in scene.drives for problem in _jumps(scene, drive, duration)]
    if problems:
        raise SpecError(tuple(problems))


def check_start(scene: AnyScene) -> None:
    """Raise SpecError if a drive has a kink at t = 0 with another speed in the generated code than just behind it."""
    problems = []
    for drive in scene.drives:
        motion = drive.motion
        if motion is None or motion.kind == "input":
            continue
        here, behind = _finite(rate_at, motion, 0.0), _finite(rate_at, motion, BEHIND)
        if here is None or behind is None:
            continue
        if abs(behind - here) > SLOW + ROUNDING * max(abs(here), abs(behind)):
            unit = drive_unit(scene, drive)
            problems.append(
                Problem(
                    f"drives.{drive.name}.motion",
                    f"the motion has a kink at t = 0: its speed is {here:.9g} {unit}/s there in the generated code, "
                    f"and {behind:.9g} {unit}/s behind it. Write what it is for t > 0, such as t in place of abs(t)",
                )
            )
    if problems:
        raise SpecError(tuple(problems))


def _jumps(scene: AnyScene, drive: Drive, duration: float) -> Iterator[Problem]:
    key, prescribed = ("motion", drive.motion) if drive.motion is not None else ("speed", drive_speed(drive))
    if prescribed is None or prescribed.kind == "input":
        return
    unit = drive_unit(scene, drive)
    of_speed = ("speed", rate_at if key == "motion" else value_at, f"{unit}/s")
    quantities = (*((("position", value_at, unit),) if key == "motion" else ()), of_speed)
    breaks = sorted(time for time in {*break_times(prescribed, duration)} if 0.0 < time <= duration)
    samples = [t for pair in pairwise([0.0, *breaks, duration]) for t in np.linspace(*pair, SAMPLES)]
    refused = set[float]()  # a jump of the position is one of the speed as well
    for quantity, of, units in quantities:
        values = (_finite(of, prescribed, t) for t in samples)
        largest = max((abs(value) for value in values if value is not None), default=0.0)
        for t in breaks:
            beside = BESIDE * np.spacing(t)
            old, new = _finite(of, prescribed, t - beside), _finite(of, prescribed, t + beside)
            if t in refused or old is None or new is None or abs(new - old) <= ROUNDING * largest:
                continue
            refused.add(t)
            yield Problem(
                f"drives.{drive.name}.{key}",
                f"at t = {t:.9g} s the {quantity} jumps from {old:.9g} {units} to {new:.9g} {units}, which takes an "
                f"infinite force; only the acceleration of a drive may jump. Make the {key} smooth there, for example "
                "by step(t, ...), or end the simulation before",
            )


def _finite(of: Callable[[TimeFunction, float], float], function: TimeFunction, t: float) -> float | None:
    """The value or the derivative of a function at t (s), None where it has none, such as the speed of sqrt(t) at 0."""
    try:
        value = of(function, float(t))
    except (ArithmeticError, ValueError):
        return None
    return value if math.isfinite(value) else None
