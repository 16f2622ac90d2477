"""The plots of a scene: curves over time, over a drive or over another column, with their extremes and errors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import assert_never

import numpy as np

from derive.mechanics.multibody.outputs.deflection import deflection_doc
from derive.simulation.observables.marker_positions import deflection
from derive.simulation.observables.motion import Array, SceneMotion, deviation, drive_unit, simulated_drive
from derive.simulation.trajectory import Trajectory
from derive.spec.model.plots import ColumnCurves, Deflection, Plot
from derive.spec.model.specification import AnyScene


@dataclass(frozen=True, eq=False)
class PlotCurve:
    """A quantity y (n,) over x (n,) in one motion.

    deviation: the x, and the deviations from the reference divided by the peak of the reference; None without reference
    or where the two have no part in common. quantity, unit: those of y, for the label of an axis; the unit of a number
    is "".
    """

    label: str
    x: Array
    y: Array
    deviation: tuple[Array, Array] | None
    quantity: str = ""
    unit: str = ""

    @property
    def least(self) -> tuple[float, float]:
        """The least value, and its x."""
        index = int(np.argmin(self.y))
        return float(self.y[index]) + 0.0, float(self.x[index])

    @property
    def largest(self) -> tuple[float, float]:
        """The largest value, and its x."""
        index = int(np.argmax(self.y))
        return float(self.y[index]) + 0.0, float(self.x[index])

    @property
    def error(self) -> tuple[float, float] | None:
        """The root mean square and the largest deviation, divided by the peak of the reference."""
        if self.deviation is None:
            return None
        return float(np.sqrt(np.mean(self.deviation[1] ** 2))), float(np.abs(self.deviation[1]).max())


def plot_curves(plot: Plot, trajectory: Trajectory, label: str) -> tuple[PlotCurve, ...]:
    """The curves of a plot in a motion; several columns are distinguished by their names behind the label.

    Raises UnknownNameError for a column that the motion does not have.
    """
    quantity = plot.quantity
    if isinstance(quantity, Deflection):
        return (plot_curve(plot, trajectory.motion, label),)
    return _column_curves(plot, quantity, trajectory, label)


def _column_curves(plot: Plot, quantity: ColumnCurves, table: Trajectory, label: str) -> tuple[PlotCurve, ...]:
    """The curves of a plot of columns."""
    x, units = table[quantity.x], table.units
    names = {name: f"{label}: {name}" if label else name for name in quantity.y}
    return tuple(_curve(plot, shown, x, table[name], (name, units.get(name, ""))) for name, shown in names.items())


def plot_curve(plot: Plot, motion: SceneMotion, label: str) -> PlotCurve:
    """The curve of a plot of a deflection in a motion."""
    assert isinstance(plot.quantity, Deflection)
    drive = next((d for d in motion.scene.drives if d.name == plot.over), None)
    x = motion.t if drive is None else simulated_drive(motion.native, drive, motion.t)
    return _curve(plot, label, x, deflection(motion, plot.quantity), deflection_quantity(plot.quantity))


def _curve(plot: Plot, label: str, x: Array, y: Array, quantity: tuple[str, str]) -> PlotCurve:
    return PlotCurve(label, x, y, None if plot.reference is None else deviation(x, y, plot.reference), *quantity)


@dataclass(frozen=True)
class PlotText:
    """The texts of a plot: its quantities, and the label and the unit of the x axis, which is empty without a unit."""

    doc: str
    x_label: str
    x_unit: str


def plot_text(plot: Plot, scene: AnyScene, units: Mapping[str, str]) -> PlotText:
    """The texts of a plot; `units` are those of the columns of the motion."""
    quantity = plot.quantity
    match quantity:
        case Deflection():
            doc = deflection_doc(quantity.marker, quantity.chord, quantity.divided_by)
            return PlotText(doc, _drive_label(scene, plot), _drive_unit(scene, plot))
        case ColumnCurves():
            return PlotText(", ".join(quantity.y), "time" if quantity.x == "t" else quantity.x, units[quantity.x])
    assert_never(quantity)


def deflection_quantity(quantity: Deflection) -> tuple[str, str]:
    """A deflection for the label of an axis, and its unit: m, or none where it is divided by a length."""
    length = quantity.divided_by
    return ("deflection", "m") if length is None else (f"deflection / {length:g} m", "")


def with_unit(name: str, unit: str) -> str:
    """The text of a name, and of its unit behind a comma if it has one."""
    return f"{name}, {unit}" if unit else name


def _drive_label(scene: AnyScene, plot: Plot) -> str:
    """The quantity of the x axis of a deflection: time, or the motion of a drive."""
    if plot.over is None:
        return "time"
    return f"{'angle' if _drive_unit(scene, plot) == 'rad' else 'displacement'} of {plot.over}"


def _drive_unit(scene: AnyScene, plot: Plot) -> str:
    """The unit of the x axis of a deflection: s, rad or m."""
    drive = next((d for d in scene.drives if d.name == plot.over), None)
    return "s" if drive is None else drive_unit(scene, drive)
