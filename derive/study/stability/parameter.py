"""The parameter of a study of stability: a name as for `--set`, and its values."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

from derive.errors import Problem, SpecError, quoted
from derive.simulation.linear.settled_functions import SettledFunctions, settled_functions
from derive.spec.model.specification import AnyScene
from derive.spec.set_values import with_values
from derive.study.studied_scene import without_initial_values
from derive.study.study_options import MAX_VALUES, whole


@dataclass(frozen=True)
class ParameterRange:
    """A parameter or a key of the specification, with `count` values from `low` to `high` in the units of the file.

    Raises ValueError for values that do not rise, and for fewer than two.
    """

    name: str
    low: float
    high: float
    count: int

    def __post_init__(self) -> None:
        whole(f"the number of values of {self.name}", self.count, MAX_VALUES, 2)
        if not (isfinite(self.low) and isfinite(self.high) and self.low < self.high):
            text = "the first value is a number less than the last"
            raise ValueError(f"parameter {self.name}: {text}, not {self.low!r} to {self.high!r}")

    @property
    def values(self) -> tuple[float, ...]:
        """The values, rising."""
        return tuple(float(x) for x in np.linspace(self.low, self.high, self.count))


def parameter_range(given: Any) -> ParameterRange:
    """The range from its name, its first and last value and their number. Raises ValueError for anything else."""
    match given:
        case (str(name), int() | float() as low, int() | float() as high, count):
            return ParameterRange(name, float(low), float(high), count)
    text = 'a name, the first and the last value and their number are needed, such as ("P", 0, 10, 11)'
    raise ValueError(f"parameter: {text}, not {given!r}")


@dataclass(frozen=True)
class StudiedParameter:
    """A parameter of a scene whose values need no other compiled model.

    symbol: that of the run-time parameter of the model; None for an initial value, such as a spin. functions: the
    functions of time of the scene that settle.
    """

    scene: AnyScene
    range: ParameterRange
    symbol: str | None
    functions: SettledFunctions

    def scene_at(self, value: float) -> AnyScene:
        """The scene with a value of the parameter, and the functions of time as they settle. Raises SpecError."""
        return self.functions.scene(_with(self.scene, self.range.name, value)[0])

    @property
    def motion(self) -> str:
        """The text on the motion about which models are linearised."""
        text = (
            "each model is linearised about its equilibrium or steady rotation at each value, in axes that rotate along"
        )
        return f"{text}, with {self.functions}" if self.functions.settled else text


def studied(scene: AnyScene, limits: ParameterRange) -> StudiedParameter:
    """The parameter of a study.

    Raises SpecError for a name that the scene does not know, for values that it refuses, and for a key on whose value
    the compiled model depends.
    """
    first, symbol = _with(scene, limits.name, limits.low)
    last, _ = _with(scene, limits.name, limits.high)
    if symbol is None and without_initial_values(first) != without_initial_values(last):
        text = f"{quoted(limits.name)} is neither a number that can be a run-time parameter nor an initial value"
        advice = "; name a mass, a stiffness, a length, a value of a load, or a value of `start`"
        raise SpecError((Problem("", text + advice),), "--parameter")
    return StudiedParameter(first if symbol else scene, limits, symbol, settled_functions([first, last]))


def _with(scene: AnyScene, name: str, value: float) -> tuple[AnyScene, str | None]:
    """The scene with a value of the parameter, and its symbol if it is a run-time parameter."""
    try:
        changed, (change, *_) = with_values(scene, {name: repr(value)})
    except SpecError as error:
        raise SpecError(error.problems, "--parameter") from None
    return changed, change.symbol
