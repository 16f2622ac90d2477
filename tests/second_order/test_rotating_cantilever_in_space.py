"""A finite-element cantilever on a driven hub in space: its steady rotation stiffens it, in flap and in lag.

The body has shapes of a beam at nodes in the points of Gauss's rule, so that sums over nodes are integrals, and the
geometric stiffness of its shortening. Frequencies are those of an inextensible beam, which are known.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import derive
from derive.generated_models import generated
from derive.simulation.linear.eigenmodes import eigenmodes
from derive.simulation.linear.linearisation import linearise
from derive.simulation.scene_start import state_of
from derive.spec.model.spatial_scene import SpatialScene

KNOWN = json.loads((Path(__file__).parent / "rotating_cantilever.json").read_text())["inextensible"]
SHAPES, POINTS, SIDE = 3, 6, 1e-4
"""Polynomials x^2 to x^4 in each plane, points of Gauss's rule, and half of the side of a section (m)."""
SCENE = """
name = "cantilever_in_space"
[scene]
start = "steady"
[ground.markers]
axis = [0, 0, 0]
[bodies.hub]
markers = { foot = [0, 0, 0] }
[bodies.beam]
nodes = "beam.npz"
units = "SI"
frame = "given"
orthonormal = false
order = 2
markers = { root = { nodes = [0, 1, 2, 3] } }
start = { position = [0, 0, 0], rotation = [1, 0, 0, 0] }
[joints.shaft]
kind = "revolute"
between = ["ground.axis", "hub.foot"]
[joints.clamp]
kind = "fixed"
between = ["hub.foot", "beam.root"]
[drives.motor]
joint = "shaft"
speed = { symbol = "mu", unit = "rad/s", default = 2 }
"""


def beam(path: Path) -> None:
    """Write a beam of unit length, mass and stiffness along x, clamped at x = 0; lag is along y, flap along z."""
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    x, weights = np.concatenate([[0.0], (nodes + 1) / 2]), np.concatenate([[0.0], weights / 2])
    corners = SIDE * np.array([(1, 1), (1, -1), (-1, -1), (-1, 1)])
    positions = np.array([(xi, y, z) for xi in x for y, z in corners])
    mass = np.repeat(weights, len(corners)) / len(corners)
    along = positions[:, 0]
    powers = np.arange(2, SHAPES + 2)
    modes = np.zeros((2 * SHAPES, len(positions), 3))
    psi = np.zeros((2 * SHAPES, 2 * SHAPES, len(positions), 3))
    stiffness = np.zeros((2 * SHAPES, 2 * SHAPES))
    for plane, axis in enumerate((1, 2)):
        own = slice(plane * SHAPES, (plane + 1) * SHAPES)
        modes[own, :, axis] = along ** powers[:, None]
        modes[own, :, 0] = -positions[:, axis] * powers[:, None] * along ** (powers[:, None] - 1)
        for i, m in enumerate(powers):
            for j, n in enumerate(powers):
                at = plane * SHAPES + i, plane * SHAPES + j
                psi[at][:, 0] = -m * n * along ** (m + n - 1) / (m + n - 1)
                stiffness[at] = m * (m - 1) * n * (n - 1) / (m + n - 3)
    axes = np.eye(3)

    def centrifugal(a: int, b: int) -> np.ndarray:
        both = np.cross(axes[a], np.cross(axes[b], positions)) + np.cross(axes[b], np.cross(axes[a], positions))
        return both / 2 if a == b else both

    def work(loads: list[np.ndarray]) -> np.ndarray:
        return np.array([np.einsum("a,ijak,ak->ij", mass, psi, np.broadcast_to(f, positions.shape)) for f in loads])

    np.savez(
        path,
        positions=positions,
        mass=mass,
        modes=modes,
        modal_stiffness=stiffness,
        K0t=work([*axes]),
        K0r=work([np.cross(axis, positions) for axis in axes]),
        K0omega=work([centrifugal(a, b) for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))]),
        K0F=-np.moveaxis(psi, (0, 1), (2, 3)),
        K0F_nodes=np.arange(len(positions)),
    )


@pytest.mark.long
def test_a_cantilever_stiffens_in_flap_and_in_lag(tmp_path: Path) -> None:
    """Without Southwell's terms flap stays at 3.516 sqrt(EI/(m l^3)), and lag is lost at that speed."""
    beam(tmp_path / "beam.npz")
    (tmp_path / "scene.toml").write_text(SCENE)
    scene = derive.read(tmp_path / "scene.toml")
    assert isinstance(scene, SpatialScene)
    native = derive.load_scene(generated(scene)[1], ("-O1",))
    for mu, limit in ((2, 1e-4), (6, 5e-3)):
        k = native.setup([mu])
        steady = state_of(scene, native, k).steady
        assert steady is not None and steady.spin == pytest.approx(mu)
        linear = linearise(native, k, 0.0, steady.q, steady.v, steady.axes)
        lag, flap = np.sort([2 * np.pi * mode.frequency for mode in eigenmodes(linear)])[:2]
        number = KNOWN["mu"].index(mu)
        assert [lag, flap] == pytest.approx([KNOWN["chordwise"][number], KNOWN["flapwise"][number]], rel=limit)
