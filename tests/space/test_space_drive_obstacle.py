"""A slider-crank in space whose rod is too short for its drive to turn through is noted, and no other."""

from __future__ import annotations

import math

import pytest

import derive
from conftest import ROOT
from derive.runtime.interpreted_scene import InterpretedScene
from derive.simulation.drive_obstacle import DriveObstacle, drive_obstacle
from derive.simulation.scene_start import state_of
from derive.simulation.space.initial_state import spatial_scene_size
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.toml.read import parse

TEXT = (ROOT / "examples" / "spatial_crank_slider_rigid.toml").read_text(encoding="utf-8")
HEIGHT, BESIDE, CRANK = 0.1, 0.12, 0.08
"""m: of the axis of the crank above and beside the guide, and the length of the crank."""


def obstacle(rod: float, motion: str, angle: float, keep: str = "") -> DriveObstacle | None:
    """The obstacle of a crank that begins at an angle (rad), with a rod of a length (m)."""
    text = TEXT.replace("at = [0.3, 0, 0]", f"at = [{rod}, 0, 0]").replace("angle = 0, speed = 6", f"angle = {angle}")
    text = text.replace("[bodies.rod]", f"{keep}\n[bodies.rod]")
    text = text.replace("position = [0.2, 0, 0]", "position = [0.1, 0, 0]")
    scene = parse(text + f'[drives.motor]\njoint = "bearing"\n{motion}\n')
    assert isinstance(scene, SpatialScene)
    native = InterpretedScene(derive.lower(derive.derive(scene), explicit=True))
    k = native.setup()
    return drive_obstacle(scene, native, k, state_of(scene, native, k).q, spatial_scene_size(scene))


def ends(rod: float) -> tuple[float, float]:
    """The angles of the crank (rad) between which a rod reaches the guide: there it is normal to it."""
    reach = (rod**2 - HEIGHT**2 - BESIDE**2 - CRANK**2) / (2 * CRANK * math.hypot(HEIGHT, BESIDE))
    first = math.acos(reach) - math.atan2(HEIGHT, BESIDE)
    return first, 2 * math.pi - math.acos(reach) - math.atan2(HEIGHT, BESIDE)


KEPT = "keep_coordinates = true"


@pytest.mark.parametrize(
    ("speed", "keep"),
    [(6.0, KEPT), (-6.0, ""), *(pytest.param(*case, marks=pytest.mark.long) for case in ((6.0, ""), (-6.0, KEPT)))],
    ids=["forwards constrained", "backwards minimal", "forwards minimal", "backwards constrained"],
)
def test_a_rod_that_is_too_short(speed: float, keep: str) -> None:
    found = obstacle(0.2, f"speed = {speed}\noffset = 2", 2.0, keep)
    end = ends(0.2)[1 if speed > 0 else 0]
    assert found is not None and found.drives[0][1] == pytest.approx(end, abs=2e-3)
    assert found.t == pytest.approx((end - 2.0) / speed, rel=5e-3)
    assert set(found.joints) & {"ball", "yoke", "guide"} and not found.rigid


@pytest.mark.parametrize(
    ("rod", "motion"),
    [(0.3, "speed = 6\noffset = 2"), (0.2, "motion = '2 + sin(6*t)'")],
    ids=["long enough", "swings where it reaches"],
)
def test_a_drive_that_turns_through_is_not_noted(rod: float, motion: str) -> None:
    assert obstacle(rod, motion, 2.0) is None
