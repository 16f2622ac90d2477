"""The registry of integrators, which `derive.simulate` and `tisserand simulate --integrator` choose from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

from derive.artifacts import File
from derive.registry import Registry
from derive.runtime.compiler import FLAGS, RUN_FLAGS, WITHOUT_BATCHES
from derive.runtime.loading import load
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.integration import c_methods
from derive.simulation.integration.adaptive import adaptive
from derive.simulation.integration.integrator import Compile, Integrator, Settings, scene_of
from derive.simulation.integration.scikit_sundae import integrate_ida
from derive.simulation.integration.scipy_methods import integrate
from derive.simulation.integration.solution import Solution


def _scipy(method: Literal["DOP853", "RK45"]) -> Callable[[NativeScene], Integrator]:
    """An explicit method of SciPy."""

    def integrator(native: NativeScene) -> Integrator:
        def run(k: Vector, q: Vector, v: Vector, times: Vector, s: Settings) -> Solution:
            s.refuse_step(method.lower())
            return integrate(
                native,
                k,
                q,
                v,
                times,
                method=method,
                tolerance=s.tolerance,
                size=s.size,
                drift=s.drift,
                breaks=s.breaks,
                until=s.until,
                progress=s.progress,
            )

        return Integrator(native, run, integrator)

    return integrator


def _compiled(integrator: Callable[[NativeScene], Integrator]) -> Compile:
    """The integrator of a model that is compiled alone."""
    return lambda files: integrator(load(files, RUN_FLAGS))


def _ida(files: Sequence[File]) -> Integrator:
    """IDA of SUNDIALS through scikit-sundae."""

    def integrator(native: NativeScene) -> Integrator:
        def run(k: Vector, q: Vector, v: Vector, times: Vector, s: Settings) -> Solution:
            s.refuse_step("ida")
            return integrate_ida(
                native,
                k,
                q,
                v,
                times,
                tolerance=s.tolerance,
                size=s.size,
                drift=s.drift,
                breaks=s.breaks,
                until=s.until,
                progress=s.progress,
            )

        return Integrator(native, run, integrator)

    return integrator(scene_of(load(files, (*FLAGS, WITHOUT_BATCHES)), "ida"))


INTEGRATORS: Registry[Compile] = Registry(
    "integrator",
    {
        "adaptive": _compiled(lambda native: adaptive(native, _scipy("DOP853"))),
        "dop853": _compiled(_scipy("DOP853")),
        "scipy": _compiled(_scipy("DOP853")),
        "rk45": _compiled(_scipy("RK45")),
        "ida": _ida,
        "rk4": c_methods.rk4,
        "generalised-alpha": c_methods.generalised_alpha,
        "c_ida": c_methods.ida,
    },
    doc="""Integrators by name, which `simulate` and `tisserand simulate --integrator` choose from.

    adaptive is the method of Dormand and Prince of order 8 in C, with adaptive steps; dop853 (also called scipy) is the
    same method of SciPy, and rk45 that of order 5, which call Python at each step; ida is IDA of SUNDIALS through
    scikit-sundae; rk4, generalised-alpha and c_ida are the C integrators of `templates/host` that are compiled with the
    model: the classical Runge-Kutta method, the generalised-alpha method, and IDA without Python between its steps.

    `derive.INTEGRATORS.register(name, member)` adds one of your own: a function from the files of a model to an
    `Integrator`, like those in `derive.simulation.integration`.

    Examples:
        >>> import derive
        >>> list(derive.INTEGRATORS)
        ['adaptive', 'dop853', 'scipy', 'rk45', 'ida', 'rk4', 'generalised-alpha', 'c_ida']
        >>> ball = derive.scene("ball", gravity=(0, -10), bodies={"ball": {"mass": 1, "inertia": 1}})
        >>> derive.simulate(ball, duration=1, output=1, integrator="rk4", step=0.1)["ball_c2"].round(6)
        array([ 0., -5.])
    """,
)

EXPLICIT = frozenset(("adaptive", "dop853", "scipy", "rk45", "rk4"))
"""The integrators that call accelerations alone, and no function of implicit methods."""
PASSING = EXPLICIT | {"generalised-alpha"}
"""The integrators that pass singular positions: accelerations resolve them, and so does the proximal term of the
generalised-alpha method."""
RESOLVING = PASSING | {"ida", "c_ida"}
"""The integrators that follow motions with redundant joints. The proximal term of IDA does not bring it through
singular positions."""
