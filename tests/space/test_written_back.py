"""Scenes in space with changed settings: they are written as tables and read again, and stay the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from random_scenes import random_scene

import derive
from derive.generated_models import fingerprint


@pytest.mark.parametrize("seed", [1, 8, 14])
def test_a_scene_stays_the_same(seed: int, tmp_path: Path) -> None:
    """Rigid and flexible bodies, with marker frames at points, nodes and sets of nodes."""
    spec = derive.read(random_scene(seed, tmp_path))
    again = derive.validated(replace(spec, plots=()))
    assert fingerprint(again) == fingerprint(spec)
    for body, other in zip(spec.bodies, again.bodies, strict=True):
        assert body.markers == other.markers and body.start == other.start
