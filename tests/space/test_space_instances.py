"""Scenes in space whose bodies, joints and outputs are instances of tables with `count`: they start as it is given."""

from __future__ import annotations

import numpy as np
import pytest

from derive.simulation.prepared_run import PreparedRun
from derive.spec.toml.read import parse

SCENE = """
name = "counted_links"
[scene]
coordinates = "absolute"
[bodies.link]
count = 2
mass = 1
centre = [0.5, 0, 0]
inertia = [0.01, 0.09, 0.09, 0, 0, 0]
[bodies.link.markers]
a = { at = [0, 0, 0], rotation = { z = [0, 1, 0], x = [1, 0, 0] } }
b = { at = [1, 0, 0], rotation = { z = [0, 1, 0], x = [1, 0, 0] } }
[bodies.link.start]
guess = true
position = ["i", 0, 0]
rotation = { axis = [0, 1, 0], angle = "0.2*i" }
[joints.hinge]
count = 1
kind = "revolute"
between = ["link[i].b", "link[i+1].a"]
start = { angle = "0.2*(i + 1)", speed = 1 }
[outputs.turn]
count = 1
kind = "joint"
joint = "hinge[i]"
[simulation]
duration = 1e-3
output = 1e-3
"""


def test_instances_start_as_their_tables_say() -> None:
    """Coordinates and joints of instances are found by their names for people, in which the index is in brackets."""
    run = PreparedRun(parse(SCENE), complete=False).trajectory()
    assert run["turn[0]"][0] == pytest.approx(0.2, abs=1e-12)
    assert run["link[1]_omega2"][0] - run["link[0]_omega2"][0] == pytest.approx(1.0, abs=1e-12)
    quaternions = [[run[f"link[{i}]_e{k}"][0] for k in range(4)] for i in (0, 1)]
    assert np.linalg.norm(quaternions, axis=1) == pytest.approx([1.0, 1.0], abs=1e-14)
