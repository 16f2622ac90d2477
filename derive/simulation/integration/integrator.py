"""The interface of integrators: a compiled scene together with a method that integrates it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from derive.artifacts import File
from derive.runtime.integrators.watch import Watch
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.errors import SimulationError
from derive.simulation.integration.solution import Progress, Solution
from derive.simulation.integration.stop_event import StopEvent


@dataclass(frozen=True)
class Settings:
    """Settings that integrators share.

    tolerance: the error of a step, relative and absolute (SI), of methods with adaptive steps. size: that of the scene,
    m; below 1 m the absolute tolerances of lengths are proportional to it. drift: the limit of |g| (m, rad) and |gdot|
    (m/s, rad/s) in every row. step: that of methods with fixed steps, s; None lets them choose. breaks: times at which
    functions of time jump, s, at which methods stop and start anew. until: a condition that ends the integration.
    progress: called with the time (s) that is reached. watch: quantities of a scene that methods in C may look at after
    each step. checked: whether a method with fixed steps measures its error by a second run, and notes one that is too
    large. interruptible: whether Ctrl-C ends an integration in C, which calls Python in each row for that.
    """

    tolerance: float = 1e-9
    size: float = 1.0
    drift: float = 1e-9
    step: float | None = None
    breaks: tuple[float, ...] = ()
    until: StopEvent | None = None
    progress: Progress | None = None
    watch: Watch | None = None
    checked: bool = False
    interruptible: bool = True

    def refuse_step(self, integrator: str) -> None:
        """Raise SimulationError if `step` is set, for methods that choose their own steps."""
        if self.step is not None:
            raise SimulationError(
                f"{integrator} chooses its own steps, so that a step of {self.step:g} s means nothing to it; leave it "
                "out and give a tolerance, or choose an integrator with fixed steps, such as rk4"
            )


@dataclass(frozen=True, eq=False)
class Integrator:
    """A compiled scene or body, and the function that integrates it.

    `integrate(k, q, v, times, settings)` takes the constants k (nk,) of `native.setup`, a consistent state q (nq,),
    v (nv,) at times[0], and the times (n,) of the rows, s. It raises SimulationError. through_python: the same method
    for another object with the functions of the scene, which it calls in Python; None if it calls C alone.
    """

    native: NativeScene
    integrate: Callable[[Vector, Vector, Vector, Vector, Settings], Solution]
    through_python: Callable[[NativeScene], Integrator] | None = None


Compile = Callable[[Sequence[File]], Integrator]
"""Compiles the generated files of a scene or body for an integrator. Raises CompilerError, LibraryMissing, and
SimulationError if the method is one for scenes alone."""


def scene_of(native: NativeScene, integrator: str) -> NativeScene:
    """The compiled scene. Raises SimulationError if it is a body: `integrator` is a method for scenes alone."""
    if not native.is_scene:
        raise SimulationError(
            f"{integrator} integrates scenes; for the body {native.name} choose adaptive, rk4, dop853 or rk45"
        )
    return native
