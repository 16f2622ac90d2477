"""Derivatives in loops over links: those of straight-line code, with its patterns, and in C as interpreted."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from test_links_and_flat import FUNCTIONS, closed, models, tree

import derive.lowering.trees.lower
from derive.backends.c.source import CBackend
from derive.ir.interpreter import interpret
from derive.ir.model import Model
from derive.runtime.interpreted_scene import InterpretedScene
from derive.runtime.loading import load
from derive.simulation.configurations import normalised
from some_functions import only

JACOBIANS = ("parameter_jacobian", *(f"{name}_jacobian" for name in FUNCTIONS))


def parameter(symbol: str, default: float, unit: str) -> dict[str, Any]:
    """A parameter in the place of a number."""
    return {"symbol": symbol, "default": default, "unit": unit}


def with_parameters(tables: dict[str, Any], hinge: str) -> dict[str, Any]:
    """A tree with parameters of bodies, of gravity and of a spring, and with an input that loads a joint and a body."""
    tables["scene"]["gravity"] = [0, 0.5, parameter("g", -9.81, "m/s^2")]
    tables["bodies"]["body2"]["mass"] = parameter("m", 1.5, "kg")
    tables["bodies"]["body3"]["inertia"][0] = parameter("J", 0.8, "kg m^2")
    tables["bodies"]["body3"]["markers"]["o"]["at"] = [parameter("l", 0.4, "m"), 0.1, 0]
    tables["inputs"] = {"turn": {"value": 0}}
    tables["torques"] = {
        "motor": {"joint": "joint1", "value": {"input": "turn"}},
        "wheel": {"on": "body3.o", "torque": [0.1, {"input": "turn"}, "sin(t)"], "frame": "body"},
    }
    between = tables["joints"][hinge]["between"]
    coil = {"kind": "rotational", "between": between, "stiffness": parameter("c", 7, "N m/rad"), "rest": 0.2}
    return {**tables, "springs": {"coil": coil}}


def small(seed: int) -> dict[str, Any]:
    """A tree of four bodies, a ball among their joints."""
    return with_parameters(tree(seed, ("revolute", "spherical", "prismatic", "revolute")), "joint4")


def hinged(seed: int) -> dict[str, Any]:
    """A tree of three bodies without balls, of which straight-line code has other recursions."""
    return with_parameters(tree(seed, ("revolute", "prismatic", "revolute")), "joint3")


def large(seed: int) -> dict[str, Any]:
    """A tree with a free base, joints that close loops, a gear with a parameter, and a drive that an input moves."""
    tables = with_parameters(closed(seed, free=True), "joint5")
    tables["gears"]["mesh"]["ratio"] = parameter("i", -0.4, "1")
    tables["inputs"]["slide"] = {"value": 0}
    tables["drives"] = {"slide": {"joint": "joint5", "motion": {"input": "slide"}}}
    return tables


def state_of(model: Model, seed: int) -> tuple[dict[str, Any], np.ndarray]:
    """A random state with all that functions take, and changes of coordinates by random velocities, as columns."""
    rng, native = np.random.default_rng(seed), InterpretedScene(model)
    nq, nv, m = native.nq, native.nv, native.nlambda
    q = normalised(native, rng.normal(size=nq))
    v, vdot, a = rng.normal(size=(3, nv))
    along = np.array([native.rates(q, other, native.setup()) for other in rng.normal(size=(3, nv))]).T
    y, ydot = np.concatenate([q, v, rng.normal(size=m)]), rng.normal(size=nq + nv + m)
    given = {"t": 0.7, "q": q, "v": v, "vdot": vdot, "y": y, "ydot": ydot, "a": a, "b": rng.normal(size=m)}
    return {**given, "u": rng.normal(size=len(model.inputs)), "lam": np.zeros(m)}, along


def interpreted(model: Model, name: str, given: dict[str, Any]) -> dict[str, np.ndarray]:
    """The results of a function with parameters that are not the defaults."""
    p = [of.default * (1 + 0.1 * n) for n, of in enumerate(model.parameters)]
    found = interpret(model.kernel(name), {**given, "k": interpret(model.kernel("setup"), {"p": p})["k"]})
    return {output: np.array(values, float) for output, values in found.items()}


@pytest.mark.parametrize(
    ("make", "seed"),
    [(small, 0), (hinged, 1), pytest.param(large, 2, marks=pytest.mark.long)],
)
def test_derivatives_in_loops_are_those_of_straight_line_code(
    make: Any, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By states, parameters and inputs, with the same patterns; beside unit quaternions both have other derivatives."""
    monkeypatch.setattr(derive.lowering.trees.lower, "MOST_UNROLLED", 2)
    with only("rates", "parameter_jacobian", "solve_kkt", "markers"):
        looped, flat = models(make(seed), sensitivities=True, functions=FUNCTIONS)
    given, along = state_of(flat, seed)
    for name in JACOBIANS:
        shapes = [model.pattern(name, "jac") for model in (looped, flat)]
        assert shapes[0] == shapes[1], name
        found, wanted = (
            shape.dense(interpreted(model, name, given)["jac"])
            for model, shape in zip((looped, flat), shapes, strict=True)
        )
        count = 0 if name == "parameter_jacobian" else len(along)
        size = np.max(np.abs(wanted))
        assert size > 0.1
        assert np.max(np.abs(found[:, count:] - wanted[:, count:])) < 1e-12 * size, name
        assert np.max(np.abs((found - wanted)[:, :count] @ along[:count]), initial=0) < 1e-12 * size, name
    found, wanted = (interpreted(model, "solve_kkt", given) for model in (looped, flat))
    for output, values in wanted.items():
        assert np.max(np.abs(found[output] - values), initial=0) < 1e-12 * np.max(np.abs(values), initial=1), output


def test_compiled_derivatives_have_the_values_of_the_interpreter() -> None:
    """Columns in C, for the defaults of parameters."""
    scene = replace(derive.spatial_scene(small(1)), coordinates="relative", lowering="instances")
    looped = derive.lower(derive.derive(scene), explicit=True, sensitivities=True, functions=FUNCTIONS)
    given, _ = state_of(looped, 1)
    of: Any = load(CBackend().files(looped, "test"))
    k = of.with_inputs(of.setup(), given["u"])
    given["k"] = interpret(looped.kernel("setup"), {"p": [p.default for p in looped.parameters]})["k"]
    q, v, vdot = (given[name] for name in ("q", "v", "vdot"))
    found = {
        "inverse_dynamics_jacobian": of.inverse_dynamics_jacobian(0.7, q, v, vdot, k),
        "gravity_compensation_jacobian": of.gravity_compensation_jacobian(0.7, q, k),
        "centre_of_mass_jacobian": of.centre_of_mass_jacobian(q, v, k),
        "centroidal_momentum_jacobian": of.centroidal_momentum_jacobian(q, v, k),
        "parameter_jacobian": of.parameter_jacobian(0.7, given["y"], given["ydot"], k),
        "solve_kkt": of.solve_kkt(0.7, q, k, given["a"])[0],
    }
    for name, values in found.items():
        wanted = np.array(next(iter(interpret(looped.kernel(name), given).values())), float)
        assert values == pytest.approx(wanted, rel=0, abs=1e-13 * np.max(np.abs(wanted))), name
