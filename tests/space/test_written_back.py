"""Scenes in space with changed settings: they are written as tables and read again, and stay the same."""

from __future__ import annotations

import inspect
from dataclasses import fields, replace
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


def test_the_constructor_has_the_keys_of_a_scene_in_space() -> None:
    """Its parameters are the sections and the keys of [scene] that `SpatialScene` declares, and what functions call."""
    declared = {field.name for field in fields(derive.SpatialScene)}
    assert set(inspect.signature(derive.spatial_scene).parameters) == {*declared, "parameters", "tables"}


def test_a_planar_scene_is_none_in_space() -> None:
    body = {"mass": 1, "inertia": 1, "markers": {"a": [0, 0]}}
    with pytest.raises(TypeError, match="a Scene, not a SpatialScene"):
        derive.spatial_scene("flat", bodies={"one": body})
