"""What the plots of a scene show, as numbers and as charts: curves over time or over a drive, and their references."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath

import numpy as np

from derive.simulation.observables.observables import Array, Motion, curve, deflection, deviation, drive_unit, driven
from derive.spec.model.scene import MarkerRef, Plot, Scene
from derive.visual.line_chart import Chart, Curve


@dataclass(frozen=True, eq=False)
class Line:
    """A quantity y over x in one motion.

    `off` is x and the deviation from the reference over the reference's peak; None where there is nothing to compare.
    """

    label: str
    x: Array
    y: Array
    off: tuple[Array, Array] | None

    @property
    def least(self) -> tuple[float, float]:
        """The least value, and the x at which it is."""
        at = int(np.argmin(self.y))
        return float(self.y[at]), float(self.x[at])

    @property
    def largest(self) -> tuple[float, float]:
        """The largest value, and the x at which it is."""
        at = int(np.argmax(self.y))
        return float(self.y[at]), float(self.x[at])

    @property
    def error(self) -> tuple[float, float] | None:
        """Root mean square and largest deviation, over the peak of the reference."""
        if self.off is None:
            return None
        return float(np.sqrt(np.mean(self.off[1] ** 2))), float(np.abs(self.off[1]).max())


def line(plot: Plot, motion: Motion, label: str) -> Line:
    """What a plot shows of a motion."""
    drive = next((d for d in motion.scene.drives if d.name == plot.over), None)
    x = motion.t if drive is None else driven(drive, motion.t)
    y = deflection(motion, plot.quantity)
    return Line(label, x, y, None if plot.reference is None else deviation(x, y, plot.reference))


def chart(scene: Scene, plot: Plot, lines: Sequence[Line]) -> Chart:
    """The picture of a plot."""
    reference, off = None, [(each.label, each.off) for each in lines if each.off is not None]
    if plot.reference is not None:
        reference = Curve(f"reference: {PurePath(plot.reference.file).name}", *curve(plot.reference.rows))
    return Chart(
        f"{scene.name}: {_what(plot)}",
        over(scene, plot),
        ", ".join(part for part in ("deflection" + _share(plot), unit(plot)) if part),
        tuple(Curve(_legend(each), each.x, each.y) for each in lines),
        reference,
        tuple(Curve(label, x, 100 * values) for label, (x, values) in off),
    )


def said(plot: Plot) -> str:
    """What is drawn, in words."""
    return _what(plot) + ("" if plot.quantity.over == 1 else f", divided by {plot.quantity.over:g} m")


def unit(plot: Plot) -> str:
    """The unit of what is drawn; none of a share."""
    return "m" if plot.quantity.over == 1 else ""


def over(scene: Scene, plot: Plot) -> str:
    """What it is drawn over, with its unit."""
    drive = next((d for d in scene.drives if d.name == plot.over), None)
    if drive is None:
        return "time, s"
    known = drive_unit(scene, drive)
    return f"{'angle' if known == 'rad' else 'displacement'} of {drive.name}, {known}"


def _what(plot: Plot) -> str:
    quantity = plot.quantity
    ends = f"{_place(quantity.start)} to {_place(quantity.end)}"
    return f"deflection of {_place(quantity.marker)} from the chord {ends}"


def _share(plot: Plot) -> str:
    return "" if plot.quantity.over == 1 else f" / {plot.quantity.over:g} m"


def _place(place: MarkerRef) -> str:
    return f"{place.body}.{place.marker}"


def _legend(each: Line) -> str:
    if each.error is None:
        return each.label
    rms, most = each.error
    return f"{each.label}: rms {percent(rms)} %, max {percent(most)} %"


def percent(share: float) -> str:
    """Two digits that matter, in percent."""
    value = 100 * share
    return f"{value:.0f}" if value >= 99.5 else f"{value:.1f}" if value >= 0.995 else f"{value:.2g}"
