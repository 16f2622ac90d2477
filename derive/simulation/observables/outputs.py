"""The run-time inputs and the outputs of a scene along a trajectory."""

from __future__ import annotations

import numpy as np

from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.integration.solution import Solution


def port_values(native: NativeScene, k: Vector, solution: Solution) -> tuple[Matrix, Matrix]:
    """The inputs (n, nu) and the outputs (n, nout) in the rows of a solution."""
    count = len(solution.t)
    inputs, outputs = np.empty((count, len(native.inputs))), np.empty((count, len(native.outputs)))
    for i, (time, q, v) in enumerate(zip(solution.t, solution.q, solution.v, strict=True)):
        t = float(time)
        inputs[i] = native.inputs_at(t)
        if native.outputs:
            vdot, multipliers = native.solve(t, q, v, k)
            outputs[i] = native.evaluate_outputs(t, q, v, vdot, multipliers, k)
    return inputs, outputs
