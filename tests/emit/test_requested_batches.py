"""Batches of the functions on request give the bits of single calls, in straight-line code and in loops over links."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import derive
from derive.backends.c.source import CBackend
from derive.runtime.compiler import CompilerError
from derive.runtime.loading import load

CALLS = {
    "inverse_dynamics": ("t", "q", "v", "vdot"),
    "gravity_compensation": ("t", "q"),
    "centre_of_mass": ("q", "v"),
    "centroidal_momentum": ("q", "v"),
}
"""The functions with their arguments before the constants."""


def arm(lowering: str) -> derive.ir.model.Model:
    """Three links with a motor, whose torque is an input."""
    marker = {"at": [0, 0, 0], "rotation": {"z": [0, 1, 0], "x": [1, 0, 0]}}
    link = {
        "count": 3,
        "mass": 2,
        "centre": [0.1, 0.2, 0],
        "inertia": [0.4, 0.5, 0.3, 0.01, 0.02, -0.015],
        "markers": {"near": marker, "far": {"at": [0.3, 0, 0], "rotation": {"z": [0, 0.8, 0.6], "x": [1, 0, 0]}}},
    }
    tables = {
        "name": "arm",
        "scene": {"coordinates": "relative", "lowering": lowering, "gravity": [0, 1, -9.81]},
        "ground": {"markers": {"base": marker}},
        "bodies": {"link": link},
        "joints": {
            "first": {"kind": "revolute", "between": ["ground.base", "link[0].near"]},
            "other": {"count": 2, "kind": "revolute", "between": ["link[i].far", "link[i+1].near"]},
        },
        "inputs": {"motor": {"value": 0}},
        "torques": {"motor": {"joint": "first", "value": {"input": "motor"}}},
    }
    return derive.lower(derive.derive(derive.spatial_scene(tables)), explicit=True, functions=tuple(CALLS))


@pytest.mark.parametrize("lowering", ["flat", "instances"])
def test_batches_have_the_bits_of_single_calls(lowering: str) -> None:
    """For one state, for those of blocks, and for those that fill none, with an input behind the constants."""
    model = arm(lowering)
    of: Any = load(CBackend().files(model, "test"))
    k, rng = of.with_inputs(of.setup(), [0.7]), np.random.default_rng(2)
    for count in (1, 8, 13):
        given = {name: rng.normal(size=(count, of.nv)) for name in ("q", "v", "vdot")}
        for name, arguments in CALLS.items():
            states = [given[a] for a in arguments if a != "t"]
            time = [0.3] if "t" in arguments else []
            found = getattr(of, f"{name}_batch")(*time, *states, k)
            found = found if isinstance(found, tuple) else (found,)
            for n in range(count):
                one = getattr(of, name)(*time, *(state[n] for state in states), k)
                for values, wanted in zip(found, one if isinstance(one, tuple) else (one,), strict=True):
                    assert np.array(values[n]).tobytes() == np.array(wanted).tobytes(), (name, count, n)
                    assert np.any(wanted)


def test_a_model_without_a_function_has_no_batch_of_it() -> None:
    """The message says with what to generate it."""
    ball = derive.spatial_scene({"name": "ball", "bodies": {"ball": {"mass": 1, "inertia": [1, 1, 1, 0, 0, 0]}}})
    of: Any = load(CBackend().files(derive.lower(derive.derive(ball), explicit=True), "test"))
    with pytest.raises(CompilerError, match="no centre_of_mass; generate it with functions"):
        of.centre_of_mass_batch(np.zeros((2, of.nq)), np.zeros((2, of.nv)), of.setup())
