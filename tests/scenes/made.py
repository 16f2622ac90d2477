"""Scenes through all stages, each once a session, random states of them, and their motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import zoo

import derive
from beams import run_module
from conftest import QUICK, ROOT
from derive.artifacts import File
from derive.generated_models import generated, generated_explicit
from derive.ir.model import Model
from derive.runtime.compiler import ESSENTIAL
from derive.runtime.interpreted_scene import with_iteration_matrix
from derive.runtime.loading import load_scene
from derive.runtime.native_scene import NativeScene
from derive.simulation.initial.initial_state import InitialState, initial_state
from derive.simulation.integration.scipy_methods import integrate
from derive.simulation.integration.solution import Solution
from derive.simulation.observables.marker_positions import deflection
from derive.simulation.observables.motion import SceneMotion
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse


@dataclass(frozen=True, eq=False)
class Made:
    """A scene, its model, the compiled C, and the text of the generated Python."""

    spec: Scene
    model: derive.Model
    native: NativeScene
    files: tuple[derive.File, ...]

    @property
    def python(self) -> dict[str, Any]:
        """The names of the generated Python."""
        return run_module(self.files)

    def start(self, p: np.ndarray | None = None) -> tuple[np.ndarray, InitialState]:
        """k and the consistent start."""
        k = self.native.setup(p)
        return k, initial_state(self.spec, self.native, k)

    def run(self, times: np.ndarray, p: np.ndarray | None = None, tolerance: float = 1e-9) -> Solution:
        """The motion from the start of the specification."""
        k, start = self.start(p)
        return integrate(self.native, k, start.q, start.v, times, tolerance=tolerance)

    def bent(self, found: Solution, plot: str, p: np.ndarray | None = None) -> np.ndarray:
        """The deflection that a plot of the scene shows of a motion."""
        quantity = next(one.quantity for one in self.spec.plots if one.name == plot)
        motion = SceneMotion(self.spec, self.native, self.native.setup(p), found.t, found.q, found.v)
        return deflection(motion, quantity)


def make(spec: Any, complete: bool = False) -> Made:
    """All stages, through the cache that the workers share.

    complete: with all functions and the Python, which takes twice the time.
    """
    assert isinstance(spec, Scene)
    model, files = generated(spec) if complete else generated_explicit(spec)
    return Made(spec, model, _loaded(model, files, complete), files)


def _loaded(model: Model, files: tuple[File, ...], complete: bool) -> NativeScene:
    return with_iteration_matrix(load_scene(files, QUICK if complete else (*QUICK, *ESSENTIAL)), model)


@cache
def in_zoo(name: str) -> Made:
    """A scene of the zoo, complete."""
    return make(parse(getattr(zoo, name)), complete=True)


def text_of(name: str) -> str:
    """The text of one of `scenes/`."""
    return (ROOT / "scenes" / f"{name}.toml").read_text()


@cache
def of(name: str, change: Callable[[str], str] = str, complete: bool = False) -> Made:
    """One of `scenes/`, its text changed."""
    return make(parse(change(text_of(name)), str(ROOT / "scenes" / f"{name}.toml")), complete)


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


def close(found: Any, expected: Any, limit: float) -> None:
    """Assert agreement to a fraction of the largest expected number, or of 0.1 if all are small."""
    expected = np.array(expected, dtype=object).astype(float)
    assert np.shape(found) == expected.shape
    if expected.size:
        assert np.max(np.abs(found - expected)) <= limit * max(0.1, np.max(np.abs(expected)))
