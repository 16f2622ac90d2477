"""Functions of time that come to rest, such as a ramp: the scene as it moves on when they no longer change."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any, TypeVar

from derive.mechanics.prescribed_motion import drive_motion, drive_speed
from derive.simulation.linear.run_time_inputs import scene_with_values
from derive.spec.model.joints import Drive
from derive.spec.model.scene_functions import breaks, time_functions, with_changed_functions
from derive.spec.model.specification import AnyScene
from derive.spec.model.time_function import TimeFunction, depends_on_time, function_at, value_at

S = TypeVar("S", bound=AnyScene)

LATER = (0.3, 1.0, 2.7, 7.3)
"""s: the times behind the last break at which the values of a function, or its rates between them, are compared."""
SAME = 1e-9
"""Values that differ by no more than this part of the largest one are the same."""


@dataclass(frozen=True)
class SettledFunctions:
    """The functions of a scene that no longer change from a time (s) on, and those that still do, by their paths.

    stopping: the drives that stand still then.
    """

    time: float = 0.0
    settled: tuple[str, ...] = ()
    changing: tuple[str, ...] = ()
    stopping: frozenset[str] = frozenset()

    def scene(self, scene: S) -> S:
        """The scene with these functions settled, and its inputs replaced by the functions of the specification.

        A drive that still moves then starts from its position at t = 0; one that stops is where it comes to rest.
        """
        scene = scene_with_values(scene)

        def constant(function: TimeFunction) -> TimeFunction:
            return function_at(function, self._then) if _settles(function, self.time) else function

        changed: Any = with_changed_functions(scene, constant)
        result: S = replace(changed, drives=tuple(map(self._drive, scene.drives)))
        return result

    @property
    def _then(self) -> float:
        return self.time + LATER[1]

    def _drive(self, drive: Drive) -> Drive:
        speed, motion = drive_speed(drive), drive_motion(drive)
        if drive.constant_speed is not None or not _settles(motion, self.time, linear=True):
            return drive
        if drive.name in self.stopping:
            return replace(drive, motion=function_at(motion, self._then), speed=None, offset=Fraction(0))
        if speed is not None:
            return replace(drive, speed=function_at(speed, self._then))
        change = TimeFunction("sub", (function_at(motion, self._then + 1.0), function_at(motion, self._then)))
        moving = TimeFunction("mul", (change, TimeFunction("t")))
        return replace(drive, motion=TimeFunction("add", (function_at(motion, 0.0), moving)))

    def __str__(self) -> str:
        return f"{', '.join(self.settled)} as from t = {self.time:.6g} s on, when nothing changes any more"


def settled_functions(scenes: Sequence[AnyScene]) -> SettledFunctions:
    """Determine which functions of time of a scene settle; scenes: the scene with several values of its parameters."""
    scenes = [scene_with_values(scene) for scene in scenes]
    time = max((t for scene in scenes for t in breaks(scene) if math.isfinite(t) and t > 0.0), default=0.0)
    settled: list[str] = []
    changing: list[str] = []
    for functions in zip(*map(time_functions, scenes), strict=True):
        (section, name, key), first = functions[0]
        linear = (section, key) == ("drives", "motion")
        still = linear and all(_settles(function, 0.0, linear, before=True) for _, function in functions)
        if still or not depends_on_time(first):
            continue
        rests = all(_settles(function, time, linear) for _, function in functions)
        (settled if rests else changing).append(f"{section}.{name}.{key}")
    stopping = {drive.name for drive in scenes[0].drives} if settled else set()
    for scene in scenes:
        stopping &= {drive.name for drive in scene.drives if _settles(drive_motion(drive), time)}
    return SettledFunctions(time, tuple(settled), tuple(changing), frozenset(stopping))


def _settles(function: TimeFunction, after: float, linear: bool = False, before: bool = False) -> bool:
    """Whether a function no longer changes after a time (s), or, with `linear`, changes at a constant rate.

    before: whether the values at that time and just behind it are compared as well.
    """
    times = [*((after, after + LATER[0] / 64) if before else ()), *(after + later for later in LATER)]
    try:
        values = [value_at(function, t) for t in times]
    except (ArithmeticError, ValueError):
        return False
    largest = max(map(abs, values))
    if linear:
        values = [(b - a) / (u - t) for (t, a), (u, b) in pairwise(zip(times, values, strict=True))]
    return max(values) - min(values) <= SAME * largest
