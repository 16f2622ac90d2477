"""The classical Runge-Kutta method with a fixed step: for limits of steps and orders, not for long motions."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from derive.runtime.native_call import Vector
from derive.simulation.compiled_scene import ConstrainedSystem
from derive.simulation.constraints.projection import project
from derive.simulation.integration.scipy_methods import Evaluator


def march(
    native: ConstrainedSystem,
    k: Vector,
    t: float,
    q: Vector,
    v: Vector,
    step: float,
    count: int,
    projected: bool = True,
) -> Iterator[tuple[float, Vector, Vector]]:
    """(t, q, v) after each of `count` steps (s), each projected onto the constraints if asked for.

    Raises ModelError in a state that the model refuses, as after a step that is too long.
    """
    f, y, n = Evaluator(native, k), np.concatenate([q, v]), native.nq
    begin = t
    for i in range(count):
        with np.errstate(over="ignore", invalid="ignore"):
            k1 = f(t, y)
            k2 = f(t + step / 2, y + step / 2 * k1)
            k3 = f(t + step / 2, y + step / 2 * k2)
            k4 = f(t + step, y + step * k3)
            y = y + step / 6 * (k1 + 2 * (k2 + k3) + k4)
        t = begin + (i + 1) * step
        if f.refused is not None:
            raise f.refused[1]
        if projected:
            y = np.concatenate(project(native, k, t, y[:n], y[n:]))
        yield t, y[:n].copy(), y[n:].copy()
