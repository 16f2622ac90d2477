"""Random trees in loops over their links have the values of straight-line code."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from trees_of_bodies import KINDS, random_tree

import derive
import derive.lowering.trees.lower
from derive.ir.interpreter import interpret
from derive.ir.model import Model
from derive.runtime.interpreted_scene import InterpretedScene
from derive.simulation.configurations import normalised
from some_functions import only

MATRICES = ("M", "G", "A", "jacobian")
FUNCTIONS = ("inverse_dynamics", "gravity_compensation", "centre_of_mass", "centroidal_momentum")
FORMS = ("", "_ggl", "_index1")
BALLS = ("spherical", "revolute", "universal", "spherical", "prismatic")


def tree(seed: int, kinds: tuple[str, ...], free: bool = False, **more: Any) -> dict[str, Any]:
    """A random tree with springs of all kinds between random links and the ground, without outputs."""
    tables = random_tree(seed, kinds, free)
    del tables["outputs"]
    rng = np.random.default_rng(seed)
    ends = ["ground.o", *(f"{name}.o" for name in tables["bodies"])]
    values: dict[str, dict[str, Any]] = {
        "linear": {"stiffness": 20, "damping": 1.5, "rest": 0.4},
        "rotational": {"stiffness": 5, "damping": 0.7, "rest": 0.1},
        "bushing": {"stiffness": [3, 0, 4, 0, 2, 1], "damping": [0.3, 0.2, 0, 0, 0.1, 0]},
    }
    for number, kind in enumerate(values):
        between = [ends[n] for n in rng.permutation(len(ends))[:2]]
        tables["springs"][f"{kind}{number}"] = {"kind": kind, "between": between, **values[kind]}
    return {**tables, **more}


def models(tables: dict[str, Any], **options: Any) -> tuple[Model, Model]:
    """The model in loops, and that in straight-line code."""
    scene = replace(derive.spatial_scene(tables), coordinates="relative")
    looped, flat = (
        derive.lower(derive.derive(replace(scene, lowering=name)), explicit=True, **options)
        for name in ("instances", "flat")
    )
    assert (looped.lowering, flat.lowering) == ("instances", "flat")
    return looped, flat


def differences(looped: Model, flat: Model, seed: int = 1) -> dict[str, float]:
    """The differences of the results of functions in a random state, relative to the largest number of each."""
    rng = np.random.default_rng(seed)
    native = InterpretedScene(flat)
    q = normalised(native, rng.normal(size=native.nq))
    v, vdot = rng.normal(size=(2, native.nv))
    given: dict[str, Any] = {
        **{
            "q": q,
            "v": v,
            "vdot": vdot,
            "u": rng.normal(size=len(flat.inputs)),
            "lam": rng.normal(size=native.nlambda),
        },
        **{"y": np.concatenate([q, v]), "r": rng.normal(size=native.nlambda)},
        **{"ydot": rng.normal(size=native.nq + native.nv)},
    }
    p = [1 + 0.1 * n for n in range(len(flat.parameters))]
    result = {}
    names = {kernel.name for kernel in looped.kernels}
    for kernel in (of for of in flat.kernels if of.name in names):
        known = {**given, "t": 0.7}
        if kernel.name == "setup" or not {a.name for a in kernel.arguments} <= {*known, "k"}:
            continue
        wanted, found = (
            interpret(m.kernel(kernel.name), {**known, "k": interpret(m.kernel("setup"), {"p": p})["k"]})
            for m in (flat, looped)
        )
        for name, want in wanted.items():
            a, b = np.array(want, float), np.array(found[name], float)
            if (shape := flat.pattern(kernel.name, name) if name in MATRICES else None) is not None:
                a, b = shape.dense(a), looped.pattern(kernel.name, name).dense(b)
            assert a.shape == b.shape, (kernel.name, name)
            if a.size:
                result[f"{kernel.name} {name}"] = float(np.max(np.abs(a - b)) / max(np.max(np.abs(a)), 1e-300))
    return result


@cache
def balls(seed: int, free: bool) -> tuple[Model, Model]:
    """Both models of a random tree with joints that leave all rotations, and with two markers on each body."""
    tables = tree(seed, BALLS if seed < 2 else KINDS, free)
    for body in tables["bodies"].values():
        body["markers"]["tip"] = {"at": [0.3, -0.2, 0.5]}
    return models(tables, functions=FUNCTIONS)


@pytest.mark.parametrize(
    ("seed", "free"), [(1, True), *(pytest.param(*of, marks=pytest.mark.long) for of in ((1, False), (3, True)))]
)
def test_balls_in_loops_have_the_values_of_straight_line_code(seed: int, free: bool) -> None:
    """Joints that leave all rotations do not turn what hangs on them: in M, in forces and in accelerations."""
    found = differences(*balls(seed, free))
    assert {"centre_of_mass jacobian", "centroidal_momentum A", "inverse_dynamics f"} <= {*found}
    assert {"mass M", "accel vdot", "force h", "momentum momentum", "poses pose", "rates qdot"} <= {*found}
    assert {name: error for name, error in found.items() if error > 1e-13} == {}


def closed(seed: int, free: bool = False) -> dict[str, Any]:
    """A random tree with joints that close loops, a drive and a gear."""
    kinds = ("revolute", "prismatic", "spherical", "universal", "revolute", "cylindrical")
    tables = tree(seed, kinds, free)
    tables["joints"]["line"] = {"kind": "point_on_line", "between": ["body6.o", "body2.o"], "closes_loop": True}
    tables["joints"]["rod"] = {"kind": "distance", "between": ["ground.o", "body5.o"], "distance": 1.3}
    tables["joints"]["hinge"] = {"kind": "general", "removes": ["rx"], "between": ["body3.o", "body4.o"]}
    tables["gears"] = {"mesh": {"joints": ["joint1", "joint2"], "ratio": -0.4}}
    tables["drives"] = {"slide": {"joint": "joint5", "motion": "0.1*sin(t)"}}
    return tables


@pytest.mark.parametrize(("seed", "free"), [(1, True)])
def test_markers_in_loops_have_the_values_of_straight_line_code(seed: int, free: bool) -> None:
    """One function has the motion of each marker and its Jacobian, also behind balls."""
    looped, flat = balls(seed, free)  # explicit models have markers with others on request
    natives = [InterpretedScene(model) for model in (looped, flat)]
    rng = np.random.default_rng(seed)
    q, v = normalised(natives[0], rng.normal(size=natives[0].nq)), rng.normal(size=natives[0].nv)
    assert {*natives[0].markers} == {*natives[1].markers}
    for name in natives[1].markers:
        found, wanted = (native.marker(name, q, v, native.setup()) for native in natives)
        dense = [n.marker_pattern(name).dense(of[2]) for n, of in zip(natives, (found, wanted), strict=True)]
        for a, b in zip((*found[:2], dense[0]), (*wanted[:2], dense[1]), strict=True):
            assert np.max(np.abs(a - b)) < 1e-13 * max(np.max(np.abs(b)), 1)


@pytest.mark.parametrize(("seed", "free"), [(2, True), pytest.param(0, False, marks=pytest.mark.long)])
def test_constraints_and_parameters_in_loops_have_the_values_of_straight_line_code(seed: int, free: bool) -> None:
    """Joints that close loops, drives and gears: g, gdot, G, gamma, accelerations with multipliers, and projections.

    Masses, lengths, gravity, stiffnesses and loads may be parameters; setup computes what follows from them.
    """
    tables = closed(seed, free)

    def parameter(symbol: str, default: float, unit: str) -> dict[str, Any]:
        return {"symbol": symbol, "default": default, "unit": unit}

    tables["scene"]["gravity"] = [0, 0.5, parameter("g", -9.81, "m/s^2")]
    for name in ("body2", "body4"):
        tables["bodies"][name]["mass"] = parameter("m", 1.5, "kg")
    tables["bodies"]["body3"]["markers"]["o"]["at"] = [parameter("l", 0.4, "m"), 0.1, 0]
    tables["gears"]["mesh"]["ratio"] = parameter("i", -0.4, "1")
    tables["springs"]["rope"]["rest"] = parameter("l0", 0.2, "m")
    tables["springs"]["coil"] = {
        "kind": "rotational",
        "between": tables["joints"]["joint5"]["between"],
        "stiffness": parameter("c", 7, "N m/rad"),
        "rest": 0.2,
    }
    found = differences(*models(tables))
    wanted = {"constraints g", "constraint_rates gdot", "constraint_jacobian G", "constraint_bias gamma"}
    assert {*wanted, "solve lam", "accel vdot", "project_velocity dv"} <= {*found}
    assert {name: error for name, error in found.items() if error > 1e-12} == {}


@pytest.mark.parametrize(("seed", "free"), [(0, False), pytest.param(2, True, marks=pytest.mark.long)])
def test_forms_in_loops_have_the_values_of_straight_line_code(
    seed: int, free: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Residuals of all forms, and the derivatives of their loops, column by column, with springs, balls, constraints.

    Beside unit quaternions both have other derivatives: the directions are those of rates of coordinates. Iteration
    matrices of straight-line code are those for mu = 0.
    """
    monkeypatch.setattr(derive.lowering.trees.lower, "MOST_UNROLLED", 5)
    tables = closed(seed, free)
    hinge = {"kind": "rotational", "between": tables["joints"]["joint5"]["between"]}
    tables["springs"]["coil"] = {**hinge, "stiffness": 7, "damping": 2}
    scene = replace(derive.spatial_scene(tables), coordinates="relative")
    forms = [f"{kind}{form}" for kind in ("residual", "jacobian") for form in FORMS]
    with only("rates", "markers", *forms):
        pair = [derive.lower(derive.derive(replace(scene, lowering=name))) for name in ("instances", "flat")]
    rng = np.random.default_rng(seed)
    native = InterpretedScene(pair[1])
    q, v = normalised(native, rng.normal(size=native.nq)), rng.normal(size=native.nv)
    along = np.array([native.rates(q, other, native.setup()) for other in rng.normal(size=(3, native.nv))]).T
    for form in FORMS:
        size = pair[1].kernel(f"residual{form}").outputs[0].size
        states = np.concatenate([q, v, rng.normal(size=native.nlambda), np.zeros(size)])[:size]
        given = {"t": 0.3, "y": states, "ydot": rng.normal(size=size), "cj": 3.0, "u": []}
        found = []
        for model in pair:
            state = {**given, "k": interpret(model.kernel("setup"), {"p": []})["k"]}
            values = interpret(model.kernel(f"jacobian{form}"), state)["jac"]
            matrix = model.pattern(f"jacobian{form}", "jac").dense(np.array(values, float))
            rows = np.array(interpret(model.kernel(f"residual{form}"), state)["F"], float)
            found.append((rows, matrix[:, : len(q)] @ along, matrix[:, len(q) :]))
        for a, b in zip(*found, strict=True):
            assert np.max(np.abs(a - b)) < 1e-13 * np.max(np.abs(b)), form


def test_what_loops_over_links_do_not_have_is_refused() -> None:
    """Bodies that a drive moves, and constraints whose multipliers have to be of least norm, with what to write."""
    tables = closed(0)
    tables["bodies"]["alone"] = {**tables["bodies"]["body1"], "markers": {"o": {"at": [0, 0, 0]}}}
    tables["joints"]["pivot"] = {"kind": "revolute", "between": ["ground.o", "alone.o"]}
    scene = replace(derive.spatial_scene(tables), coordinates="relative", lowering="instances")
    with pytest.raises(derive.SpecError, match=r"no multipliers of least norm, and scene\.redundant"):
        derive.lower(derive.derive(replace(scene, redundant="resolve")), explicit=True)
    tables["drives"]["spin"] = {"joint": "pivot", "motion": "t"}
    scene = replace(derive.spatial_scene(tables), coordinates="relative", lowering="instances")
    with pytest.raises(derive.SpecError, match=r"drive spin prescribes one.*lowering = "):
        derive.lower(derive.derive(scene), explicit=True)
