"""A free elastic body in space: what must stay, stays; it passes through every attitude; rigid, it is Euler's top."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import derive
from conftest import QUICK
from derive.backends.c.source import CBackend
from derive.runtime.compiled_model import Native
from derive.runtime.native_call import Vector


@cache
def block(flexible: bool, stiffness: float = 400.0) -> Native:
    """The eight corners of a 0.3 x 0.2 x 0.1 m block, with two modes that twist and stretch it."""
    corners = np.array([(x, y, z) for x in (-0.15, 0.15) for y in (-0.1, 0.1) for z in (-0.05, 0.05)])
    x, y, z = corners.T
    twist = np.stack([0 * x, -x * z, x * y], axis=1) * 30
    stretch = np.stack([5 * x, -2 * y, 0 * z], axis=1)
    modes = np.array([twist, stretch]) if flexible else np.zeros((0, 8, 3))
    nodes = {"positions": corners, "mass": np.full(8, 0.25)}
    nodes |= {"modes": modes, "modal_stiffness": stiffness * np.eye(len(modes))} if flexible else {}
    given = {"orthonormal": False} if flexible else {}
    spec = derive.nodal_body(
        "block", nodes, units="SI", frame="given", modes=len(modes), markers={"corner": 7}, **given
    )
    return derive.load(CBackend().files(derive.lower(derive.derive(spec)), "test"), QUICK)


def flow(native: Native, k: Vector):
    n = native.nq

    def rate(t: float, y: Vector) -> Vector:
        return np.concatenate([native.rates(y[:n], y[n:], k), native.accel(t, y[:n], y[n:], k)])

    return rate


Spin = tuple[float, float, float]


def tumble(native: Native, spin: Spin, seconds: float, rtol: float = 1e-12) -> tuple[Vector, Vector]:
    shapes = native.nv - 6
    q = np.array([0.1, -0.2, 0.3, 1, 0, 0, 0, *([0.004] * shapes)])
    v = np.array([0.5, 0.2, -0.1, *spin, *([0.01] * shapes)])
    k = native.setup(np.zeros(0))
    times = np.linspace(0, seconds, 200)
    done = solve_ivp(flow(native, k), (0, seconds), np.concatenate([q, v]), "DOP853", times, rtol=rtol, atol=1e-14)
    assert done.success
    return done.y[: native.nq].T, done.y[native.nq :].T


@pytest.mark.parametrize("flexible", [False, True], ids=["rigid", "flexible"])
def test_energy_momentum_and_norm_stay(flexible: bool) -> None:
    native = block(flexible)
    k = native.setup(np.zeros(0))
    qs, vs = tumble(native, (6.0, 9.0, 4.0), 4.0)
    states = list(zip(qs, vs, strict=True))
    energy = np.array([native.energy(q, v, k).sum() for q, v in states])
    momentum = np.array([native.momentum(q, v, k) for q, v in states])
    assert np.max(np.abs(energy / energy[0] - 1)) < 1e-9
    assert np.max(np.abs(momentum - momentum[0])) < 1e-9 * np.linalg.norm(momentum[0])
    assert np.max(np.abs(np.linalg.norm(qs[:, 3:7], axis=1) - 1)) < 1e-10
    scalars = qs[:, 3]
    assert scalars.min() < -0.5 < 0.5 < scalars.max()  # it has turned past half a turn, where angles lock


def test_drift_falls_with_the_tolerance() -> None:
    native = block(True)
    k = native.setup(np.zeros(0))
    drifts = []
    for rtol in (1e-6, 1e-8, 1e-10):
        qs, vs = tumble(native, (6.0, 9.0, 4.0), 2.0, rtol)
        energy = np.array([native.energy(q, v, k).sum() for q, v in zip(qs, vs, strict=True)])
        drifts.append(np.max(np.abs(energy / energy[0] - 1)))
    assert drifts[0] > 10 * drifts[1] > 100 * drifts[2]


@pytest.mark.long
@pytest.mark.parametrize("flexible", [False, True], ids=["rigid", "flexible"])
def test_the_intermediate_axis_flips_and_the_others_do_not(flexible: bool) -> None:
    """Moments of inertia grow from axis 1 to axis 3 here, so axis 2 is the intermediate one."""
    native = block(flexible, stiffness=4000.0)
    for axis, flips in ((0, False), (1, True), (2, False)):
        spin = [0.02, 0.02, 0.02]
        spin[axis] = 12.0
        _, vs = tumble(native, (spin[0], spin[1], spin[2]), 4.0, 1e-10)
        assert (vs[:, 3 + axis].min() < -6.0) == flips


def test_a_rigid_body_is_eulers() -> None:
    """J wdot + w x (J w) = 0 with the inertia of the corners, and the flexible one near it when K is large."""
    rigid = block(False)
    inertia = 2.0 * np.array([0.1**2 + 0.05**2, 0.15**2 + 0.05**2, 0.15**2 + 0.1**2])
    q, v = np.array([0, 0, 0, 1.0, 0, 0, 0]), np.array([0, 0, 0, 3.0, -2.0, 5.0])
    omega = v[3:]
    expected = -np.cross(omega, inertia * omega) / inertia
    found = rigid.accel(0.0, q, v, rigid.setup(np.zeros(0)))
    assert np.allclose(found[3:], expected, rtol=1e-13) and np.allclose(found[:3], 0, atol=1e-14)
    _, of_rigid = tumble(rigid, (6.0, 9.0, 4.0), 0.5)
    apart = []
    for stiffness in (4e3, 4e4, 4e5):
        native = block(True, stiffness)
        start = np.concatenate([[0.1, -0.2, 0.3, 1, 0, 0, 0, 0, 0], [0.5, 0.2, -0.1, 6.0, 9.0, 4.0, 0, 0]])
        k, times = native.setup(np.zeros(0)), np.linspace(0, 0.5, 200)
        done = solve_ivp(flow(native, k), (0, 0.5), start, "DOP853", times, rtol=1e-10, atol=1e-13)
        apart.append(np.max(np.abs(done.y[native.nq + 3 : native.nq + 6].T - of_rigid[:, 3:6])))
    assert apart[0] > 5 * apart[1] > 25 * apart[2]
