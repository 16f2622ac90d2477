"""The plots of a scene: curves over time or over a drive with their extremes and errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.simulation.observables.motion import Array, SceneMotion, deflection, deviation, drive_unit, drive_values
from derive.spec.model.scene import Plot, Scene


@dataclass(frozen=True, eq=False)
class PlotCurve:
    """A quantity y (n,) over x (n,) in one motion.

    deviation: the x, and the deviations from the reference divided by the peak of the reference; None without reference
    or where the two have no part in common.
    """

    label: str
    x: Array
    y: Array
    deviation: tuple[Array, Array] | None

    @property
    def least(self) -> tuple[float, float]:
        """The least value, and its x."""
        index = int(np.argmin(self.y))
        return float(self.y[index]), float(self.x[index])

    @property
    def largest(self) -> tuple[float, float]:
        """The largest value, and its x."""
        index = int(np.argmax(self.y))
        return float(self.y[index]), float(self.x[index])

    @property
    def error(self) -> tuple[float, float] | None:
        """The root mean square and the largest deviation, divided by the peak of the reference."""
        if self.deviation is None:
            return None
        return float(np.sqrt(np.mean(self.deviation[1] ** 2))), float(np.abs(self.deviation[1]).max())


def plot_curve(plot: Plot, motion: SceneMotion, label: str) -> PlotCurve:
    """The curve of a plot in a motion."""
    drive = next((d for d in motion.scene.drives if d.name == plot.over), None)
    x = motion.t if drive is None else drive_values(drive, motion.t)
    y = deflection(motion, plot.quantity)
    return PlotCurve(label, x, y, None if plot.reference is None else deviation(x, y, plot.reference))


def plot_doc(plot: Plot) -> str:
    """The quantity of a plot in words."""
    return deflection_doc(plot) + ("" if plot.quantity.over == 1 else f", divided by {plot.quantity.over:g} m")


def y_unit(plot: Plot) -> str:
    """The unit of the quantity of a plot; empty for a ratio."""
    return "m" if plot.quantity.over == 1 else ""


def x_label(scene: Scene, plot: Plot) -> str:
    """The quantity of the x axis of a plot: time, or the motion of a drive."""
    if plot.over is None:
        return "time"
    return f"{'angle' if x_unit(scene, plot) == 'rad' else 'displacement'} of {plot.over}"


def x_unit(scene: Scene, plot: Plot) -> str:
    """The unit of the x axis of a plot: s, rad or m."""
    drive = next((d for d in scene.drives if d.name == plot.over), None)
    return "s" if drive is None else drive_unit(scene, drive)


def percent(ratio: float) -> str:
    """A ratio in percent, with two significant digits."""
    value = 100 * ratio
    return f"{value:.0f}" if value >= 99.5 else f"{value:.1f}" if value >= 0.995 else f"{value:.2g}"


def deflection_doc(plot: Plot) -> str:
    """The deflection of a plot in words, without its divisor."""
    quantity = plot.quantity
    ends = f"{quantity.start} to {quantity.end}"
    return f"deflection of {quantity.marker} from the chord {ends}"
