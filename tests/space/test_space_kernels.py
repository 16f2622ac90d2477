"""Generated code of spatial scenes against the oracle of material points, in random scenes and states."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from random_scenes import random_scene
from space_kernels import BEAM_SEEDS, COMPLETE_SEED, FURTHER_SEEDS, LONG_SEEDS, QUICK_SEEDS, disagreements, space_model

from conftest import random_cases
from derive.errors import SpecError


@pytest.mark.parametrize("seed", [QUICK_SEEDS[0], pytest.param(QUICK_SEEDS[1], marks=pytest.mark.long)])
def test_random_scenes(seed: int, tmp_path: Path) -> None:
    model = space_model(random_scene(seed, tmp_path), complete=False)
    assert disagreements(model, seed) == []


@pytest.mark.parametrize("seed", [COMPLETE_SEED, *random_cases(LONG_SEEDS[0], len(LONG_SEEDS), len(FURTHER_SEEDS))])
def test_random_scenes_with_all_kernels(seed: int, tmp_path: Path) -> None:
    """The C and the Python, of the further scenes one of three. Those whose drives contradict joints are refused."""
    try:
        model = space_model(random_scene(seed, tmp_path), complete=seed not in FURTHER_SEEDS or seed % 3 == 0)
    except SpecError as error:
        assert "all motion is prescribed" in str(error) or "the motion of both bodies is prescribed" in str(error)
        return
    assert disagreements(model, seed) == []
    assert disagreements(model, seed + 1000) == []


@pytest.mark.parametrize("seed", random_cases(BEAM_SEEDS[0], 6, len(BEAM_SEEDS) - 6))
def test_random_scenes_with_beams(seed: int, tmp_path: Path) -> None:
    """Beams of both orders, in all frames and with all joints, are sums over points of their sections."""
    try:
        model = space_model(random_scene(seed, tmp_path), complete=seed % 5 == 0)
    except SpecError as error:
        assert "all motion is prescribed" in str(error) or "the motion of both bodies is prescribed" in str(error)
        return
    assert disagreements(model, seed) == []


CARRIED = """
name = "carried"
[scene]
gravity = [1, 2, -9]
[ground.markers]
base = { at = [0.1, -0.2, 0.3], rotation = { axis = [1, 2, 3], angle = 0.7 } }
[bodies.arm]
markers.root = { at = [0.3, 0.1, 0], rotation = { axis = [0, 1, 1], angle = -0.4 } }
markers.tip = { at = [-0.5, 0.2, 0.4], rotation = { angles = [0.3, 0.5, -0.2], sequence = "zyx" } }
[bodies.bob]
mass = 2
centre = [0.1, -0.1, 0.3]
inertia = [0.3, 0.4, 0.5, 0.05, -0.02, 0.01]
markers.top = { at = [0.2, 0, -0.3], rotation = { axis = [2, -1, 1], angle = 1.1 } }
[joints.bearing]
kind = "revolute"
between = ["ground.base", "arm.root"]
[joints.cross]
kind = "KIND"
between = ["ENDS"]
[drives.motor]
joint = "bearing"
motion = "0.3 + 2*t + sin(3*t)"
[simulation]
duration = 1
output = 1
"""


@pytest.mark.parametrize(
    "ends",
    [
        pytest.param('arm.tip", "bob.top', id="second"),
        pytest.param('bob.top", "arm.tip', id="first", marks=pytest.mark.long),
    ],
)
@pytest.mark.parametrize("kind", ["universal", "cylindrical"])
def test_a_body_on_a_body_that_a_drive_carries(kind: str, ends: str, tmp_path: Path) -> None:
    """It keeps the angles of its joint, in a frame that turns with the drive; displacements there are constraints."""
    path = tmp_path / "scene.toml"
    path.write_text(CARRIED.replace("KIND", kind).replace("ENDS", ends))
    model = space_model(path, complete=False)
    assert (model.native.nv, model.native.nlambda) == ((2, 0) if kind == "universal" else (6, 4))
    assert disagreements(model, 1) == [] and disagreements(model, 2) == []


@pytest.mark.long
def test_dense_bodies_of_one_file(tmp_path: Path) -> None:
    """Five modes whose integrals do not vanish: their sums are rows of a table that both bodies read."""
    rng = np.random.default_rng(3)
    np.savez(
        tmp_path / "cloud.npz",
        positions=rng.uniform(-0.3, 0.3, (8, 3)),
        mass=rng.uniform(0.5, 1.5, 8),
        modes=rng.uniform(-1, 1, (5, 8, 3)),
        modal_stiffness=np.diag(rng.uniform(50, 100, 5)),
    )
    keys = 'nodes = "cloud.npz"\nunits = "SI"\nframe = "given"\northonormal = false\n'
    body = f"[bodies.{{}}]\n{keys}markers = {{{{ left = 0, right = 7 }}}}\n"
    joint = '[joints.ball]\nkind = "spherical"\nbetween = ["one.right", "two.left"]\n'
    head = 'name = "dense"\n[scene]\ngravity = [1, 2, -9]\n'
    path = tmp_path / "dense.toml"
    path.write_text(head + body.format("one") + body.format("two") + joint)
    model = space_model(path, complete=False)
    assert disagreements(model, 1) == []
