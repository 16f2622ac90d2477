"""The chart of a plot of a scene: its curves, its reference, and the deviations from the reference."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

from derive.mechanics.multibody.outputs.deflection import deflection_doc
from derive.percentages import percent
from derive.simulation.observables.motion import reference_curve
from derive.simulation.observables.plots import PlotCurve, PlotText
from derive.spec.model.plots import Deflection, Plot
from derive.visual.line_chart import Chart, Curve, Panel


def plot_chart(name: str, plot: Plot, text: PlotText, curves: Sequence[PlotCurve]) -> Chart:
    """The chart of a plot of the scene `name`, with its reference and the deviations from it in percent.

    It has a panel for each unit, in the order of the curves.
    """
    reference = None
    if plot.reference is not None:
        reference = Curve(f"reference: {PurePath(plot.reference.file).name}", *reference_curve(plot.reference.rows))
    units = dict.fromkeys(curve.unit for curve in curves)
    panels = [_panel(unit, [curve for curve in curves if curve.unit == unit], reference) for unit in units]
    quantity = plot.quantity
    doc = text.doc
    if isinstance(quantity, Deflection):
        doc = deflection_doc(quantity.marker, quantity.chord, None)  # the divisor is on the axis
    return Chart(
        f"{name}: {doc}",
        text.x_label,
        text.x_unit,
        tuple(panels),
    )


def _panel(unit: str, curves: Sequence[PlotCurve], reference: Curve | None) -> Panel:
    """The curves of a unit."""
    quantities = dict.fromkeys(curve.quantity for curve in curves)
    return Panel(", ".join(quantities), unit, tuple(map(_drawn, curves)), reference)


def _drawn(curve: PlotCurve) -> Curve:
    if curve.deviation is None or curve.error is None:
        return Curve(curve.label, curve.x, curve.y)
    x, deviation = curve.deviation
    rms, largest = curve.error
    label = f"{curve.label}: rms {percent(rms)}, max {percent(largest)}"
    return Curve(label, curve.x, curve.y, (x, 100 * deviation))
