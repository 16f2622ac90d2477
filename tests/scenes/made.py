"""Scenes through all stages, each once a session, and random states of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import zoo

import derive
from beams import run_module
from derive.native import NativeScene, load_scene
from derive.spec import parse
from derive.spec.scene import Scene

FLAGS = ("-std=c99", "-O0", "-ffp-contract=off")
SCENES = Path(__file__).parent.parent.parent / "scenes"


@dataclass(frozen=True, eq=False)
class Made:
    """A scene, its model, the compiled C, and the names of the generated Python."""

    spec: Scene
    model: derive.Model
    native: NativeScene
    python: dict[str, Any]


def make(spec: Scene) -> Made:
    """All stages."""
    model = derive.lower(derive.derive(spec))
    files = derive.model_files(model, spec)
    return Made(spec, model, load_scene(files, FLAGS), run_module(files))


@cache
def in_zoo(name: str) -> Made:
    """A scene of the zoo."""
    return make(parse(getattr(zoo, name)))


def scene(text: str) -> Scene:
    """A scene in TOML."""
    found = parse(text)
    assert isinstance(found, Scene)
    return found


def state(native: NativeScene, seed: int) -> tuple[float, np.ndarray, np.ndarray]:
    """t, q, v: everywhere, bent by a tenth of the lengths, and far from meeting the constraints."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2, 2, native.nq)
    bent = np.array(["alpha" in name for name in native.coordinates])
    q[bent] *= 0.05
    return rng.uniform(0.2, 1.5), q, rng.uniform(-3, 3, native.nv)


def parameters(native: NativeScene, seed: int) -> np.ndarray:
    """Parameters near their defaults, but not there."""
    return native.defaults * np.random.default_rng(seed).uniform(0.8, 1.25, native.np)
