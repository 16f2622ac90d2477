"""The simulation of a scene or a body in memory: derive, compile, find a consistent state, integrate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, TypeVar

from derive.errors import Problem, SpecError
from derive.progress_line import PATIENCE
from derive.simulation.earlier_run import EarlierRun
from derive.simulation.inputs import InputFunction
from derive.simulation.integration.solution import Progress
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.simulated_scene import simulated
from derive.simulation.trajectory import Trajectory
from derive.spec.construction.validated import validated
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.body import NodalBody
from derive.spec.model.simulation import Simulation
from derive.spec.model.specification import AnyScene
from derive.terminal import SimulationProgress, progress_of

Simulated = TypeVar("Simulated", bound=AnyScene | NodalBody)


def simulate(
    spec: AnyScene | PlanarBeam | NodalBody,
    *,
    duration: float | None = None,
    output: float | None = None,
    tolerance: float | None = None,
    integrator: str = "adaptive",
    step: float | None = None,
    until: str | None = None,
    earlier: EarlierRun | None = None,
    inputs: Mapping[str, InputFunction] | None = None,
    progress: Progress | bool | None = None,
) -> Trajectory:
    """The motion of a scene from its consistent initial state, or of a single body from its `start`.

    A single beam is simulated as a scene in which it is the body "beam".

    Arguments:
        spec: a scene, a beam or a finite-element body.
        duration: the time that is simulated, s; by default that of the `simulation` of the specification.
        output: the interval between rows, s; by default likewise.
        tolerance: the error of a step, relative and absolute (SI); by default likewise.
        integrator: a name in `INTEGRATORS`; a body takes adaptive, dop853, rk45 and rk4.
        step: that of integrators with fixed steps, s; the others refuse it.
        until: a condition on columns that ends the motion, such as "rod_phi > pi/2".
        earlier: a run that is continued, see `derive.simulation.earlier_run.read_run`; its rows come first.
        inputs: of a scene, functions of the time (s) in Python in place of those of the specification, by the names of
            the run-time inputs; that of a prescribed motion returns its first two time derivatives as well.
        progress: called with the time (s) that the integration has reached; True shows a line with the
            remaining time once the run takes longer than 2 s, False shows none; by default notebooks show one.

    Raises:
        SpecError: if the specification is not valid, or has no duration and output.
        UnknownNameError: for an integrator that is not registered, or an input that the scene does not have.
        SimulationError: if there is no consistent initial state, or if the integration stops.
        CompilerError: if there is no compiler.
        ModelError: if the model refuses a parameter or a state.
        TypeError: for anything but a scene or a body that can be simulated.

    Examples:
        >>> import derive
        >>> ball = derive.scene(
        ...     "flight", gravity=(0, -10), bodies={"ball": {"mass": 1, "inertia": 1, "start": {"velocity": (3, 4)}}}
        ... )
        >>> trajectory = derive.simulate(ball, duration=0.8, output=0.4)
        >>> trajectory["t"]
        array([0. , 0.4, 0.8])
        >>> trajectory["ball_c2"].round(6) + 0.0
        array([0. , 0.8, 0. ])
    """
    whole = with_simulation(simulated(spec), duration, output, tolerance, until)
    end = whole.simulation.duration if whole.simulation else 0.0
    with progress_of(progress, lambda: SimulationProgress(whole.name, end, PATIENCE)) as report:
        return PreparedRun(whole, integrator, step, inputs).trajectory(earlier, report)


def with_simulation(
    spec: Simulated,
    duration: float | None = None,
    output: float | None = None,
    tolerance: float | None = None,
    until: str | None = None,
) -> Simulated:
    """A scene or a body with a `simulation`, in which the given values replace those of the specification.

    Raises SpecError if it is incomplete or wrong.
    """
    given = {"duration": duration, "output": output, "tolerance": tolerance, "until": until}
    changes: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    if spec.simulation is not None and not changes:
        return spec
    if spec.simulation is None and not {"duration", "output"} <= set(changes):
        text = "this table is missing; add it, with `duration` (s) and `output`, the time between rows (s)"
        raise SpecError((Problem("simulation", text),))
    changed = replace(spec.simulation, **changes) if spec.simulation else Simulation(**changes)
    return replace(spec, simulation=validated(replace(spec, simulation=changed)).simulation)
