"""Beams that many tests use."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
from typing import Any

import numpy as np

import derive
from conftest import QUICK
from derive.generated_models import generated
from derive.model_lowering import lowered_form
from derive.runtime.compiled_model import Native

FRAMES: dict[str, Any] = {
    "mean": "mean",
    "point": {"kind": "point", "at": 0},
    "point_off_centre": {"kind": "point", "at": "1/2"},
    "chord": "chord",
    "tangent": {"kind": "tangent", "at": -1},
}

MASS = {"symbol": "m", "unit": "kg", "default": 1.3}
LENGTH = {"symbol": "l", "unit": "m", "default": 0.7}
BENDING = {"symbol": "EI", "unit": "N m^2", "default": 2.1}


def beam(frame: str = "mean", n: int = 2, **changes: Any) -> derive.PlanarBeam:
    """A beam with n shapes in a frame of FRAMES, from monomials, with three markers."""
    given = {
        "ansatz": [f"xi^{power}" for power in range(n + 2)],
        "frame": FRAMES[frame],
        "mass": MASS,
        "length": LENGTH,
        "bending_stiffness": BENDING,
        "markers": {"left": -1, "inside": "1/3", "right": 1},
    }
    return derive.planar_beam(f"beam_{frame}_{n}", **(given | changes))


@dataclass(frozen=True)
class Made:
    """A beam, or another body, through all stages, each of which runs when it is asked for."""

    spec: Any

    @cached_property
    def _generated(self) -> tuple[derive.Model, tuple[derive.File, ...]]:
        """Through the cache that the workers share."""
        return generated(self.spec)

    @property
    def model(self) -> derive.Model:
        return self._generated[0]

    @property
    def files(self) -> tuple[derive.File, ...]:
        return self._generated[1]

    @cached_property
    def equations(self) -> Any:
        """The equations in the form that the model was lowered from; beams have straight-line code alone."""
        derived = derive.derive(self.spec)
        planar = isinstance(self.spec, derive.PlanarBeam)
        return derived.expanded() if planar else lowered_form(derived, self.model)


@cache
def made(frame: str = "mean", n: int = 2) -> Made:
    """A beam of `beam`, built once a session."""
    return build(beam(frame, n))


def build(spec: Any) -> Made:
    """All stages of one specification."""
    return Made(spec)


@cache
def native(frame: str = "mean", n: int = 2) -> Native:
    """The compiled C of a beam."""
    return derive.load(made(frame, n).files, QUICK)


@cache
def module(frame: str = "mean", n: int = 2) -> dict[str, Any]:
    """The names of the generated Python of a beam."""
    return run_module(made(frame, n).files)


def run_module(files: tuple[derive.File, ...]) -> dict[str, Any]:
    """The names of a generated Python module."""
    source = next(file for file in files if file.path.endswith(".py"))
    names: dict[str, Any] = {"__name__": "generated"}
    exec(compile(source.text, source.path, "exec"), names)
    return names


def state(n: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """q and v of a beam with n shapes that is bent, turned and moving."""
    rng = np.random.default_rng(1000 * n + seed)
    q = np.concatenate([rng.uniform(-2, 2, 2), rng.uniform(-4, 4, 1), rng.uniform(-0.3, 0.3, n)])
    return q, rng.uniform(-3, 3, n + 3)


def exact(values: np.ndarray) -> list[Fraction]:
    """Doubles as the exact numbers they are."""
    return [Fraction(float(x)) for x in values]
