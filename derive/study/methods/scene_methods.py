"""A scene with the integrators that are studied: the same run with each of them, and states along the motion."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import assert_never

import numpy as np

from derive.errors import TisserandError
from derive.generated_models import generated
from derive.runtime.integrators.adaptive import Adaptive
from derive.runtime.integrators.c_integrator import CONSISTENT
from derive.runtime.integrators.compilation import LibraryMissing
from derive.runtime.integrators.fixed_step import FixedStep
from derive.runtime.integrators.generalised_alpha import GeneralisedAlpha
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.initial.initial_state import scene_size
from derive.simulation.integration.c_methods import NEWTON
from derive.simulation.integration.integrator import scene_of
from derive.simulation.integration.scipy_methods import integrate
from derive.simulation.integration.tolerances import absolute_tolerances, consistent_tolerance
from derive.spec.model.scene import Scene
from derive.spec.model.scene_functions import breaks
from derive.study.states import State, period, start_state

DAMPED = 0.8
"""What the generalised-alpha method leaves of infinite frequencies per step, as `simulate` uses it."""

LOOSE = 1e9
"""A tolerance with which adaptive methods take the longest step that they may."""


class Method(Enum):
    """An integrator by its name in a command."""

    RK4 = "rk4"
    ADAPTIVE = "adaptive"
    RK45 = "rk45"
    GENERALISED_ALPHA = "generalised-alpha"
    TRAPEZOIDAL = "trapezoidal"
    """The generalised-alpha method with rho = 1."""


IMPLICIT = (Method.GENERALISED_ALPHA, Method.TRAPEZOIDAL)


@dataclass(frozen=True, eq=False)
class MethodRun:
    """t (n,) in s, q (n, nq), v (n, nv), multipliers lam (n, nlambda), and the number of steps."""

    t: Vector
    q: Matrix
    v: Matrix
    lam: Matrix
    steps: int


@dataclass(frozen=True, eq=False)
class MethodScene:
    """A compiled scene, its consistent start q (nq,), v (nv,), and its integrators.

    period (s), along: what one cycle of the motion is. alpha: None without the library KLU, which `missing` says.
    """

    scene: Scene
    native: NativeScene
    rk4: FixedStep
    alpha: GeneralisedAlpha | None
    adaptive: Adaptive
    k: Vector
    q: Vector
    v: Vector
    period: float
    along: str
    missing: str = ""

    @property
    def size(self) -> float:
        """The size of the scene, m."""
        return scene_size(self.scene)

    def run(self, method: Method, h: float, steps: int, every: int = 1, projected: bool = True) -> MethodRun:
        """A run of `steps` steps of h (s) with a row after every `every` of them; adaptive ones are limited by h alone.

        projected: whether explicit methods project onto the constraints. Raises TisserandError where it fails.
        """
        match method:
            case Method.RK4:
                met = consistent_tolerance(CONSISTENT, self.size, self.q)
                r = self.rk4.run(
                    self.q, self.v, step=h, steps=steps, every=every, k=self.k, project=projected, tolerance=met
                )
            case Method.GENERALISED_ALPHA | Method.TRAPEZOIDAL:
                if self.alpha is None:
                    raise LibraryMissing(self.missing)
                rho = 1.0 if method is Method.TRAPEZOIDAL else DAMPED
                newton = NEWTON * min(1.0, self.size)
                r = self.alpha.run(
                    self.q, self.v, step=h, steps=steps, every=every, k=self.k, rho=rho, tolerance=newton
                )
            case Method.ADAPTIVE:
                return self.adaptive_run(equal_times(h, steps, every), LOOSE, projected, h)
            case Method.RK45:
                s = integrate(
                    self.native,
                    self.k,
                    self.q,
                    self.v,
                    equal_times(h, steps, every),
                    method="RK45",
                    tolerance=LOOSE,
                    drift=np.inf,
                    projected=projected,
                    max_step=h,
                )
                return MethodRun(s.t, s.q, s.v, s.lam, s.cost.steps)
            case _ as never:
                assert_never(never)
        return MethodRun(r.t, r.q, r.v, r.lam, steps)

    def adaptive_run(self, times: Vector, tolerance: float, projected: bool = True, longest: float = 0.0) -> MethodRun:
        """The adaptive method with rows at `times` (n,), s, steps of at most `longest` (s) unless that is 0."""
        rounded = consistent_tolerance(CONSISTENT, self.size, self.q)
        a = self.adaptive.run(
            self.q,
            self.v,
            times,
            rtol=tolerance,
            atol=absolute_tolerances(self.native, tolerance, self.size, self.q),
            k=self.k,
            consistent=rounded if projected else 0.0,
            step_max=longest,
            breaks=breaks(self.scene),
        )
        return MethodRun(a.t, a.q, a.v, a.lam, a.counts["steps"])

    def states(self, count: int) -> list[State]:
        """`count` states of the motion, equally spaced over a period. Raises TisserandError."""
        assert self.scene.simulation is not None
        r = self.adaptive_run(np.linspace(0.0, self.period, count), self.scene.simulation.tolerance)
        return [(float(t), q, v) for t, q, v in zip(r.t, r.q, r.v, strict=True)]

    def strain_energy(self, run: MethodRun) -> float:
        """The largest strain energy of the rows of a run, J; infinite if a state is not finite."""
        if not np.all(np.isfinite(run.q)):
            return float("inf")
        return max(float(self.native.energy(q, v, self.k)[1]) for q, v in zip(run.q, run.v, strict=True))


def method_scene(scene: Scene) -> MethodScene:
    """The scene compiled with its integrators. Raises SpecError, CompilerError, SimulationError."""
    _, files = generated(scene)
    rk4, missing = FixedStep(files), ""
    try:
        alpha: GeneralisedAlpha | None = GeneralisedAlpha(files)
    except LibraryMissing as error:
        alpha, missing = None, str(error).splitlines()[0]
    native = scene_of(rk4.native, "a study of methods")
    k = native.setup()
    _, q, v = start_state(scene, native, k)
    return MethodScene(scene, native, rk4, alpha, Adaptive(native), k, q, v, *period(scene), missing)


def equal_times(h: float, steps: int, every: int = 1) -> Vector:
    """The times (s) of the ends of every `every` steps of h (s), and of the start."""
    return np.asarray(h * np.arange(0, steps + 1, every), dtype=np.float64)


def survives(of: MethodScene, method: Method, h: float, steps: int, allowed: float) -> bool:
    """Whether a run fails nowhere and its strain energy stays below `allowed`, J."""
    try:
        return of.strain_energy(of.run(method, h, steps)) <= allowed
    except TisserandError:
        return False
