"""Initial values of joints with several motions in space: what is given is met, and what a joint has not is refused."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

import derive
from derive.errors import SpecError
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.space.marker_frames import own_frame
from derive.spec.toml.read import parse

SCENE = """
name = "joint_start"
[ground.markers]
o = { at = [0.1, -0.2, 0.3], rotation = { angles = [0.2, 0.5, -0.1], sequence = "xyz" } }
[bodies.puck]
mass = 2
inertia = [0.3, 0.3, 0.5, 0, 0, 0]
centre = [0.05, 0, 0.02]
markers = { m = { at = [0.1, 0, 0.2], rotation = { axis = [1, 0, 1], angle = 0.4 } } }
KEEP
[joints.j]
KIND
between = BETWEEN
start = { START }
[outputs.x]
kind = "position"
marker = "puck.m"
[outputs.v]
kind = "velocity"
marker = "puck.m"
[outputs.turn]
kind = "joint"
joint = "j"
[outputs.rate]
kind = "joint_speed"
joint = "j"
[simulation]
duration = 1e-3
output = 1e-3
"""
ENDS = ('["ground.o", "puck.m"]', '["puck.m", "ground.o"]')


def text(kind: str, start: str, between: str = ENDS[0], keep: bool = False) -> str:
    values = {"KIND": f'kind = "{kind}"', "START": start, "BETWEEN": between}
    result = SCENE.replace("KEEP", "keep_coordinates = true" if keep else "")
    for name, value in values.items():
        result = result.replace(name, value)
    return result


FEW = [(False, ENDS[0], "cylindrical"), (True, ENDS[1], "cylindrical"), (False, ENDS[1], "planar")]
"""Either end, eliminated or kept, of either joint."""


@pytest.mark.parametrize(
    ("keep", "between", "kind"),
    [
        pytest.param(*case, marks=() if case in FEW else pytest.mark.long)
        for case in product((False, True), ENDS, ("cylindrical", "planar"))
    ],
)
def test_what_is_given_is_met(kind: str, keep: bool, between: str) -> None:
    """Displacements and their rates are those along the axes of the first marker, which may turn; also whole turns."""
    angle = 0.7 if keep else 7.3
    given = (
        "displacement = 0.4, displacement_rate = -0.3"
        if kind == "cylindrical"
        else ("displacements = [0.4, -0.5], displacement_rates = [-0.3, 0.6]")
    )
    run = PreparedRun(
        parse(text(kind, f"angle = {angle}, angle_rate = 1.5, {given}", between, keep)), complete=False
    ).trajectory()
    assert (run["turn"][0], run["rate"][0]) == (pytest.approx(angle, abs=1e-12), pytest.approx(1.5, abs=1e-12))
    ground = own_frame(run.scene.ground[0])
    x, v = (np.array([run[f"{name}_{k}"][0] for k in (1, 2, 3)]) for name in "xv")
    c, s = np.cos(angle), np.sin(angle)
    swapped = between == ENDS[1]
    axes = ground.axes @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) if swapped else ground.axes
    spin = -1.5 * ground.axes[:, 2] if swapped else np.zeros(3)  # of the first marker
    d, rate = (ground.position - x, -v) if swapped else (x - ground.position, v)
    expected = ([0, 0, 0.4], [0, 0, -0.3]) if kind == "cylindrical" else ([0.4, -0.5, 0], [-0.3, 0.6, 0])
    assert axes.T @ d == pytest.approx(expected[0], abs=1e-10)
    assert axes.T @ (rate - np.cross(spin, d)) == pytest.approx(expected[1], abs=1e-10)


def test_they_are_written_back() -> None:
    spec = parse(text("planar", "angle = 0.7, displacements = [0.4, -0.5], displacement_rates = [0, 1], guess = true"))
    assert derive.validated(spec).joints == spec.joints


@pytest.mark.parametrize(
    ("kind", "start", "message"),
    [
        (
            "cylindrical",
            "speed = 1",
            "joints.j.start.speed: the cylindrical joint j has no speed; it has angle, angle_rate",
        ),
        (
            "planar",
            "displacement = 1",
            "the planar joint j has no displacement; it has angle, angle_rate, displacements",
        ),
        ("spherical", "angle = 1", "the spherical joint j has no angle; give initial values of its bodies instead"),
        ("revolute", "speed = 1, angle_rate = 1", "speed and angle_rate are the same here; leave one of them out"),
        ("planar", "displacements = [1, 2, 3]", "joints.j.start.displacements: a list of 2 numbers is needed"),
    ],
)
def test_what_a_joint_has_not(kind: str, start: str, message: str) -> None:
    with pytest.raises(SpecError) as error:
        parse(text(kind, start))
    assert message in str(error.value)


def test_values_that_contradict_each_other() -> None:
    own = "start = { position = [0, 0, 0], rotation = [1, 0, 0, 0] }"
    with pytest.raises(derive.SpecError, match=r"joints\.j\.start\.displacement"):
        PreparedRun(
            parse(text("cylindrical", "displacement = 0.4").replace("[joints.j]", f"{own}\n[joints.j]")), complete=False
        ).trajectory()
