"""Scenes of the corpus whose loops over instances were wrong once."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import derive
from corpus.generator import corpus_scene
from derive.backends.python.backend import PythonBackend

SEEDS = {
    65: "the energy of a body with a drive of constant speed, which is known but does not depend on the time",
    67: "a loop over forces that act on no coordinate",
    75: "a force between known motions whose name, F, is that of the argument of a function",
}


@pytest.mark.parametrize("seed", SEEDS)
def test_loops_are_valid_python(seed: int, tmp_path: Path) -> None:
    spec = derive.read(corpus_scene(seed).write(tmp_path))
    assert isinstance(spec, derive.Scene)
    model = derive.lower(derive.derive(replace(spec, lowering="instances")))
    assert model.lowering == "instances"
    for file in PythonBackend().files(model, ""):
        compile(file.text, file.path, "exec")
