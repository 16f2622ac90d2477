"""The values of the run-time inputs of a scene at a time; an input without function is zero."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.inputs import with_functions
from derive.simulation.observables.motion import function_values
from derive.spec.model.scene import Scene
from derive.spec.model.time_function import TimeFunction

ZERO = TimeFunction("number")
STEP = 1e-4
"""The step (s) of differences for the time derivatives of prescribed motions."""


def scene_with_values(scene: Scene) -> Scene:
    """A scene without run-time inputs: in their places are the functions of the specification, or zero."""
    inputs = tuple(replace(value, function=value.function or ZERO) for value in scene.inputs)
    return with_functions(replace(scene, inputs=inputs), {})


def input_values(scene: Scene, native: NativeScene, t: float) -> Vector:
    """u (inputs,) at t (s); the time derivatives of prescribed motions are differences of fourth order."""
    motions = {drive.motion.name for drive in scene.drives if drive.motion is not None}
    values: list[float] = []
    for value in scene.inputs:
        times = t + STEP * np.arange(-2.0, 3.0)
        f = np.broadcast_to(function_values(value.function or ZERO, times), times.shape)
        values.append(float(f[2]))
        if value.name in motions:
            values.append(float(f @ [1, -8, 0, 8, -1]) / (12 * STEP))
            values.append(float(f @ [-1, 16, -30, 16, -1]) / (12 * STEP**2))
    assert len(values) == len(native.inputs)
    return np.array(values)
