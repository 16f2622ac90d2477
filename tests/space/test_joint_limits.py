"""Limits of joints: nothing enforces them, and a run notes where a joint passes one, whatever its coordinates are."""

from __future__ import annotations

import pytest

from derive.errors import SpecError
from derive.spec.toml.read import parse
from explicit_motion import moved

HINGE = """
name = "hinge"
[scene]
gravity = [0, 0, 0]
[ground.markers]
o = [0, 0, 0]
[bodies.wheel]
mass = 1
inertia = [1, 1, 2, 0, 0, 0]
markers = {{ o = [0, 0, 0] }}
keep_coordinates = {kept}
[joints.axle]
kind = "{kind}"
between = ["{first}"]
limits = [{limits}]
start = {{ speed = {speed} }}
[simulation]
duration = 2
output = 0.25
"""
ORDERS = {1: 'ground.o", "wheel.o', -1: 'wheel.o", "ground.o'}


@pytest.mark.parametrize(
    ("sign", "kept"), [(-1, "true"), (1, "false"), pytest.param(1, "true", marks=pytest.mark.long)]
)
def test_turns_beyond_a_limit(kept: str, sign: int) -> None:
    """Also beyond half a turn, with the sign of the second body against the first."""
    text = HINGE.format(kept=kept, kind="revolute", first=ORDERS[sign], limits="-4, 3.9", speed=2)
    notes = moved(parse(text)).notes
    assert "joints.axle: passes its limit of 3.9 rad by t = 2 s and reaches 4 rad; nothing enforces limits" in notes
    assert not any("limits" in note for note in moved(parse(text.replace("3.9", "4.1"))).notes)


@pytest.mark.parametrize("kept", ["true", "false"])
def test_displacements_beyond_a_limit(kept: str) -> None:
    text = HINGE.format(kept=kept, kind="prismatic", first=ORDERS[1], limits="-0.7, 5", speed=-1)
    notes = moved(parse(text)).notes
    assert "joints.axle: passes its limit of -0.7 m by t = 0.75 s and reaches -2 m; nothing enforces limits" in notes


@pytest.mark.parametrize("speed", ["-1e-10", "-1e-8"])
def test_rounding_errors_pass_no_limit(speed: str) -> None:
    """A joint that stays at a limit is beyond it by the rounding of its position."""
    text = HINGE.format(kept="false", kind="prismatic", first=ORDERS[1], limits="0, 5", speed=speed)
    assert any("limits" in note for note in moved(parse(text)).notes) == (speed == "-1e-8")


def test_limits_in_the_wrong_order_and_of_other_joints() -> None:
    with pytest.raises(SpecError, match=r"joints\.axle\.limits: the first limit is the smaller one"):
        parse(HINGE.format(kept="false", kind="revolute", first=ORDERS[1], limits="1, -1", speed=0))
    with pytest.raises(SpecError, match="a cylindrical joint has no limits"):
        parse(HINGE.format(kept="false", kind="cylindrical", first=ORDERS[1], limits="-1, 1", speed=0))
