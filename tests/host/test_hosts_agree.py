"""The crank-slider of the scenes, generated and compiled: all hosts come to the same motion and the same forces."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from pendulums import needed
from toolchain import block

import derive
from conftest import ROOT
from derive.generated_models import generated
from derive.runtime.compiler import WITHOUT_BATCHES
from derive.runtime.integrators.c_integrator import CIntegrator, Integration, IntegratorError
from derive.runtime.integrators.fixed_step import FixedStep
from derive.runtime.integrators.generalised_alpha import GeneralisedAlpha
from derive.runtime.integrators.ida import Ida
from derive.simulation.initial.closest_consistent_state import closest_consistent_state
from derive.simulation.initial.initial_guess import initial_guess

DURATION, ROWS = 0.02, 21  # half a turn of the crank
FAST = ["-O0", WITHOUT_BATCHES]  # to compile


@cache
def files() -> tuple[derive.File, ...]:
    scene = derive.read(ROOT / "scenes" / "crank_slider_3.toml")
    return generated(scene)[1]


def start(host: CIntegrator) -> tuple[object, object]:
    scene, native = derive.read(ROOT / "scenes" / "crank_slider_3.toml"), host.native
    found = closest_consistent_state(native, native.setup(), *initial_guess(scene, native))
    return found.q, found.v


@cache
def fixed() -> FixedStep:
    return FixedStep(files(), FAST)


@cache
def explicit() -> Integration:
    return fixed().run(*start(fixed()), step=2e-6, steps=10_000, every=500)


def test_projection_keeps_every_joint_closed() -> None:
    native, k = fixed().native, fixed().native.setup()
    for found in (explicit(), fixed().run(*start(fixed()), step=2e-5, steps=1000, every=50)):
        for t, q, v in zip(found.t, found.q, found.v, strict=True):
            assert np.abs(native.constraints(t, q, k)).max() < 1e-12
            assert np.abs(native.constraint_rates(t, q, v, k)).max() < 2e-12


@pytest.mark.parametrize("form", ["ggl", "index1"])
def test_ida_agrees_with_runge_kutta(form: str) -> None:
    host = needed(lambda _: Ida(files(), FAST))
    found = host.run(*start(host), interval=1e-3, rows=ROWS, form=form, rtol=1e-9)
    assert np.abs(found.q - explicit().q).max() < 1e-7
    assert np.abs(found.v - explicit().v).max() < 1e-3  # of 20 m/s, 150 rad/s
    assert np.abs(found.lam - explicit().lam).max() < 1e-4 * np.abs(explicit().lam).max()


def test_generalised_alpha_agrees_with_runge_kutta() -> None:
    host = needed(lambda _: GeneralisedAlpha(files(), FAST))
    found = host.run(*start(host), step=1e-5, steps=2000, every=100)
    assert np.abs(found.q - explicit().q).max() < 1e-5
    assert np.abs(found.lam - explicit().lam).max() < 1e-2 * np.abs(explicit().lam).max()


def test_rigid_crank_turns_by_half() -> None:
    """The crank's motion is prescribed: 150 rad/s for 0.02 s."""
    native = fixed().native
    poses = native.poses(DURATION, explicit().q[-1], native.setup())
    assert poses[native.bodies.index("crank"), 2] == pytest.approx(150 * DURATION)


def test_a_body_without_joints() -> None:
    """The block of the scenes with loops, in space: q has a quaternion, patterns are not stored."""
    made = block("loops")
    free, implicit = FixedStep(made.files, FAST), needed(lambda _: Ida(made.files, FAST))
    q0, v0 = [0, 0, 0, 1, 0, 0, 0, 0, 0, 0], [0, 0, 0, 30, 20, 10, 0, 0, 0]
    one = free.run(q0, v0, step=1e-7, steps=2000, every=200)
    other = implicit.run(q0, v0, interval=2e-5, rows=11, form=None, rtol=1e-10)
    assert one.lam.shape == (11, 0)
    assert np.abs(one.q - q0).max() > 1e-3
    assert np.abs(one.q - other.q).max() < 1e-8
    with pytest.raises(IntegratorError, match="code 5: the model has no such form"):
        implicit.run(q0, v0, interval=2e-5, rows=11)
    with pytest.raises(IntegratorError, match="code 5: the model has no form of index 3"):
        needed(lambda _: GeneralisedAlpha(made.files, FAST)).run(q0, v0, step=1e-7, steps=1)
