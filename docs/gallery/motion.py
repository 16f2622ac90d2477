"""The player of a motion and the drawing of a scene, as the commands `simulate` and `report` make them."""

from __future__ import annotations

import derive
from derive.simulation.observables.csv_writer import Column
from derive.simulation.observables.default_plots import default_plots
from derive.simulation.observables.player_data import player_data
from derive.simulation.observables.plots import plot_curves, plot_text
from derive.simulation.observables.spatial_scene_player import (
    body_paths,
    drawn_bodies,
    ground_points,
    spatial_scene_player_data,
    ties,
)
from derive.visual.mechanism import mechanism_picture
from derive.visual.player import player_page, spatial_player_page
from derive.visual.spatial_mechanism import spatial_picture


def player(trajectory: derive.Trajectory) -> str:
    """The page that plays the motion of a scene, with the curves that `simulate` draws."""
    scene = trajectory.scene
    plots = [(plot, plot_text(plot, scene, trajectory.units)) for plot in default_plots(scene, trajectory.model)]
    columns = [
        Column(curve.label or text.doc, curve.unit, curve.y)
        for plot, text in plots
        for curve in plot_curves(plot, trajectory, "")
    ]
    if isinstance(scene, derive.SpatialScene):
        return spatial_player_page(spatial_scene_player_data(scene, trajectory.motion, columns), trajectory.warnings)
    return player_page(player_data(trajectory.motion, columns), trajectory.warnings)


def drawing(scene: derive.Scene | derive.SpatialScene) -> str:
    """The drawing of a scene at the beginning of its motion; that of a scene in space is computed for this."""
    if isinstance(scene, derive.Scene):
        return mechanism_picture(scene)
    drawn = drawn_bodies(scene)
    paths = body_paths(drawn, derive.simulate(scene).motion)
    return spatial_picture(scene.name, drawn, paths, ground_points(scene), ties(scene))
