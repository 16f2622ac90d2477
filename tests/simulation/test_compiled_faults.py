"""Compiled mechanisms that cannot go on, or never could; the crank has no coordinates of its own where it is driven."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec

import numpy as np
import pytest
from compiled import bars, clamped, pushed

from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.errors import (
    DriveCannotBeFollowed,
    InconsistentInitialState,
    RedundantConstraints,
    SingularConfiguration,
)
from derive.simulation.integration import scikit_sundae
from derive.simulation.integration.adaptive import adaptive
from derive.simulation.integration.integrator import Settings
from derive.simulation.integration.scikit_sundae import integrate_ida
from derive.simulation.integration.scipy_methods import integrate


def in_c(native: NativeScene, k: Vector, q: Vector, v: Vector, times: Vector) -> object:
    """The adaptive method in C."""
    return adaptive(native, NotImplemented).integrate(k, q, v, times, Settings())


NEEDS_IDA = pytest.mark.skipif(not find_spec("sksundae"), reason="no IDA")
METHODS = [in_c, integrate, pytest.param(integrate_ida, marks=NEEDS_IDA)]


@pytest.mark.parametrize("method", METHODS)
def test_a_slider_that_is_pushed_to_a_dead_centre_stops_there(
    method: Callable[..., object], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scikit_sundae, "STALL_STEPS", 200)  # a step takes milliseconds there, and 2000 add nothing
    made = pushed()
    start = made.start()  # shaken out of the line of the guess
    with pytest.raises(DriveCannotBeFollowed, match="dead centre") as error:
        method(made.native, made.k, start.q, start.v, np.linspace(0, 1, 101))
    assert error.value.t == pytest.approx(0.15, abs=1e-6)
    assert error.value.drives == ("crank_pin_1",)
    assert error.value.smallest < 1e-3


def test_a_slider_that_starts_at_a_dead_centre_is_refused() -> None:
    with pytest.raises(SingularConfiguration, match="dead centre") as error:
        pushed().start(t=0.15)
    assert error.value.multipliers == ("crank_pin_1",)


def test_a_slider_that_starts_out_of_reach_is_refused() -> None:
    with pytest.raises(InconsistentInitialState) as error:
        pushed().start(t=0.2)
    assert [name for name, _ in error.value.unmet] == ["crank_pin_1"]
    assert abs(error.value.unmet[0][1]) == pytest.approx(0.05)


def test_a_third_bar_is_redundant() -> None:
    """The first bar is driven and has no coordinates; in time the others show that they depend on each other."""
    with pytest.raises(RedundantConstraints, match="head_c_2 is implied by head_b_1, head_b_2 and head_c_1"):
        bars("abc").start()


def test_a_rod_that_is_clamped_out_of_line_has_to_bend() -> None:
    """One that is pinned has not, though it could: its guess lies half a length aside."""
    bent, straight = clamped("fixed").start(), clamped("revolute").start()
    assert bent.deformed and bent.position_error < 1e-12
    assert straight.position_error < 1e-12 and not straight.deformed
    assert straight.q[3:5] == pytest.approx([0, 0], abs=0) and np.abs(straight.q[0]) == pytest.approx(0.15)
    assert np.abs(bent.q[3:5]).max() > 1e-3
