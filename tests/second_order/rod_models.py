"""Beams of the tool that move as the exact rod does: free or clamped, struck when straight, or loaded at the tip.

Mass, length and bending stiffness are 1. The first velocities are exactly those of the rod, since the straight states
of all models agree.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property
from typing import Any, Literal

import numpy as np
from exact_rod import ExactRod, Motion
from numpy.polynomial import Legendre
from scipy.linalg import eigh

import derive
from conftest import QUICK
from derive.generated_models import generated, generated_explicit
from derive.runtime.compiler import ESSENTIAL
from derive.runtime.interpreted_scene import with_iteration_matrix
from derive.runtime.loading import load_scene
from derive.runtime.native_scene import NativeScene
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.integration.scipy_methods import integrate
from derive.spec.model.scene import EQUILIBRIUM, Scene

SHAPES = 5
"""xi^2 to xi^6 and their like: the lowest frequency is 1e-5 high for a free beam, less for a clamped one."""
FLAGS = (*QUICK, *ESSENTIAL)
FRAMES: dict[str, Any] = {
    "mean": "mean",
    "chord": "chord",
    "point": "point",
    "tangent": {"kind": "tangent", "at": -1},
}
TERMS: dict[str, dict[str, Any]] = {
    "first order": {"order": 1},
    "truncated": {"order": 2, "terms": "truncated"},
    "full": {"order": 2, "terms": "full"},
}
POINTS = {"left": -1, "a": "-2/3", "b": "-1/3", "middle": 0, "c": "1/3", "d": "2/3", "right": 1}
"""Markers: as many as polynomials."""
TIMES = {"free": np.linspace(0, 0.6, 121), "clamped": np.linspace(0, 3.6, 121)}
"""Two periods of the first natural frequency."""


def compiled_scene(scene: Scene, complete: bool = False) -> NativeScene:
    """The compiled C of a scene; of one that is not complete, what explicit integration calls."""
    if complete:
        return load_scene(generated(scene)[1], QUICK)
    model, files = generated_explicit(scene)
    return with_iteration_matrix(load_scene(files, FLAGS), model)


@cache
def first_mode(support: Literal["free", "clamped"]) -> Legendre:
    """The first mode over 0 <= s <= 1, 1 at its right end, of polynomials that the beams have."""
    powers = [Legendre.basis(n, domain=[0, 1]) for n in range(SHAPES + 2)]
    if support == "clamped":
        root = Legendre.fromroots([0, 0], domain=[0, 1])
        powers = [root * p for p in powers[:SHAPES]]
    s, w = ExactRod(support).nodes
    value, bend = (np.array([p.deriv(d)(s) if d else p(s) for p in powers]) for d in (0, 2))
    _, vectors = eigh((bend * w) @ bend.T, (value * w) @ value.T)
    mode = sum(float(c) * p for c, p in zip(vectors[:, 2 * (support == "free")], powers, strict=True))
    return mode / mode(1.0)


@dataclass(frozen=True)
class RodModel:
    """A beam in a frame of FRAMES with the terms of TERMS, free or clamped at its left end."""

    support: Literal["free", "clamped"]
    frame: str
    terms: str

    @cached_property
    def scene(self) -> Scene:
        """The scene, with a force on the right end of a clamped beam."""
        rod = {
            "ansatz": [f"xi^{n}" for n in range(SHAPES + 2)],
            "frame": FRAMES[self.frame],
            "mass": 1,
            "length": 1,
            "bending_stiffness": 1,
            "markers": POINTS,
            "start": {"position": [0.5, 0]},
            **TERMS[self.terms],
        }
        if self.support == "free":
            return derive.scene("rod_free", bodies={"rod": rod})
        return derive.scene(
            "rod_clamped",
            ground={"wall": [0, 0]},
            bodies={"rod": rod},
            joints={"clamp": {"kind": "weld", "between": ["ground.wall", "rod.left"]}},
            forces={"load": {"at": "rod.right", "components": [0, "P"]}},
            parameters={"P": {"default": 0}},
        )

    @cached_property
    def native(self) -> NativeScene:
        """The compiled scene."""
        return compiled_scene(self.scene)

    def struck(self, velocity: Legendre, times: np.ndarray, tolerance: float = 1e-8) -> Motion:
        """The motion after a strike, as `ExactRod.struck` returns it. Raises SimulationError where the model fails."""
        native, k = self.native, self.native.setup()
        q = initial_state(self.scene, native, k).q
        moved = [[self._marker(name, q, unit, k, 1)[1] for unit in np.eye(native.nv)] for name in POINTS]
        across = np.array([velocity((float(Fraction(at)) + 1) / 2) for at in POINTS.values()])
        v = np.linalg.lstsq(np.array(moved), across, rcond=None)[0]
        found = integrate(native, k, q, v, times, tolerance=tolerance)
        energy = np.array([sum(native.energy(a, b, k)) for a, b in zip(found.q, found.v, strict=True)])
        return Motion(times, *self._points(found.q, found.v, k), energy)

    def at_rest(self, load: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The state at rest under a load across the rod, as `ExactRod.at_rest` returns it."""
        scene = replace(self.scene, start=EQUILIBRIUM)
        native = compiled_scene(scene)
        q = initial_state(scene, native, native.setup([load])).q[None]
        left, middle, right = self._points(q, 0 * q, self.native.setup([load]))
        return left[0], middle[0], right[0]

    def _points(self, q: np.ndarray, v: np.ndarray, k: np.ndarray) -> list[np.ndarray]:
        """The left end, the middle and the right end (n, 2) in states (n, nq)."""
        states = list(zip(q, v, strict=True))
        return [np.array([self._marker(name, *y, k, 0) for y in states]) for name in ("left", "middle", "right")]

    def _marker(self, name: str, q: np.ndarray, v: np.ndarray, k: np.ndarray, derivative: int) -> np.ndarray:
        """The position, or the velocity, of a marker (2,)."""
        return self.native.marker(f"rod_{name}", q, v, k)[derivative][:2]


def deflection(motion: Motion, support: str) -> np.ndarray:
    """The deflection over the length (n,): of a free rod at its middle from the chord, of a clamped one at its tip."""
    if support == "clamped":
        return motion.right[:, 1] - motion.left[:, 1]
    chord = motion.right - motion.left
    across = np.stack([-chord[:, 1], chord[:, 0]], axis=1) / np.linalg.norm(chord, axis=1)[:, None]
    return ((motion.middle - (motion.left + motion.right) / 2) * across).sum(axis=1)
