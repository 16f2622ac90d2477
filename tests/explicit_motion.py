"""Motions with the kernels alone that explicit integration calls, which take a third of the time to generate."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from derive.simulation.inputs import InputFunction
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.simulate import with_simulation
from derive.simulation.simulated_scene import simulated
from derive.simulation.trajectory import Trajectory


def moved(
    spec: Any,
    *,
    integrator: str = "adaptive",
    step: float | None = None,
    inputs: Mapping[str, InputFunction] | None = None,
    **changes: Any,
) -> Trajectory:
    """The motion that `derive.simulate` returns with these arguments; `changes` are those of the `simulation`."""
    run = PreparedRun(with_simulation(simulated(spec), **changes), integrator, step, inputs, complete=False)
    return run.trajectory()
