"""The run-time inputs and the outputs of a scene along a trajectory."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.integration.solution import Solution


def port_values(
    native: NativeScene, k: Vector, solution: Solution, monitors: Collection[str] = ()
) -> tuple[Matrix, Matrix]:
    """The inputs (n, nu) and the outputs (n, nout) in the rows of a solution, without the outputs `monitors`."""
    count = len(solution.t)
    own = [i for i, name in enumerate(native.outputs) if name not in monitors]
    if solution.outputs is not None and not native.inputs:
        return np.empty((count, 0)), solution.outputs[:, own]
    inputs, outputs = np.empty((count, len(native.inputs))), np.empty((count, len(own)))
    for i, (time, q, v) in enumerate(zip(solution.t, solution.q, solution.v, strict=True)):
        t = float(time)
        inputs[i] = native.inputs_at(t)
        if solution.outputs is not None:
            outputs[i] = solution.outputs[i, own]
        elif own:
            vdot, multipliers = native.solve(t, q, v, k)
            outputs[i] = native.evaluate_outputs(t, q, v, vdot, multipliers, k)[own]
    return inputs, outputs
