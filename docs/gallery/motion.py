"""The player of a motion, as the command `simulate` makes it, and the picture of a motion."""

from __future__ import annotations

import derive
from derive.simulation.observables.csv_writer import Column
from derive.simulation.observables.default_plots import default_plots
from derive.simulation.observables.plots import plot_curves, plot_text
from derive.simulation.observables.spatial_scene_player import (
    body_paths,
    drawn_bodies,
    ground_points,
    ties,
)
from derive.visual.motion_page import motion_page
from derive.visual.spatial_mechanism import spatial_picture
from docs.gallery.stroboscope import stroboscope


def player(trajectory: derive.Trajectory) -> str:
    """The page that plays the motion of a scene, with the curves that `simulate` draws."""
    scene = trajectory.scene
    plots = [(plot, plot_text(plot, scene, trajectory.units)) for plot in default_plots(scene, trajectory.model)]
    columns = [
        Column(curve.label or text.doc, curve.unit, curve.y)
        for plot, text in plots
        for curve in plot_curves(plot, trajectory, "")
    ]
    return motion_page(trajectory, columns, trajectory.warnings).text


def drawing(trajectory: derive.Trajectory) -> str:
    """The scene in motion: a planar one at several instants, one in space at the beginning."""
    scene = trajectory.scene
    if isinstance(scene, derive.Scene):
        return stroboscope(trajectory.motion)
    drawn = drawn_bodies(scene)
    return spatial_picture(scene.name, drawn, body_paths(drawn, trajectory.motion), ground_points(scene), ties(scene))
