"""The texts of an arm in space with markers on the ground, and of a bob at its end, for scenes of several tests."""

from __future__ import annotations

ARM = """[scene]
gravity = [0.3, 0, -9.81]
[ground.markers]
o = { at = [0.1, 0, 0], rotation = { angles = [0.2, 0.5, -0.1], sequence = "xyz" } }
wall = { at = [0.5, 0.2, 0.1], rotation = { axis = [1, 1, 0], angle = 0.3 } }
[bodies.arm]
mass = 1.2
centre = [0.2, 0.01, 0]
inertia = [1e-3, 4e-3, 4e-3, 1e-4, 0, 2e-4]
markers = { hub = { at = [0, 0.02, 0], rotation = { angles = [0.4, 0, 0.3], sequence = "zxz" } }, end = [0.4, 0, 0] }
"""
BOB = """mass = 0.5
centre = [0.01, 0.02, 0.03]
inertia = [1e-3, 2e-3, 2.5e-3, 1e-4, 0, -2e-4]
markers = { m = [0.1, 0, 0], n = [-0.1, 0.05, 0] }
"""
