"""Frequencies of mechanisms in space, in minimal perturbations, against closed forms and minimal models."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from minimal_models import Array, Lagrangian
from reference_mechanisms import turned_double_pendulum, turned_double_pendulum_scene
from scipy.linalg import eigvals

from derive.simulation.linear.displaced_bodies import displaced_paths
from derive.simulation.linear.modes import modes
from derive.simulation.observables.spatial_player_data import placed
from derive.simulation.observables.spatial_scene_player import drawn_bodies
from derive.spec.toml.read import parse
from derive.visual.mode_pages import drawn_modes, modes_page, modes_picture


def model_frequencies(model: Lagrangian, q: Sequence[float]) -> Array:
    """The angular frequencies about a state of rest, from differences of accelerations."""
    n, step = len(q), 1e-4
    A = np.zeros((n, n))
    for j in range(n):
        ahead, behind = np.array(q, float), np.array(q, float)
        ahead[j] += step
        behind[j] -= step
        A[:, j] = (model.accelerations(ahead, [0] * n) - model.accelerations(behind, [0] * n)) / (2 * step)
    return np.asarray(np.sqrt(np.sort(-eigvals(A).real)))


HANGING = """
name = "hanging_body"
[scene]
gravity = [0, 0, -9.81]
[ground.markers]
hook = [0.1, 0.2, 0.3]
[bodies.body]
mass = 2
centre = [0, 0, -0.5]
inertia = [0.3, 0.2, 0.1, 0, 0, 0]
markers.top = [0, 0, 0]
start = { rotation = [1, 0, 0, 0], position = [0.1, 0.2, 0.3] }
KEEP
[joints.ball]
kind = "spherical"
between = ["ground.hook", "body.top"]
[simulation]
duration = 1
output = 1
"""


def test_modes_are_drawn_with_joints_that_hold() -> None:
    """At all phases the marker of the body stays at the joint, far from the equilibrium; the body turns both ways."""
    result = modes(parse(HANGING.replace("KEEP", "keep_coordinates = true")))
    drawn = drawn_bodies(result.spec)  # type: ignore[arg-type]
    label, mode = drawn_modes(result, 2)[0]
    (path,) = displaced_paths(result, mode, drawn, np.linspace(0, 2 * np.pi, 9))
    ((_, top),) = drawn[0].markers
    places = placed(drawn[0], path)
    assert places[:, top] == pytest.approx(np.tile([0.1, 0.2, 0.3], (9, 1)), abs=1e-9)
    heights = places[:, 8, 2]  # of the centre of mass, which is lowest at rest
    assert heights[2] == pytest.approx(-0.2, abs=1e-9) and min(heights[0], heights[4]) > -0.2 + 1e-3
    picture, page = modes_picture(result, 2), modes_page(result, 2)
    assert label in picture and picture.count('<path class="there"') == 2 and '"name":"hook"' in page and label in page


@pytest.mark.parametrize("keep", ["", "keep_coordinates = true"], ids=["minimal", "constrained"])
def test_a_body_that_hangs_on_a_ball_joint(keep: str) -> None:
    """omega^2 = m g s / J of the two horizontal axes through the joint; it may turn about the vertical."""
    found = 2 * np.pi * modes(parse(HANGING.replace("KEEP", keep))).frequencies
    moment = 2 * 9.81 * 0.5
    expected = np.sort(np.sqrt(moment / (np.array([0.3, 0.2]) + 2 * 0.25)))
    assert np.sort(found[found > 1e-3]) == pytest.approx(expected, rel=1e-8)
    assert len(found) <= 3


@pytest.mark.parametrize(
    "keep", [pytest.param(False, id="minimal"), pytest.param(True, id="constrained", marks=pytest.mark.long)]
)
def test_double_pendulum_with_a_turned_hinge(keep: bool) -> None:
    found = 2 * np.pi * modes(parse(turned_double_pendulum_scene(0.0, 0.0, keep=keep))).frequencies
    assert np.sort(found) == pytest.approx(model_frequencies(turned_double_pendulum(), [0, 0]), rel=1e-7)
