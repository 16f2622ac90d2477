"""The chart of a plot of a scene: its curves, its reference, and the deviations from the reference."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

from derive.simulation.observables.motion import reference_curve
from derive.simulation.observables.plots import PlotCurve, PlotText, deflection_doc, percent, with_unit
from derive.spec.model.plots import Deflection, Plot
from derive.visual.line_chart import Chart, Curve


def plot_chart(name: str, plot: Plot, text: PlotText, curves: Sequence[PlotCurve]) -> Chart:
    """The chart of a plot of the scene `name`, with its reference and the deviations from it in percent."""
    reference = None
    deviations = [(curve.label, curve.deviation) for curve in curves if curve.deviation is not None]
    if plot.reference is not None:
        reference = Curve(f"reference: {PurePath(plot.reference.file).name}", *reference_curve(plot.reference.rows))
    quantity = plot.quantity
    return Chart(
        f"{name}: {deflection_doc(quantity) if isinstance(quantity, Deflection) else text.doc}",
        text.x_label,
        text.x_unit,
        with_unit(text.y_label, text.y_unit),
        tuple(Curve(_legend(curve), curve.x, curve.y) for curve in curves),
        reference,
        tuple(Curve(label, x, 100 * values) for label, (x, values) in deviations),
    )


def _legend(curve: PlotCurve) -> str:
    if curve.error is None:
        return curve.label
    rms, largest = curve.error
    return f"{curve.label}: rms {percent(rms)} %, max {percent(largest)} %"
