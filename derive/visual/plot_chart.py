"""The chart of a plot of a scene: its curves, its reference, and the deviations from the reference."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

from derive.simulation.observables.motion import reference_curve
from derive.simulation.observables.plots import PlotCurve, deflection_doc, percent, x_label, x_unit, y_unit
from derive.spec.model.scene import Plot, Scene
from derive.visual.line_chart import Chart, Curve


def plot_chart(scene: Scene, plot: Plot, curves: Sequence[PlotCurve]) -> Chart:
    """The chart of a plot, with its reference and the deviations from it in percent."""
    reference = None
    deviations = [(curve.label, curve.deviation) for curve in curves if curve.deviation is not None]
    if plot.reference is not None:
        reference = Curve(f"reference: {PurePath(plot.reference.file).name}", *reference_curve(plot.reference.rows))
    return Chart(
        f"{scene.name}: {deflection_doc(plot)}",
        x_label(scene, plot),
        x_unit(scene, plot),
        ", ".join(part for part in ("deflection" + _divisor(plot), y_unit(plot)) if part),
        tuple(Curve(_legend(curve), curve.x, curve.y) for curve in curves),
        reference,
        tuple(Curve(label, x, 100 * values) for label, (x, values) in deviations),
    )


def _divisor(plot: Plot) -> str:
    return "" if plot.quantity.over == 1 else f" / {plot.quantity.over:g} m"


def _legend(curve: PlotCurve) -> str:
    if curve.error is None:
        return curve.label
    rms, largest = curve.error
    return f"{curve.label}: rms {percent(rms)} %, max {percent(largest)} %"
