"""The outputs of a sweep: the peak, the rms or the final value of a column, or of the deflection in a plot."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import assert_never

import numpy as np

from derive.errors import TisserandError, quoted
from derive.registry import UnknownNameError
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.integration.solution import Solution
from derive.simulation.observables.marker_positions import deflection
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.observables.plots import deflection_quantity
from derive.simulation.trajectory import column_values
from derive.spec.model.plots import ColumnCurves, Deflection
from derive.spec.model.specification import AnyScene


class Statistic(Enum):
    """A statistic of a curve y(t): the largest |y|, the root mean square over time (trapezoidal), or the last value."""

    PEAK = "peak"
    RMS = "rms"
    FINAL = "final"

    def of(self, t: Vector, y: Vector) -> float:
        """The statistic of a curve y (n,) in rows at the times t (n,), s."""
        match self:
            case Statistic.PEAK:
                return float(np.abs(y).max())
            case Statistic.RMS:
                if len(t) == 1:
                    return float(np.abs(y[0]))
                return float(np.sqrt(np.trapezoid(y**2, t) / (t[-1] - t[0])))
            case Statistic.FINAL:
                return float(y[-1])
            case _:
                assert_never(self)


@dataclass(frozen=True)
class SweepOutput:
    """A statistic of the column `name`, or of the `deflection` in the plot of that name; unit: that of the value."""

    statistic: Statistic
    name: str
    unit: str
    deflection: Deflection | None = None

    @property
    def label(self) -> str:
        """The name of the output in tables: "peak_deflection"."""
        return f"{self.statistic.value}_{self.name}"

    @property
    def text(self) -> str:
        """The text of the output: "peak of slider_s"."""
        words = {Statistic.PEAK: "peak", Statistic.RMS: "rms", Statistic.FINAL: "final value"}[self.statistic]
        return f"{words} of {self.name}"


class OutputError(TisserandError):
    """An output that a specification does not have."""


def output(text: str, scene: AnyScene, units: dict[str, str]) -> SweepOutput:
    """The output that a text names: "peak:slider_s", or "peak" alone of the first plot of the scene.

    A name is that of a column, or else of a plot. units: those of the columns by their names. Raises OutputError,
    UnknownNameError.
    """
    kind, _, name = (part.strip() for part in text.partition(":"))
    statistics = {statistic.value: statistic for statistic in Statistic}
    if kind not in statistics:
        raise UnknownNameError("statistic", kind, statistics)
    if not name:
        if not scene.plots:
            raise OutputError(
                f"--output {kind}: of what? {scene.name} has no plot; name a column, such as {kind}:{_last(units)}; "
                f"the columns are {', '.join(units)}"
            )
        plot = scene.plots[0]
    elif name in units:
        return SweepOutput(statistics[kind], name, units[name])
    else:
        plots = {plot.name: plot for plot in scene.plots}
        if name not in plots:
            raise UnknownNameError("column or plot", name, [*dict.fromkeys([*units, *plots])])
        plot = plots[name]
    quantity = plot.quantity
    match quantity:
        case Deflection():
            return SweepOutput(statistics[kind], plot.name, deflection_quantity(quantity)[1], quantity)
        case ColumnCurves(y=(column,)):
            return SweepOutput(statistics[kind], column, units[column])
        case ColumnCurves():
            columns = ", ".join(f"{kind}:{column}" for column in quantity.y)
            raise OutputError(
                f"--output {kind}: the plot {quoted(plot.name)} has several curves; choose one of {columns}"
            )
        case _:
            assert_never(quantity)


def _last(units: Iterable[str]) -> str:
    return list(units)[-1]


def evaluate(
    outputs: Sequence[SweepOutput],
    names: Sequence[str],
    scene: AnyScene,
    native: NativeScene,
    k: Vector,
    solution: Solution,
) -> tuple[float, ...]:
    """The values of outputs in a run; names: those of all columns of the scene."""
    columns: dict[str, Vector] = {}
    if any(o.deflection is None for o in outputs):
        columns = dict(zip(names, column_values(scene, native, k, solution), strict=True))
    motion = SceneMotion(scene, native, k, solution.t, solution.q, solution.v, solution.outputs)
    return tuple(
        o.statistic.of(solution.t, columns[o.name] if o.deflection is None else deflection(motion, o.deflection))
        for o in outputs
    )
