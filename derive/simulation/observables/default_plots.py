"""Plots of what a scene does not plot itself: its outputs, or, without outputs, the coordinates by their roles."""

from __future__ import annotations

from derive.mechanics.multibody.outputs.registry import OUTPUTS
from derive.roles import Role
from derive.simulation.trajectory import Trajectory
from derive.spec.model.ports import SceneOutput
from derive.spec.model.scene import ColumnCurves, Plot, Scene

COORDINATES = {
    "angles": (Role.ROTATION,),
    "positions": (Role.TRANSLATION, Role.DISPLACEMENT),
    "deformations": (Role.AMPLITUDE,),
}
"""The plots of coordinates by their names, with the roles of the coordinates in each."""


def default_plot_names(scene: Scene) -> tuple[str, ...]:
    """The names that the default plots of a scene may have."""
    if scene.outputs or scene.plots:
        return tuple(output.name for output in _unplotted(scene))
    return tuple(COORDINATES)


def default_plots(trajectory: Trajectory) -> tuple[Plot, ...]:
    """One plot over the time for each output that no plot shows; without outputs and plots, those of coordinates."""
    scene = trajectory.scene
    if scene.outputs or scene.plots:
        return tuple(_plot(output.name, _columns(output)) for output in _unplotted(scene))
    result = []
    for name, roles in COORDINATES.items():
        columns = tuple(c.name for c in trajectory.model.coordinates if c.role in roles)
        result += [_plot(name, columns)] if columns else []
    return tuple(result)


def _unplotted(scene: Scene) -> list[SceneOutput]:
    """The outputs that no plot shows, and whose names no plot has."""
    plotted = {y for plot in scene.plots if isinstance(plot.quantity, ColumnCurves) for y in plot.quantity.y}
    names = {plot.name for plot in scene.plots}
    return [o for o in scene.outputs if o.name not in names and not plotted & {*_columns(o)}]


def _columns(output: SceneOutput) -> tuple[str, ...]:
    """The columns of an output."""
    labels = OUTPUTS[output.kind].labels
    return tuple(f"{output.name}_{label}" if label else output.name for label in labels)


def _plot(name: str, columns: tuple[str, ...]) -> Plot:
    return Plot(name, ColumnCurves(columns))
