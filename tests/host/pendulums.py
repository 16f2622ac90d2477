"""The hand-written model `pendulum/pendulum.c` as files of a model, and its motion in closed form."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import TypeVar

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipk

import derive
from derive.backends.c.source import ABI
from derive.rendering import render
from derive.roles import Role
from derive.runtime.integrators.adaptive import Adaptive
from derive.runtime.integrators.c_integrator import Integration
from derive.runtime.integrators.compilation import LibraryMissing
from derive.runtime.integrators.fixed_step import FixedStep
from derive.runtime.integrators.generalised_alpha import GeneralisedAlpha
from derive.runtime.integrators.ida import Ida
from derive.runtime.loading import load

Made = TypeVar("Made")
HERE = Path(__file__).parent
SHARED = "/* ---- shared by all models"


def _text(path: Path) -> str:
    """A file of the model; its header gets the descriptor's types from the template, so that there is one of them."""
    text = path.read_text()
    if path.suffix != ".h":
        return text
    line = next(line for line in text.splitlines() if line.startswith(SHARED))
    return text.replace(line, render("c/descriptor.h.jinja", {"abi": ABI, "roles": Role}))


FILES = tuple(derive.File(f"pendulum/{p.name}", _text(p)) for p in sorted((HERE / "pendulum").iterdir()))

DISTANCE, INERTIA, MASS, GRAVITY = 0.5, 0.125, 2.0, 9.81  # the defaults of the model
OMEGA = np.sqrt(MASS * GRAVITY * DISTANCE / (INERTIA + MASS * DISTANCE**2))
"""rad/s: of small oscillations."""

LEVEL = np.array([DISTANCE, 0.0, 0.0])
"""q at phi = 0, from where it falls, at rest."""
REST = np.zeros(3)


def exact(t: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """q and v (n, 3) after the time t (n,), from LEVEL at REST: an elliptic function of the angle from the vertical."""
    m = 0.5  # sin^2 of half the amplitude
    sn, cn, _, _ = ellipj(ellipk(m) - OMEGA * t, m)
    angle, spin = 2.0 * np.arcsin(np.sqrt(m) * sn), -2.0 * np.sqrt(m) * OMEGA * cn
    phi = angle - np.pi / 2
    x, y = DISTANCE * np.cos(phi), DISTANCE * np.sin(phi)
    return np.column_stack([x, y, phi]), np.column_stack([-y * spin, x * spin, spin])


@cache
def fixed() -> FixedStep:
    return FixedStep(FILES)


@cache
def adaptive() -> Adaptive:
    return Adaptive(load(FILES))


@cache
def ida() -> Ida:
    return needed(Ida)


@cache
def alpha() -> GeneralisedAlpha:
    return needed(GeneralisedAlpha)


def needed(host: Callable[[Sequence[derive.File]], Made]) -> Made:
    """A host for the pendulum; without its library the test is skipped, and fails in CI: nothing may go unnoticed."""
    try:
        return host(FILES)
    except LibraryMissing as error:
        if os.environ.get("CI"):
            pytest.fail(str(error), pytrace=False)
        pytest.skip(str(error))


def gap(found: Integration) -> NDArray[np.float64]:
    """How far the pivot of the rod is from where it belongs (n,), of a pivot at rest."""
    return np.hypot(found.q[:, 0] - DISTANCE * np.cos(found.q[:, 2]), found.q[:, 1] - DISTANCE * np.sin(found.q[:, 2]))


def energy(found: Integration) -> NDArray[np.float64]:
    """Kinetic energy and that of gravity (n,)."""
    kinetic = 0.5 * (MASS * np.sum(found.v[:, :2] ** 2, axis=1) + INERTIA * found.v[:, 2] ** 2)
    return np.asarray(kinetic + MASS * GRAVITY * found.q[:, 1])


def driven(stroke: float) -> tuple[NDArray[np.float64], Callable[[float], NDArray[np.float64]]]:
    """Constants of a pivot that moves to and fro, and q at a time from LEVEL, by an equation for phi alone."""
    k = np.array([DISTANCE, MASS, INERTIA, GRAVITY, stroke, 3.0])

    def rate(t: float, y: NDArray[np.float64]) -> list[float]:
        pivot = -stroke * 9.0 * np.sin(3.0 * t)  # its acceleration
        moment = MASS * DISTANCE * (pivot * np.sin(y[0]) - GRAVITY * np.cos(y[0]))
        return [y[1], moment / (INERTIA + MASS * DISTANCE**2)]

    def at(t: float) -> NDArray[np.float64]:
        phi = solve_ivp(rate, (0.0, t), [0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-13).y[0, -1]
        x = DISTANCE * np.cos(phi) + stroke * np.sin(3.0 * t)
        return np.array([x, DISTANCE * np.sin(phi), phi])

    return k, at
