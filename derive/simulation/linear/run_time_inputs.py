"""The values of the run-time inputs of a scene at a time; an input without function is zero."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, TypeVar

from derive.errors import Problem, SpecError
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.inputs import with_functions
from derive.simulation.time_derivatives import derivatives_at
from derive.spec.model.specification import AnyScene
from derive.spec.model.time_function import TimeFunction

S = TypeVar("S", bound=AnyScene)
ZERO = TimeFunction("number")
DERIVATIVES = "this function", "its first derivative", "its second derivative"


def with_zero_inputs(scene: S) -> S:
    """A scene whose run-time inputs are zero in simulations where the specification gives them no function."""
    changed: Any = scene
    inputs = tuple(replace(value, function=value.function or ZERO) for value in scene.inputs)
    result: S = replace(changed, inputs=inputs)
    return result


def scene_with_values(scene: S) -> S:
    """A scene whose run-time inputs are replaced by the functions of the specification, or by zero."""
    return with_functions(with_zero_inputs(scene), {})


def constants(scene: AnyScene, native: NativeScene, t: float) -> Vector:
    """The constants k of a compiled scene, with the values of its run-time inputs at t (s) behind them (nk + nu,)."""
    return native.with_inputs(native.setup(), [number for numbers in input_values(scene, t) for number in numbers])


def input_values(scene: AnyScene, t: float) -> tuple[tuple[float, ...], ...]:
    """The value of each input at t (s), with its first two time derivatives if it prescribes a motion.

    All numbers in turn are u (inputs,) of the compiled scene. Raises SpecError where one of them is not finite.
    """
    motions = {drive.motion.name for drive in scene.drives if drive.motion is not None}
    values: list[tuple[float, ...]] = []
    for given in scene.inputs:
        path = f"inputs.{given.name}.value"
        numbers = derivatives_at(given.function or ZERO, t, path)[: 3 if given.name in motions else 1]
        for what, number in zip(DERIVATIVES, numbers, strict=False):
            if not math.isfinite(number):
                raise SpecError((Problem(path, f"{what} has no value at t = {t:g} s, which is needed here"),))
        values.append(numbers)
    return tuple(values)
