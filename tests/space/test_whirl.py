"""A rotor: a flexible shaft in two bearings, with a disk in its middle, whirls as the closed form says.

The shaft deflects in its two lowest sines, in both planes. In the first one the disk moves sideways, and the rotation W
has no influence. In the second one it tilts: with its amplitude q (complex, y + i z, in inertial axes)

    (m + A) q'' - i C W q' + k q = 0

where m is the modal mass of the shaft, whose sections are nearly points, and A and C are the moments of inertia of the
disk across and along the shaft, times the square of the slope. Forward whirl is fast, backward whirl slow.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import derive

LENGTH, SHAFT_MASS, SIDE, STIFFNESS = 1.0, 2.0, 0.02, 200.0
"""m, kg, half of the side of a section (m), and the bending stiffness (N m^2)."""
CORNER = 2e-4
"""The share of the mass of a section at a corner, which makes it a little more than a point."""
DISK_MASS, DISK_ACROSS, DISK_ALONG = 5.0, 0.05, 0.09
SPIN, TILTING, MOVING = 150.0, 0.1, 0.01
"""The rotation (rad/s), the rate at which the disk begins to tilt (rad/s), and its velocity sideways (m/s)."""
SECTIONS, CORNERS = 9, ((1, 1), (1, -1), (-1, -1), (-1, 1))
WAVES = np.pi * np.array([1, 2]) / LENGTH


def shaft(path: Path) -> None:
    """Write the nodes: a section has one on the axis and four corners; the ends are half sections."""
    x = np.linspace(0, LENGTH, SECTIONS)
    across = SIDE * np.array([(0, 0), *CORNERS])
    positions = np.array([(xi, y, z) for xi in x for y, z in across])
    weights = np.full(SECTIONS, SHAFT_MASS / (SECTIONS - 1))
    weights[[0, -1]] /= 2
    mass = np.concatenate([w * np.array([1 - 4 * CORNER, *[CORNER] * 4]) for w in weights])
    modes = np.zeros((4, len(positions), 3))
    for i, wave in enumerate(WAVES):
        for j, axis in enumerate((1, 2)):
            modes[2 * i + j, :, axis] = np.sin(wave * positions[:, 0])
            modes[2 * i + j, :, 0] = -positions[:, axis] * wave * np.cos(wave * positions[:, 0])
    stiffness = np.diag(np.repeat(STIFFNESS * WAVES**4 * LENGTH / 2, 2))
    index = np.arange(len(positions))
    np.savez(
        path,
        positions=positions,
        mass_row=index,
        mass_col=index,
        mass_value=mass,
        modes=modes,
        modal_stiffness=stiffness,
    )


def section(i: int) -> str:
    """The corners of a section as a marker."""
    return f"{{ nodes = {[5 * i + k for k in range(1, 5)]} }}"


SCENE = f"""
name = "rotor"
[ground.markers]
left = [0, 0, 0]
right = {{ at = [{LENGTH}, 0, 0], rotation = {{ z = [1, 0, 0], x = [0, 1, 0] }} }}
[bodies.shaft]
nodes = "shaft.npz"
units = "SI"
modes = 4
markers = {{ left = {section(0)}, middle = {section(4)}, right = {section(8)} }}
start = {{ position = [{LENGTH / 2}, 0, 0], rotation = [1, 0, 0, 0], amplitudes = [0, 0, 0, 0] }}
[bodies.disk]
mass = {DISK_MASS}
inertia = [{DISK_ALONG}, {DISK_ACROSS}, {DISK_ACROSS}, 0, 0, 0]
markers = {{ hub = [0, 0, 0] }}
[bodies.disk.start]
position = [{LENGTH / 2}, 0, 0]
rotation = [1, 0, 0, 0]
velocity = [0, 0, {MOVING}]
angular_velocity = [{SPIN}, 0, {TILTING}]
[joints.ball]
kind = "spherical"
between = ["ground.left", "shaft.left"]
[joints.sleeve]
kind = "point_on_line"
between = ["ground.right", "shaft.right"]
[joints.fit]
kind = "fixed"
between = ["shaft.middle", "disk.hub"]
[simulation]
duration = 0.06
output = 0.006
tolerance = 1e-11
"""


def whirl(spin: float) -> tuple[float, float]:
    """The frequencies (rad/s) of forward and backward whirl of the tilting disk in the inertial frame."""
    A, C, k = (x * WAVES[1] ** 2 for x in (DISK_ACROSS, DISK_ALONG, STIFFNESS * WAVES[1] ** 2 * LENGTH / 2))
    backward, forward = sorted(np.roots([SHAFT_MASS / 2 + A, -C * spin, -k]))
    return float(forward), float(backward)


def test_the_whirl_of_a_rotor(tmp_path: Path) -> None:
    shaft(tmp_path / "shaft.npz")
    (tmp_path / "rotor.toml").write_text(SCENE)
    found = derive.simulate(derive.read(tmp_path / "rotor.toml"))
    e0, e1, e2, e3 = (found[f"disk_e{i}"] for i in range(4))
    tilt = 2 * (e1 * e2 + e0 * e3) + 2j * (e1 * e3 - e0 * e2)  # the axis of the disk, along y and z
    forward, backward = whirl(SPIN)
    assert forward > 300 and backward < -150  # far from the frequency without rotation, either way
    waves = np.exp(1j * forward * found.t) - np.exp(1j * backward * found.t)
    expected = TILTING * waves / (1j * (forward - backward))
    frequency = np.sqrt(STIFFNESS * WAVES[0] ** 4 * LENGTH / 2 / (SHAFT_MASS / 2 + DISK_MASS))
    moved, sideways = MOVING / frequency * np.sin(frequency * found.t), found["disk_c2"] + 1j * found["disk_c3"]
    assert np.abs(tilt - expected).max() < 3e-5 * np.abs(expected).max()
    assert np.abs(sideways - 1j * moved).max() < 3e-5 * np.abs(moved).max()
