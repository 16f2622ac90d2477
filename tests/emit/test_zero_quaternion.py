"""A quaternion of length zero or NaN is no rotation: every function that depends on it says so, in C and in Python."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest

import derive
from beams import run_module
from conftest import QUICK
from derive.generated_models import generated
from derive.runtime.compiled_model import Native
from derive.runtime.native_call import ModelError

FORCE = np.array([1.0, -2.0, 0.5])
CASES = [("mean", False), ("mean", True), ("given", False)]


@cache
def body(lowering: str, frame: str, heavy: bool) -> tuple[Native, dict[str, Any]]:
    """A body of four masses with a marker, compiled and as a Python module."""
    rng = np.random.default_rng(1)
    nodes = {
        "positions": rng.normal(size=(4, 3)),
        "mass": np.diag(rng.uniform(1, 2, 4)),
        "modes": rng.normal(size=(2, 4, 3)),
        "modal_stiffness": np.diag([2.0, 3.0]),
    }
    gravity = {"gravity": [0, 0, -9.81]} if heavy else {}
    spec = derive.nodal_body(
        f"{frame}_{lowering}", nodes, units="SI", frame=frame, lowering=lowering, markers={"tip": 0}, **gravity
    )
    files = generated(spec)[1]
    return derive.load(files, QUICK), run_module(files)


def functions(native: Native, k: np.ndarray) -> Mapping[str, Callable[[np.ndarray], Any]]:
    """Every function of a state, as one of q alone."""
    rng = np.random.default_rng(2)
    v, ydot = rng.normal(size=native.nv), rng.normal(size=native.nq + native.nv)
    return {
        "mass": lambda q: native.mass(q, k),
        "force": lambda q: native.force(0.0, q, v, k),
        "mass_force": lambda q: np.concatenate(native.mass_force(0.0, q, v, k)),
        "accel": lambda q: native.accel(0.0, q, v, k),
        "energy": lambda q: native.energy(q, v, k),
        "momentum": lambda q: native.momentum(q, v, k),
        "rates": lambda q: native.rates(q, v, k),
        "residual": lambda q: native.residual(0.0, np.append(q, v), ydot, k),
        "jacobian": lambda q: native.jacobian(0.0, np.append(q, v), ydot, 1.3, k),
        "marker_tip": lambda q: np.concatenate(native.marker("tip", q, v, k)),
        "load_tip": lambda q: native.load("tip", q, FORCE, k),
    }


def in_python(module: dict[str, Any], native: Native, k: np.ndarray) -> Mapping[str, Callable[[np.ndarray], Any]]:
    """The results of the same functions of the generated Python."""
    rng = np.random.default_rng(2)
    v, ydot = rng.normal(size=native.nv), rng.normal(size=native.nq + native.nv)

    def y(q: np.ndarray) -> np.ndarray:
        return np.concatenate([q, np.broadcast_to(v, (*q.shape[:-1], native.nv))], axis=-1)

    return {
        "mass": lambda q: module["mass"](q, k),
        "force": lambda q: module["force"](0.0, q, v, k),
        "mass_force": lambda q: module["mass_force"](0.0, q, v, k),
        "accel": lambda q: module["accel"](0.0, q, v, k),
        "energy": lambda q: module["energy"](q, v, k),
        "momentum": lambda q: module["momentum"](q, v, k),
        "rates": lambda q: module["rates"](q, v, k),
        "residual": lambda q: module["residual"](0.0, y(q), ydot, k),
        "jacobian": lambda q: module["jacobian"](0.0, y(q), ydot, 1.3, k),
        "marker_tip": lambda q: module["marker_tip"](q, v, k),
        "load_tip": lambda q: module["load_tip"](q, FORCE, k),
    }


def attitudes(native: Native) -> np.ndarray:
    """Three states that differ in their quaternions alone; that of the last one is zero."""
    rng = np.random.default_rng(3)
    states = np.tile(rng.normal(size=native.nq) * 0.1, (3, 1))
    states[:2, 3:7] = [q / np.linalg.norm(q) for q in rng.normal(size=(2, 4))]
    states[2, 3:7] = 0.0
    return states


def depends(function: Callable[[np.ndarray], np.ndarray], states: np.ndarray) -> bool:
    """Whether a function differs at two attitudes."""
    return not np.allclose(function(states[0]), function(states[1]), rtol=1e-9, atol=0)


@pytest.mark.parametrize("lowering", ["flat", "loops"])
@pytest.mark.parametrize(("frame", "heavy"), CASES)
def test_every_function_of_the_attitude_refuses_a_quaternion_that_is_zero(
    lowering: str, frame: str, heavy: bool
) -> None:
    """No other function refuses it; in a batch, Python gives NaN for that state alone."""
    native, module = body(lowering, frame, heavy)
    k, states = native.setup(), attitudes(native)
    python = in_python(module, native, module["setup"](native.defaults))
    refusing = []
    for name, function in functions(native, k).items():
        if not depends(function, states):
            np.testing.assert_array_equal(function(states[2]), function(states[0]))
            continue
        refusing.append(name)
        for wrong in (states[2], np.where(states[2] == 0.0, np.nan, states[2])):
            with pytest.raises(ModelError) as error:
                function(wrong)
            assert error.value.code == 2, name
            with pytest.raises(module["ModelError"]) as error:
                python[name](wrong)
            assert error.value.code == 2 and "the quaternion is zero or NaN" in str(error.value)
        results = python[name](states)
        for result in results if isinstance(results, tuple) else (results,):
            assert np.isfinite(result[:2]).all() and np.isnan(result[2]).all(), name
    always = {"momentum", "rates", "residual", "jacobian", "marker_tip", "load_tip"}
    # In the mean frame M and h do not depend on the attitude, not even with gravity, which acts on c alone.
    of_given_frame = {"mass", "force", "mass_force", "accel", "energy"}
    assert {*refusing} == always | (of_given_frame if frame == "given" else set())


@pytest.mark.parametrize("lowering", ["flat", "loops"])
def test_batches_of_c_have_nan_for_that_state_alone(lowering: str) -> None:
    native, _ = body(lowering, "given", False)
    k, q = native.setup(), attitudes(native)[[0, 2, 1]]
    v = np.random.default_rng(4).normal(size=(3, native.nv))
    calls = {
        "mass": lambda **check: native.mass_batch(q, k, **check),
        "force": lambda **check: native.force_batch(0.0, q, v, k, **check),
        "accel": lambda **check: native.accel_batch(0.0, q, v, k, **check),
    }
    for name, call in calls.items():
        with pytest.raises(ModelError, match=f"{name}_batch returned 2"):
            call()
        found = call(check=False)
        assert np.array_equal(np.isnan(found).all(axis=1), [False, True, False]), name
        assert np.isfinite(found[[0, 2]]).all()
    single = native.mass(q[0], k)
    np.testing.assert_allclose(native.mass_batch(q, k, check=False)[0], single, rtol=1e-12)


def test_the_header_says_what_a_quaternion_has_to_be() -> None:
    spec = derive.symbolic_body("attitude", 1, frame="given")
    (header,) = (f.text for f in generated(spec)[1] if f.path.endswith(".h"))
    text = " ".join(header.split())
    assert "The quaternion is assumed to have unit length: of one with the length s, Q is s^2 times" in text
    assert "Functions that read it return 2 where it is zero or NaN, before they check anything else." in text
    assert (
        "mass_batch, force_batch, mass_force_batch, accel_batch, energy_batch, momentum_batch and rates_batch give NaN"
        in text
    )
    beam = derive.planar_beam("flat_beam")
    (header,) = (f.text for f in generated(beam)[1] if f.path.endswith(".h"))
    assert "quaternion" not in header and "accel_batch gives NaN" in " ".join(header.split())
