"""Run-time inputs in simulations: functions of the specification take their place, or functions in Python."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from derive.errors import Problem, SpecError
from derive.registry import UnknownNameError
from derive.runtime.native_call import Vector, checked_vector
from derive.runtime.native_scene import Forms, NativeScene
from derive.spec.model.scene_functions import with_changed_functions
from derive.spec.model.specification import AnyScene
from derive.spec.model.time_function import TimeFunction

S = TypeVar("S", bound=AnyScene)

InputFunction = Callable[[float], float | Sequence[float]]
"""The value of an input at a time (s); for a prescribed motion with its first two time derivatives."""


def with_functions(scene: S, given: Mapping[str, InputFunction]) -> S:
    """A scene whose inputs are the functions of its specification; those that are `given` in Python remain inputs.

    Raises SpecError where an input has no function, UnknownNameError for the name of no input.
    """
    names = [value.name for value in scene.inputs]
    for name in given:
        if name not in names:
            raise UnknownNameError(f"input of {scene.name}", name, names)
    replaced = [value for value in scene.inputs if value.name not in given]
    missing = [value.name for value in replaced if value.function is None]
    if missing:
        text = 'a simulation needs its value; write one, such as value = "0.1*t", or give a function in Python'
        raise SpecError(tuple(Problem(f"inputs.{name}", text) for name in missing))
    functions = {value.name: value.function for value in replaced if value.function is not None}

    def resolved(function: TimeFunction) -> TimeFunction:
        return functions.get(function.name, function) if function.kind == "input" else function

    inputs = tuple(value for value in scene.inputs if value.name in given)
    changed: Any = with_changed_functions(scene, resolved)
    result: S = replace(changed, inputs=inputs)
    return result


class DrivenScene(NativeScene):
    """A compiled scene whose run-time inputs follow functions of the time in Python."""

    follows_functions = True

    def __init__(self, native: NativeScene, scene: AnyScene, functions: Mapping[str, InputFunction]) -> None:
        """functions: one for each input of the scene, with as many values as the compiled scene has inputs of it."""
        self.__dict__.update(native.__dict__)
        self._functions = [functions[value.name] for value in scene.inputs]
        self.dae = Forms({name: form.of(self) for name, form in native.dae.items()})

    def inputs_at(self, t: float) -> Vector:
        """The inputs u (inputs,) at a time. Raises ValueError where a function returns too many or too few values."""
        values = [np.atleast_1d(np.asarray(function(t), dtype=np.float64)) for function in self._functions]
        return checked_vector(len(self.inputs), np.concatenate(values), f"the inputs {', '.join(self.inputs)}")

    def own_at(self, t: float, k: ArrayLike) -> ArrayLike:
        """The constants k (nk,) with the inputs at t (s) behind them."""
        return self.with_inputs(k, self.inputs_at(t))
