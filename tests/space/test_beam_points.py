"""Beams in space in mechanisms: markers at their middle against points of their sections, and energy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from space_kernels import disagreements, space_model

from derive.errors import SpecError
from derive.simulation.prepared_run import PreparedRun
from derive.spec.toml.read import parse

MIDDLE = """
name = "held_in_its_middle"
[ground.markers]
base = [0.1, -0.2, 0.3]
[bodies.rod]
length = 1.5
mass = 2
bending_stiffness = 30
rotary_inertia = 0.02
KEYS
markers.middle = { at = 0, rotation = { axis = [2, -1, 1], angle = 1.1 } }
[torques.push]
on = "rod.middle"
torque = [1, 2, 3]
[joints.hold]
kind = "revolute"
between = ["ground.base", "rod.middle"]
[simulation]
duration = 1
output = 1
"""
POINT = 'frame = "point"\nansatz = ["1", "xi", "xi^2"]'
"""The marker is at the origin of the frame and does not move in it."""
EVEN = 'order = 2\nansatz = ["1", "xi^2", "xi^4"]'
"""The section in the middle turns at second order alone."""


@pytest.mark.parametrize("keys", [POINT, pytest.param(EVEN, marks=pytest.mark.long)], ids=["point", "even"])
def test_a_marker_in_the_middle(keys: str, tmp_path: Path) -> None:
    """Nothing of a marker there is lost, and nothing that vanishes is named."""
    path = tmp_path / "scene.toml"
    path.write_text(MIDDLE.replace("KEYS", keys))
    assert disagreements(space_model(path, complete=False), 1) == []


PENDULUM = """
name = "beam_pendulum"
[scene]
gravity = [1, -7, -7]
[ground.markers]
o = [0, 0, 0]
[bodies.rod]
length = 1
mass = 0.5
bending_stiffness = 200
lateral = { bending_stiffness = 80 }
rotary_inertia = 1e-3
torsion = { ansatz = ["xi"], stiffness = 100 }
frame = { kind = "tangent", at = -1 }
order = 2
markers = { left = -1, right = 1 }
[bodies.rod.start]
position = [0.5, 0, 0]
[bodies.tip]
mass = 0.2
inertia = [1e-3, 2e-3, 1.5e-3, 0, 0, 0]
markers = { o = [0, 0.03, 0.02] }
[joints.cross]
kind = "universal"
between = ["ground.o", "rod.left"]
[joints.weld]
kind = "fixed"
between = ["rod.right", "tip.o"]
[simulation]
duration = 0.3
output = 0.02
tolerance = 1e-11
"""


@pytest.mark.long
def test_energy_is_conserved() -> None:
    """A beam that bends in both planes and twists, on a universal joint, with a mass at its tip off its axis."""
    motion = PreparedRun(parse(PENDULUM), complete=False).trajectory().motion
    energies = np.array([motion.native.energy(q, v, motion.k) for q, v in zip(motion.q, motion.v, strict=True)])
    exchanged, total = np.ptp(energies[:, 0]), energies.sum(axis=1)
    assert exchanged > 0.5 and np.ptp(energies[:, 1]) > 1e-3
    assert np.ptp(total) < 1e-8 * exchanged
    names = list(motion.native.coordinates)
    for i in range(1, 6):  # along e2 and e3, and twisting
        assert np.ptp(motion.q[:, names.index(f"rod_alpha{i}")]) > 1e-6


def test_every_ansatz_is_checked_where_it_is_written() -> None:
    """Shapes along e3, of torsion and along the axis that do not fit the frame are faults, all at once."""
    wrong = 'frame = "point"\nlateral = { ansatz = ["1", "xi"] }\ntorsion = { ansatz = ["1"], stiffness = 3 }\n'
    with pytest.raises(SpecError) as faults:
        parse(MIDDLE.replace("KEYS", wrong + 'axial = { ansatz = ["xi", "2*xi"], stiffness = 3 }'))
    for key in ("lateral.ansatz", "torsion.ansatz", "axial.ansatz"):
        assert f"bodies.rod.{key}: " in str(faults.value)
