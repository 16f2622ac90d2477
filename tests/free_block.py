"""The block of the scenes as compiled C, in its frames and lowerings, and a Runge-Kutta method that drives it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

import derive
from conftest import QUICK, ROOT
from derive import ModalBody, Model, Native, NodalBody
from derive.backends.c.source import CBackend
from derive.mechanics.bodies.spatial_body import parameters
from derive.spec.model.body import BodyFrame

Array = NDArray[np.float64]

POINT = BodyFrame("point", node=127, around=(112, 124, 126, 128, 130, 142))
"""A frame at the node in the centre, held by its six neighbours, which leave the three mirror planes what they are."""

"""Compiled soon: most of the time goes into calls."""


@cache
def spec(frame: str = "mean", lowering: str = "flat", modes: int = 8) -> NodalBody:
    """The block of the scenes with its frame, lowering and number of modes replaced."""
    block = derive.read(ROOT / "scenes/block.toml")
    chosen = POINT if frame == "point" else BodyFrame("mean")
    return replace(block, frame=chosen, lowering=lowering, modes=modes)


@cache
def body(frame: str = "mean", modes: int = 8) -> ModalBody:
    return derive.modal(spec(frame, "flat", modes))


@cache
def model(frame: str = "mean", lowering: str = "flat", modes: int = 8) -> Model:
    return derive.lower(derive.derive(spec(frame, lowering, modes)))


@cache
def native(frame: str = "mean", lowering: str = "flat", modes: int = 8) -> Native:
    return derive.load(CBackend().files(model(frame, lowering, modes), "test"), QUICK)


def fastest(frame: str = "mean", modes: int = 8) -> float:
    """The highest frequency of the modes, rad/s."""
    return float(np.sqrt(np.diag(body(frame, modes).stiffness).max()))


@cache
def _rubber() -> tuple[Native, ModalBody]:
    """The block in loops, whose stiffness and damping are numbers that can still be set."""
    damped = replace(body(), damping=np.diag(np.diag(body().stiffness)))
    return derive.load(
        CBackend().files(derive.lower(derive.derive_modal(damped, None, "loops")), "test"), QUICK
    ), damped


def rubber(stiffness: float, relaxation: float = 0.0) -> tuple[Native, Array]:
    """The block with `stiffness` times its stiffness K, damped by `relaxation` (s) times that; and its k.

    A block 10^4 times softer that spins at 12 rad/s is the one of aluminium at 1200 rad/s, seen 100 times slower.
    """
    loops, damped = _rubber()
    soft = stiffness * damped.stiffness
    changed = replace(damped, stiffness=soft, damping=relaxation * soft)
    return loops, loops.setup(parameters(changed, derive.derive_modal(damped).tables))


def start(modes: int, spin: Array | tuple[float, ...], alpha: Array | float = 0.0) -> tuple[Array, Array]:
    """q and v of a block at unit attitude that flies along, spins and is deformed."""
    q = np.concatenate([[0.1, -0.2, 0.3, 1, 0, 0, 0], np.broadcast_to(alpha, modes)])
    return q, np.concatenate([[4.0, -2.0, 1.0], spin, np.zeros(modes)])


def march(native: Native, k: Array, q: Array, v: Array, h: float, steps: int, every: int = 1) -> tuple[Array, Array]:
    """The classical Runge-Kutta method of fourth order: q and v at the start and after each `every` steps."""
    n = native.nq

    def rate(y: Array) -> Array:
        return np.concatenate([native.rates(y[:n], y[n:], k), native.accel(0.0, y[:n], y[n:], k)])

    y = np.concatenate([q, v])
    kept = [y]
    for step in range(1, steps + 1):
        a = rate(y)
        b = rate(y + h / 2 * a)
        c = rate(y + h / 2 * b)
        d = rate(y + h * c)
        y = y + h / 6 * (a + 2 * b + 2 * c + d)
        if step % every == 0:
            kept.append(y)
    states = np.array(kept)
    return states[:, :n], states[:, n:]


def energies(native: Native, k: Array, qs: Array, vs: Array) -> Array:
    """Kinetic and strain energy, together."""
    return np.array([native.energy(q, v, k).sum() for q, v in zip(qs, vs, strict=True)])


def momenta(native: Native, k: Array, qs: Array, vs: Array) -> Array:
    """Linear and angular momentum, (times, 6)."""
    return np.array([native.momentum(q, v, k) for q, v in zip(qs, vs, strict=True)])


def drifts(native: Native, k: Array, qs: Array, vs: Array) -> Array:
    """The largest relative changes of energy, linear and angular momentum, and of the norm of the quaternion."""
    energy, momentum = energies(native, k, qs, vs), momenta(native, k, qs, vs)
    norm = np.linalg.norm(qs[:, 3:7], axis=1)
    linear, angular = (
        np.abs(part - part[0]).max() / np.linalg.norm(part[0]) for part in (momentum[:, :3], momentum[:, 3:])
    )
    return np.array([np.abs(energy / energy[0] - 1).max(), linear, angular, np.abs(norm - 1).max()])


def rotation(e: Array) -> Array:
    """Q of a quaternion, scalar first, whatever its norm."""
    w, (x, y, z) = e[0], e[1:]
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * (w * cross + cross @ cross) / (e @ e)


def times(a: Array, b: Array) -> Array:
    """The product of quaternions."""
    vector = a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
    return np.concatenate([[a[0] * b[0] - a[1:] @ b[1:]], vector])
