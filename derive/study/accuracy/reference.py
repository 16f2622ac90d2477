"""What the models of a ladder are compared with: a file, or the finest of models that agree with each other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from derive.errors import Problem, SpecError, quoted
from derive.simulation.observables.plots import PlotCurve, plot_curves
from derive.spec.model.plots import ColumnCurves, Plot, ReferenceCurve
from derive.spec.model.scene import Scene
from derive.spec.parsing.faults import did_you_mean
from derive.study.accuracy.measurement import compiled, motion
from derive.study.accuracy.models import refinements

TOLERANCE = 1e-10
"""That of the runs that make a reference: its error is that of the models."""


@dataclass(frozen=True)
class Reference:
    """A plot with the curve that models are compared with; source: where it comes from.

    error: its own root mean square error over its peak; None if it is not known. Nothing below it is claimed.
    """

    plot: Plot
    source: str
    error: float | None


def compared_plot(scene: Scene, name: str | None) -> Plot:
    """The plot of a scene that a ladder compares: that of the name, or its first one. Raises SpecError."""
    if not scene.plots:
        text = 'a ladder compares a plot; add one, such as [plots.tip] with y = ["the name of a column"]'
        raise SpecError((Problem("plots", text),))
    if scene.simulation is not None and scene.simulation.until is not None:
        text = "models are compared over the same time, and this ends each run at its own; leave `until` out"
        raise SpecError((Problem("simulation.until", text),))
    if name is None:
        return scene.plots[0]
    known = {plot.name: plot for plot in scene.plots}
    if name not in known:
        near = did_you_mean(name, list(known), f"the plots are {', '.join(known)}")
        raise SpecError((Problem("plots", f"there is no plot {quoted(name)}{near}"),))
    return known[name]


def reference(scene: Scene, plot: Plot, error: float | None, own: bool, progress: Callable[[str], None]) -> Reference:
    """The reference of a plot: its file, whose error may be given, or with `own` or without a file a finer model.

    Raises SpecError, SimulationError, CompilerError.
    """
    if plot.reference is not None and not own:
        return Reference(replace(plot, cut=None, pieces=()), plot.reference.file, error)
    return _own(scene, plot, progress)


def _own(scene: Scene, plot: Plot, progress: Callable[[str], None]) -> Reference:
    """The finest of ever finer models; its error is its difference from the one before."""
    bare = bare_plot(plot)
    finest, before, label = None, None, ""
    for model in refinements():
        progress(f"reference: {model.label}")
        (curve,) = plot_curves(
            bare, motion(compiled(replace(scene, plots=(bare,)), model, monitored=False), TOLERANCE), ""
        )
        before, finest, label = finest, curve, model.label
    assert finest is not None and before is not None
    difference = rms_difference(finest, before)
    if difference is None:
        raise SpecError((Problem(f"plots.{plot.name}", "it vanishes all the time, so that no error of it is known"),))
    return Reference(with_curve(bare, label, finest), f"own run, {label}", difference)


def bare_plot(plot: Plot) -> Plot:
    """A plot of one curve, of several columns the first, without reference and without other numbers of pieces."""
    quantity = plot.quantity
    if isinstance(quantity, ColumnCurves):
        quantity = replace(quantity, y=quantity.y[:1])
    return replace(plot, quantity=quantity, cut=None, pieces=(), reference=None)


def with_curve(bare: Plot, label: str, curve: PlotCurve) -> Plot:
    """A plot with a curve as its reference, which the label describes."""
    rows = tuple(zip(map(float, curve.x), map(float, curve.y), strict=True))
    return replace(bare, reference=ReferenceCurve(label, "", "", rows))


def rms_difference(finer: PlotCurve, coarser: PlotCurve) -> float | None:
    """The root mean square difference of two curves over the peak of the finer; None where that vanishes."""
    peak = float(np.abs(finer.y).max())
    return None if peak == 0 else float(np.sqrt(np.mean((finer.y - coarser.y) ** 2)) / peak)
