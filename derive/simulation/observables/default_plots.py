"""Plots of what a specification does not plot itself: outputs, or coordinates by their roles."""

from __future__ import annotations

from collections.abc import Sequence

from derive.ir.model import Model
from derive.mechanics.multibody.outputs.registry import MONITORS, OUTPUTS
from derive.roles import Role
from derive.simulation.body_trajectory import energy_names
from derive.spec.model.body import NodalBody
from derive.spec.model.plots import ColumnCurves, Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.scene import Scene

COORDINATES = {
    "angles": (Role.ROTATION,),
    "positions": (Role.TRANSLATION, Role.DISPLACEMENT),
    "deformations": (Role.AMPLITUDE,),
}
"""The plots of coordinates by their names, with the roles of the coordinates in each."""


def default_plots(scene: Scene, model: Model) -> tuple[Plot, ...]:
    """One plot over the time for each output that no plot shows; without outputs and plots, those of coordinates."""
    if scene.outputs or scene.plots:
        return tuple(_plot(output.name, output_columns(output)) for output in _unplotted(scene))
    quantities = ((name, [c.name for c in model.coordinates if c.role in roles]) for name, roles in COORDINATES.items())
    return tuple(_plot(name, columns) for name, columns in quantities if columns)


def body_plots(body: NodalBody, model: Model) -> tuple[Plot, ...]:
    """Without plots of its own, those of what describes the motion of a body in space, over the time."""
    if body.plots:
        return ()
    names = {role: [x.name for x in model.coordinates if x.role is role] for role in Role}
    quantities = {
        "position": names[Role.TRANSLATION],
        "rotation": names[Role.QUATERNION],
        "angular_velocity": [x.name for x in model.velocities[3:6]],
        "amplitudes": names[Role.AMPLITUDE],
        "energy": [*energy_names(model)],
    }
    return tuple(_plot(name, columns) for name, columns in quantities.items() if columns)


def _unplotted(scene: Scene) -> list[SceneOutput]:
    """The outputs that no plot shows, and whose names no plot has."""
    plotted = {y for plot in scene.plots if isinstance(plot.quantity, ColumnCurves) for y in plot.quantity.y}
    names = {plot.name for plot in scene.plots}
    return [o for o in scene.outputs if o.name not in names and not plotted & {*output_columns(o)}]


def output_columns(output: SceneOutput) -> tuple[str, ...]:
    """The names of the columns of an output of a scene, or of one that monitors a model."""
    labels = {**OUTPUTS, **MONITORS}[output.kind].labels
    return tuple(f"{output.name}_{label}" if label else output.name for label in labels)


def _plot(name: str, columns: Sequence[str]) -> Plot:
    return Plot(name, ColumnCurves(tuple(columns)))
