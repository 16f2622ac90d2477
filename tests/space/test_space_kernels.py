"""Generated code of spatial scenes against the oracle of material points, in random scenes and states."""

from __future__ import annotations

from pathlib import Path

import pytest
from random_scenes import KINDS, random_scene
from space_kernels import disagreements, space_model
from written_scene import tables

FEW = (1, 8, 14, 24)
"""Scenes with all kinds of joints, drives, and flexible bodies."""


@pytest.mark.parametrize("seed", FEW)
def test_random_scenes(seed: int, tmp_path: Path) -> None:
    model = space_model(random_scene(seed, tmp_path), complete=False)
    assert disagreements(model, seed) == []
    assert disagreements(model, seed + 1000) == []


def test_they_have_all_kinds_of_joints(tmp_path: Path) -> None:
    scenes = [tables(random_scene(seed, tmp_path)) for seed in FEW]
    assert {joint["kind"] for scene in scenes for joint in scene["joints"].values()} >= {*KINDS} - {"fixed"}
    assert any("drives" in scene for scene in scenes)
    assert any("nodes" in body for scene in scenes for body in scene["bodies"].values())


@pytest.mark.parametrize("seed", [7, *(pytest.param(seed, marks=pytest.mark.long) for seed in range(100, 200))])
def test_random_scenes_with_all_kernels(seed: int, tmp_path: Path) -> None:
    """The C and the Python."""
    model = space_model(random_scene(seed, tmp_path))
    assert disagreements(model, seed) == []
    assert disagreements(model, seed + 1000) == []
