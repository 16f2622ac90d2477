"""Joints in minimal coordinates and as constraints, springs with a potential, drives and reactions in space."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from arm_and_bob import ARM, BOB

from derive.simulation.observables.default_plots import default_plots
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.space.marker_frames import own_frame
from derive.simulation.trajectory import Trajectory
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.toml.read import parse

SCENE = (
    f'name = "space_loads"\n{ARM}[bodies.free]\n{BOB}'
    + """[joints.first]
BETWEEN
[joints.ball]
kind = "spherical"
between = ["arm.end", "free.m"]
[springs.pull]
between = ["ground.wall", "free.n"]
stiffness = 20
rest = 0.2
[outputs.E]
kind = "energy"
[outputs.R]
kind = "reaction"
joint = "first"
[outputs.tip]
kind = "position"
marker = "free.n"
[simulation]
duration = 0.2
output = 0.01
tolerance = 1e-10
"""
)
ROTATIONAL = """
[springs.mount]
kind = "bushing"
between = ["ground.wall", "arm.end"]
stiffness = [3, 2, 4, 0.1, 0.2, 0.3]
[springs.turn]
kind = "rotational"
between = ["arm.hub", "free.m"]
stiffness = 0.05
"""
"""Springs of which half the terms of a model would be."""
KINDS = {"universal": 2, "planar": 3}
"""The joints, with the coordinates that they leave a body."""


@cache
def run(kind: str, keep: bool = False, swapped: bool = False, more: str = "") -> Trajectory:
    ends = '["arm.hub", "ground.o"]' if swapped else '["ground.o", "arm.hub"]'
    text = SCENE.replace("BETWEEN", f'kind = "{kind}"\nbetween = {ends}')
    if keep:
        text = text.replace("mass = 1.2", "mass = 1.2\nkeep_coordinates = true")
    if more:
        text = text.replace("[outputs.E]", f"{more}\n[outputs.E]")
    return PreparedRun(parse(text), complete=False).trajectory()


@pytest.mark.parametrize("kind", [pytest.param("universal", marks=pytest.mark.long), "planar"])
def test_minimal_coordinates_and_constraints_are_one_motion(kind: str) -> None:
    minimal, kept = run(kind), run(kind, keep=True)
    assert minimal.motion.native.nlambda == 0
    assert minimal.motion.native.nv == KINDS[kind] + 3
    assert kept.motion.native.nv == 12
    for name in ("tip_1", "tip_2", "tip_3", "R_1", "R_2", "R_3", "R_torque1", "R_torque2", "R_torque3"):
        size = max(1.0, np.abs(kept[name]).max())
        assert minimal[name] == pytest.approx(kept[name], abs=1e-6 * size), name


def test_a_joint_whose_bodies_are_swapped_keeps_coordinates_as_well() -> None:
    swapped, kept = run("universal", swapped=True), run("universal", keep=True, swapped=True)
    assert swapped.motion.native.nv == KINDS["universal"] + 3
    assert swapped["tip_3"] == pytest.approx(kept["tip_3"], abs=1e-7)


@pytest.mark.long
@pytest.mark.parametrize("kind", ["universal", pytest.param("planar", marks=pytest.mark.long)])
def test_springs_and_bushings_conserve_energy(kind: str) -> None:
    trajectory = run(kind, more=ROTATIONAL)
    assert np.ptp(trajectory["E_strain"]) > 1e-3
    assert np.ptp(trajectory["E_total"]) < 1e-7 * np.ptp(trajectory["E_kinetic"])


def test_free_motions_of_a_joint_have_no_reaction() -> None:
    # planar: no force along x and y and no torque about z of the marker of the ground
    trajectory = run("planar")
    axes = own_frame(trajectory.scene.ground[0]).axes
    force = np.column_stack([trajectory[f"R_{k}"] for k in (1, 2, 3)]) @ axes
    torque = np.column_stack([trajectory[f"R_torque{k}"] for k in (1, 2, 3)]) @ axes
    assert np.abs(force[:, :2]).max() < 1e-11
    assert np.abs(torque[:, 2]).max() < 1e-11
    assert np.abs(force[:, 2]).max() > 1.0


def test_plots_leave_out_torques_of_what_exerts_none() -> None:
    more = '[outputs.%s]\nkind = "%s"\n%s = "%s"\n'
    lines = [("S", "spring", "spring", "pull"), ("B", "reaction", "joint", "ball")]
    text = SCENE.replace("BETWEEN", 'kind = "planar"\nbetween = ["ground.o", "arm.hub"]')
    scene = parse(text.replace("[simulation]", "".join(more % line for line in lines) + "[simulation]"))
    assert isinstance(scene, SpatialScene)
    plots = {plot.name: plot.quantity.y for plot in default_plots(scene, run("planar").model)}
    assert plots["S"] == ("S_1", "S_2", "S_3") and plots["B"] == ("B_1", "B_2", "B_3")
    assert plots["R"] == ("R_1", "R_2", "R_3", "R_torque1", "R_torque2", "R_torque3")


@pytest.mark.parametrize("keep", [False, True])
def test_drives_prescribe_rotations(keep: bool) -> None:
    more = '[drives.motor]\njoint = "first"\nmotion = "0.3*sin(4*t)"\n[outputs.turn]\nkind = "joint"\njoint = "first"'
    trajectory = run("revolute", keep=keep, more=more)
    assert trajectory["turn"] == pytest.approx(0.3 * np.sin(4 * trajectory.t), abs=1e-10)


def test_a_spring_along_a_guide_pulls_by_its_length() -> None:
    # the length is the root of one square, which has a kink where the ends coincide
    text = """
name = "buffer"
[scene]
gravity = [0, 0, 0]
[ground.markers]
rail = { at = [0.1, 0, 0], rotation = { z = [3, 0, 4], x = [0, 1, 0] } }
[bodies.carriage]
mass = 2
inertia = [1e-3, 1e-3, 1e-3, 0, 0, 0]
markers.m = { at = [0, 0, 0], rotation = { z = [3, 0, 4], x = [0, 1, 0] } }
[joints.guide]
kind = "prismatic"
between = ["ground.rail", "carriage.m"]
start = { displacement = -0.5, speed = 0 }
[springs.buffer]
between = ["ground.rail", "carriage.m"]
stiffness = 50
rest = 0.4
[outputs.length]
kind = "distance"
between = ["ground.rail", "carriage.m"]
[simulation]
duration = 1
output = 0.05
"""
    trajectory = PreparedRun(parse(text), complete=False).trajectory()
    assert trajectory["length"] == pytest.approx(0.4 + 0.1 * np.cos(5 * trajectory.t), abs=1e-8)
