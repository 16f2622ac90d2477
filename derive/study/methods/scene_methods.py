"""A scene with the integrators that are studied: the same run with each of them, and states along the motion."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import assert_never

import numpy as np

from derive.generated_models import generated
from derive.runtime.integrators.adaptive import Adaptive, AdaptiveError
from derive.runtime.integrators.c_integrator import CONSISTENT
from derive.runtime.integrators.compilation import LibraryMissing
from derive.runtime.integrators.fixed_step import FixedStep
from derive.runtime.integrators.generalised_alpha import GeneralisedAlpha
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.errors import SimulationError
from derive.simulation.integration.c_methods import NEWTON
from derive.simulation.integration.integrator import scene_of
from derive.simulation.integration.scipy_methods import MAX_STEPS_PER_ROW, integrate
from derive.simulation.integration.tolerances import absolute_tolerances, consistent_tolerance
from derive.simulation.redundant_joints import with_redundant_joints
from derive.simulation.scene_start import size_of
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.scene_functions import breaks
from derive.spec.model.specification import AnyScene
from derive.study.states import State, period, start_state

DAMPED = 0.8
"""The spectral radius at infinite frequency of the generalised-alpha method, as `simulate` uses it."""

LOOSE = 1e9
"""A tolerance with which adaptive methods take the longest step that they may."""


STEPS_PER_ROW = 20
"""The largest mean number of adaptive steps between rows that are one step of a fixed-step method apart."""


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
    """The rows of a run: t (n,) in s, q (n, nq), v (n, nv), multipliers lam (n, nlambda); and the number of steps."""

    t: Vector
    q: Matrix
    v: Matrix
    lam: Matrix
    steps: int

    @property
    def states(self) -> list[State]:
        """The states of the rows."""
        return [(float(t), q, v) for t, q, v in zip(self.t, self.q, self.v, strict=True)]


@dataclass(frozen=True, eq=False)
class MethodScene:
    """A compiled scene, its consistent start q (nq,), v (nv,), and its integrators.

    period (s), along: the duration and the description of one cycle of the motion. alpha: None without the library KLU,
    on which `missing` is the text.
    """

    scene: AnyScene
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
        return size_of(self.scene)

    @property
    def start(self) -> State:
        """The consistent state at t = 0."""
        return 0.0, self.q, self.v

    def run(
        self, method: Method, h: float, steps: int, projected: bool = True, start: State | None = None
    ) -> MethodRun:
        """A run of `steps` steps of h (s) with a row after each; steps of adaptive methods are limited by h alone.

        projected: whether explicit methods project onto the constraints. start: the initial state, at t = 0 by default.
        Raises TisserandError where it fails.
        """
        t0, q, v = start or self.start
        match method:
            case Method.RK4:
                met = consistent_tolerance(CONSISTENT, self.size, q)
                r = self.rk4.run(q, v, step=h, steps=steps, k=self.k, t0=t0, project=projected, tolerance=met)
            case Method.GENERALISED_ALPHA | Method.TRAPEZOIDAL:
                if self.alpha is None:
                    raise LibraryMissing(self.missing)
                rho = 1.0 if method is Method.TRAPEZOIDAL else DAMPED
                newton = NEWTON * min(1.0, self.size)
                r = self.alpha.run(q, v, step=h, steps=steps, k=self.k, t0=t0, rho=rho, tolerance=newton)
            case Method.ADAPTIVE:
                return self.adaptive_run(equal_times(t0, h, steps), LOOSE, projected, h, start)
            case Method.RK45:
                times = equal_times(t0, h, steps)
                s = integrate(
                    self.native,
                    self.k,
                    q,
                    v,
                    times,
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

    def adaptive_run(
        self,
        times: Vector,
        tolerance: float,
        projected: bool = True,
        longest: float = 0.0,
        start: State | None = None,
        per_row: int = STEPS_PER_ROW,
    ) -> MethodRun:
        """A run of the adaptive method with rows at `times` (n,), s; steps of at most `longest` (s), unless that is 0.

        per_row: the largest mean number of steps for each row. Raises AdaptiveError.
        """
        _, q, v = start or self.start
        rounded = consistent_tolerance(CONSISTENT, self.size, q)
        a = self.adaptive.run(
            q,
            v,
            times,
            rtol=tolerance,
            atol=absolute_tolerances(self.native, tolerance, self.size, q),
            k=self.k,
            consistent=rounded if projected else 0.0,
            step_max=longest,
            steps_max=per_row * len(times),
            breaks=breaks(self.scene),
        )
        return MethodRun(a.t, a.q, a.v, a.lam, a.counts["steps"])

    def motion(self, count: int) -> MethodRun:
        """A run of the adaptive method over a period, with `count` rows that are equally spaced in time.

        Raises SimulationError if it ends before.
        """
        assert self.scene.simulation is not None
        try:
            times = np.linspace(0.0, self.period, count)
            return self.adaptive_run(times, self.scene.simulation.tolerance, per_row=MAX_STEPS_PER_ROW)
        except AdaptiveError as error:
            advice = f"a study of methods needs a motion that goes on for {self.along}; give a shorter duration"
            raise SimulationError(f"{error}; {advice}") from error


def method_scene(scene: AnyScene) -> MethodScene:
    """The scene compiled with its integrators. Raises SpecError, CompilerError, SimulationError."""
    return with_redundant_joints(in_pieces(scene), _method_scene)


def _method_scene(scene: AnyScene) -> MethodScene:
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


def equal_times(t0: float, h: float, steps: int) -> Vector:
    """The times (s) from t0 on of the ends of `steps` steps of h (s), and t0."""
    return np.asarray(t0 + h * np.arange(steps + 1), dtype=np.float64)
