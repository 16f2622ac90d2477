"""The derivatives of the equations with respect to parameters and inputs, against differences in 50 digits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest
import zoo
from made import close, state
from test_time_functions import tables

import derive
from beams import run_module
from conftest import QUICK, ROOT
from corpus.summed_terms import worst
from derive.backends.model_files import emit
from derive.ir.interpreter import interpret
from derive.ir.model import Model
from derive.lowering.instances.lower import lower_instances
from derive.runtime.compiler import CompilerError
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.toml.read import parse

BEAM = """
name = "stretching"
ground.markers = { o = [0, 0] }
[scene]
gravity = [0, { symbol = "gy", default = -9.81 }]
[bodies.rod]
ansatz = ["1", "xi", "xi^2", "xi^3"]
frame = { kind = "tangent", at = -1 }
order = 2
terms = "TERMS"
mass = { symbol = "m", default = 1.3 }
length = { symbol = "l", default = 1.2 }
bending_stiffness = { symbol = "EI", default = 7 }
markers = { left = -1, right = 1 }
AXIAL
[joints.pin]
kind = "revolute"
between = ["ground.o", "rod.left"]
[inputs.push]
value = "5"
[forces.push]
at = "rod.right"
components = [{ input = "push" }, 0]
[inputs.turn]
value = "t"
unit = "rad"
[drives.motor]
joint = "pin"
motion = { input = "turn" }
[outputs.tip]
kind = "position"
marker = "rod.right"
[outputs.pull]
kind = "reaction"
joint = "pin"
"""
AXIAL = """
[bodies.rod.axial]
ansatz = ["xi + 1"]
stiffness = { symbol = "EA", default = 900 }
preload = { symbol = "N", default = 3 }
"""
SPACE = """
name = "swinging"
[ground.markers]
base = { at = [0, { symbol = "b", default = 0.3 }, 0], rotation = { axis = [1, 2, 3], angle = 0.7 } }
[scene]
gravity = [0, 1, { symbol = "gz", default = -9.81 }]
[bodies.arm]
mass = { symbol = "m", default = 1.3 }
centre = [{ symbol = "c", default = 0.2 }, 0.1, 0]
inertia = [{ symbol = "J", default = 0.3 }, 0.4, 0.5, { symbol = "Jxy", default = 0.02 }, 0, 0.01]
markers.root = [0, 0, 0.1]
markers.tip = { at = [{ symbol = "l", default = 0.8 }, 0, 0], rotation = { axis = [0, 1, 1], angle = -0.4 } }
[bodies.bob]
mass = { symbol = "m2", default = 2 }
inertia = [0.2, 0.3, 0.25, 0, 0, 0]
markers.top = { at = [0, 0.3, 0], rotation = { axis = [1, 0, 1], angle = 1.1 } }
[joints.hinge]
kind = "revolute"
between = ["ground.base", "arm.root"]
[joints.cross]
kind = "universal"
between = ["arm.tip", "bob.top"]
[springs.mount]
between = ["ground.base", "bob.top"]
stiffness = { symbol = "ks", default = 30 }
damping = { symbol = "ds", default = 2 }
rest = { symbol = "rest", default = 0.4 }
[inputs.push]
value = "5"
[forces.push]
at = "bob.top"
force = [{ input = "push" }, 0, 1]
frame = "body"
[outputs.place]
kind = "position"
marker = "bob.top"
[outputs.support]
kind = "reaction"
joint = "hinge"
"""
SCENES: dict[str, Callable[[], Any]] = {
    "functions": lambda: parse(zoo.FUNCTIONS),
    "loads": lambda: parse(zoo.LOADS.replace("pieces = 3", "pieces = 2")),
    "tables": lambda: tables().spec,
    "stretching": lambda: parse(BEAM.replace("TERMS", "truncated").replace("AXIAL", AXIAL)),
    "full": lambda: parse(BEAM.replace("TERMS", "full").replace("AXIAL", "")),
    "point": lambda: derive.read(ROOT / "scenes" / "free_beam_point.toml"),
    "body": lambda: derive.symbolic_body("body", 2, frame="given", lowering="flat"),
    "reduced": lambda: parse(zoo.REDUCED),
    "space": lambda: parse(SPACE),
}
LOOPED = [f"looped {name}" for name in ("functions", "loads", "tables", "stretching", "space")]
"""Scenes with loops over their bodies, of which there are fewer than loops are worth."""
FLAT = [name for name in SCENES if name not in ("loads", "reduced", "full")]
LONG = [pytest.param(name, marks=pytest.mark.long) for name in ("loads", "full")]
FUNCTIONS = {f: getattr(mpmath, f) for f in ("sin", "cos", "sqrt", "exp", "log", "tanh", "atan2")}


@cache
def made(name: str) -> tuple[Model, tuple[derive.File, ...], Any]:
    scene = name.removeprefix("looped ")
    spec, lowered = SCENES[scene](), derive.lower if name == scene else lower_instances
    if lowered is lower_instances and isinstance(spec, SpatialScene):
        spec = replace(spec, coordinates="absolute")
    model = lowered(derive.derive(spec), sensitivities=True)
    files = emit(model, spec)
    return model, files, derive.load(files, QUICK)


def exact(model: Model, pu: np.ndarray, given: dict[str, Any]) -> np.ndarray:
    """The rows (rows, parameters and inputs) by central differences of setup, residuals and constraints."""
    settings: Any = {
        "number": lambda x: mpmath.mpf(x.numerator) / x.denominator,
        "functions": FUNCTIONS,
        "tables": {spline.name: spline for spline in model.splines},
        "check": False,
    }
    nq, nv, n = (sum(v.size for v in of) for of in (model.coordinates, model.velocities, model.multipliers))
    given |= {"q": given["y"][:nq], "v": given["y"][nq : nq + nv]}

    given |= {"vdot": given["ydot"][nq : nq + nv], "lam": given["y"][nq + nv :]}

    def rows(pu: list[Any]) -> np.ndarray:
        def value(kernel: str, output: str) -> list[Any]:
            result: list[Any] = interpret(model.kernel(kernel), given | {"k": k, "u": u}, **settings)[output]
            return result

        p, u = pu[: len(model.parameters)], pu[len(model.parameters) :]
        k = interpret(model.kernel("setup"), {"p": p}, **settings)["k"]
        dynamics = value("residual", "F")[nq : nq + nv]
        if not model.bodies:
            return np.array(dynamics)
        bias = value("residual_index1", "F")[-n:] if n else []
        outputs = value("outputs", "out") if model.outputs else []
        return np.array([*dynamics, *value("constraints", "g"), *value("constraint_rates", "gdot"), *bias, *outputs])

    h, columns = mpmath.mpf(10) ** -15, []
    for j in range(len(pu)):
        moved = [[mpmath.mpf(float(x)) + (i == j) * step for i, x in enumerate(pu)] for step in (h, -h)]
        columns.append((rows(moved[0]) - rows(moved[1])) / (2 * h))
    return np.array(columns).T


@pytest.mark.parametrize("name", [*FLAT, *LONG, *LOOPED, pytest.param("looped reduced", marks=pytest.mark.long)])
def test_they_are_the_derivatives_of_all_rows(name: str) -> None:
    model, files, native = made(name)
    rng = np.random.default_rng(5)
    p = native.defaults * rng.uniform(0.9, 1.1, native.np) + (native.defaults == 0) * rng.uniform(0.5, 1, native.np)
    t, q, v = state(native, 3)
    y = np.concatenate([q, v, rng.uniform(-2, 2, native.nlambda)])
    ydot = rng.uniform(-2, 2, len(y))
    u = np.full(len(model.inputs), 0.7)
    numbers = {n: [mpmath.mpf(float(x)) for x in a] for n, a in (("y", y), ("ydot", ydot))}
    with mpmath.workdps(50):
        expected = exact(model, np.append(p, u), {"t": mpmath.mpf(t), **numbers})
    k = native.setup(p)
    k = native.with_inputs(k, u) if len(u) else k
    close(native.parameter_pattern.dense(native.parameter_jacobian(t, y, ydot, k)), expected, 1e-13)
    module = run_module(files)
    values = module["parameter_jacobian"](t, y, ydot, *((u,) if len(u) else ()), module["setup"](p))
    close(native.parameter_pattern.dense(values), expected, 1e-13)
    structural = native.parameter_pattern.dense(np.ones(len(values))) != 0
    assert not np.any(np.abs(expected.astype(float))[~structural] > 0)
    # Branches and intervals are without parameters here and there; in space, products of rotations cancel.
    if not name.endswith(("functions", "tables", "space")):
        assert structural.sum() == (np.abs(expected.astype(float)) > 0).sum()


@pytest.mark.parametrize(
    "name", [LONG[0], "stretching", "point", "space", "looped loads", "looped stretching", "looped space"]
)
def test_the_solution_satisfies_its_equations(name: str) -> None:
    model, files, native = made(name)
    t, q = state(native, 4)[0], 0.3 * state(native, 4)[1]  # far enough from where M is not definite
    rng, k = np.random.default_rng(2), native.setup()
    a, b = rng.normal(size=native.nv), rng.normal(size=native.nlambda)
    x, lam = native.solve_kkt(t, q, k, a, b)
    M = native.mass_pattern.dense(native.mass(q, k))
    G = native.constraint_pattern.dense(native.constraint_jacobian(t, q, k)) if len(b) else np.zeros((0, len(a)))
    forces = abs(a) + abs(G.T) @ abs(lam)  # x is the free motion with that due to lambda, which cancel at joints
    assert worst(M @ x, a + G.T @ lam, abs(M) @ abs(x) + forces) < 1e-14
    assert not len(b) or worst(G @ x, b, abs(G) @ abs(np.linalg.inv(M)) @ forces) < 1e-14
    module = run_module(files)
    for values, expected in zip(
        module["solve_kkt"](t, q, *given_inputs(model), module["setup"](native.defaults), a, b), (x, lam), strict=True
    ):
        close(values, expected, 1e-11)


def given_inputs(model: Model) -> tuple[np.ndarray, ...]:
    """The argument u of the generated Python, if there is one."""
    return (np.zeros(len(model.inputs)),) if model.inputs else ()


def test_what_has_no_derivatives_says_so() -> None:
    native = derive.load(emit(derive.lower(derive.derive(SCENES["point"]())), SCENES["point"]()), QUICK)
    assert native.parameter_pattern is None
    y = np.zeros(native.nq + native.nv)
    with pytest.raises(CompilerError, match="generate it with sensitivities"):
        native.parameter_jacobian(0.0, y, y, native.setup())
    loops = derive.derive(derive.symbolic_body("body", 3, frame="given", lowering="loops"))
    with pytest.raises(derive.SpecError, match='lowering = "flat"'):
        derive.lower(loops, sensitivities=True)
