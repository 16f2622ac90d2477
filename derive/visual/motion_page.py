"""The player of a trajectory: the page for its kind of motion, planar or in space, of a scene or a body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from derive.simulation.observables.csv_writer import Column
from derive.simulation.observables.player_data import player_data
from derive.simulation.trajectory import Trajectory
from derive.spec.model.spatial_scene import SpatialScene
from derive.visual.player import player_page, spatial_player_page


@dataclass(frozen=True)
class MotionPage:
    """The text of a page that plays a motion, and the number of instants that it shows."""

    text: str
    instants: int


def motion_page(motion: Trajectory, curves: Sequence[Column], warnings: Sequence[str]) -> MotionPage:
    """The page that plays a motion, with warnings above it; `curves` are drawn over time below the scene."""
    if motion.body:
        from derive.simulation.observables.spatial_player_data import spatial_player_data

        data = spatial_player_data(motion.body, motion.t, motion.q, curves)
        text = spatial_player_page(data, warnings)
    elif isinstance(motion.scene, SpatialScene):
        from derive.simulation.observables.spatial_scene_player import spatial_scene_player_data

        data = spatial_scene_player_data(motion.scene, motion.motion, curves)
        text = spatial_player_page(data, warnings)
    else:
        data = player_data(motion.motion, curves)
        text = player_page(data, warnings)
    return MotionPage(text, len(data["time"]["values"]))
