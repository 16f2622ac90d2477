"""Generated code of spatial scenes against the oracle of material points, in random scenes and states."""

from __future__ import annotations

from pathlib import Path

import pytest
from random_scenes import random_scene
from space_kernels import disagreements, space_model

FEW = range(12)


@pytest.mark.parametrize("seed", [*FEW, *(pytest.param(seed, marks=pytest.mark.long) for seed in range(12, 112))])
def test_random_scenes(seed: int, tmp_path: Path) -> None:
    model = space_model(random_scene(seed, tmp_path))
    assert disagreements(model, seed) == []
    assert disagreements(model, seed + 1000) == []
