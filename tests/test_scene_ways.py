"""One scene in all ways: interpreter, generated Python and C give one number; reduced and whole bodies one motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import mpmath
import numpy as np
import pytest

import beams
import derive
from conftest import QUICK
from derive.ir.interpreter import interpret
from derive.runtime.loading import load_scene
from derive.runtime.native_scene import NativeScene
from derive.spec.model.planar_bodies import RigidBody
from derive.spec.model.scene import Scene

SCENES = Path(__file__).parent.parent / "scenes"

OUTPUTS = {
    "constraints": 1,
    "constraint_rates": 1,
    "constraint_jacobian": 1,
    "constraint_bias": 1,
    "solve": 2,
    "project_velocity": 1,
    "poses": 1,
}


@dataclass(frozen=True)
class Ways:
    """A scene as a model, as compiled C and as a Python module."""

    made: beams.Made
    native: NativeScene
    module: ModuleType


@cache
def ways() -> Ways:
    made = beams.build(derive.read(SCENES / "crank_slider_3.toml"))
    text = next(file.text for file in made.files if file.path.endswith(".py"))
    module = ModuleType("crank_slider_3")
    exec(compile(text, "crank_slider_3.py", "exec"), module.__dict__)
    return Ways(made, load_scene(made.files, QUICK), module)


def arguments(native: NativeScene, seed: int) -> Mapping[str, Any]:
    """A random state, near one in which all is regular."""
    rng = np.random.default_rng(seed)
    size = native.nq + native.nv + native.nlambda
    return {
        "t": 0.013 * seed,
        "q": rng.uniform(-0.2, 0.2, native.nq),
        "v": rng.uniform(-2, 2, native.nv),
        "k": native.setup(),
        "r": rng.uniform(-1, 1, native.nlambda),
        "y": rng.uniform(-0.3, 0.3, size),
        "ydot": rng.uniform(-1, 1, size),
        "cj": 7.5,
    }


@pytest.mark.parametrize("name", OUTPUTS)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_interpreter_python_and_c_agree(name: str, seed: int) -> None:
    way = ways()
    kernel = way.made.model.kernel(name)
    given = {a.name: arguments(way.native, seed)[a.name] for a in kernel.arguments}
    exact = interpret(
        kernel,
        {n: mpmath.mpf(x) if np.isscalar(x) else [mpmath.mpf(float(e)) for e in x] for n, x in given.items()},
        number=lambda x: mpmath.mpf(x.numerator) / x.denominator,
        functions={f: getattr(mpmath, f) for f in ("sin", "cos", "sqrt")},
    )
    plain = [np.array([float(x) for x in exact[o.name]]) for o in kernel.outputs]
    compiled = getattr(way.native, name)(*given.values())
    python = getattr(way.module, name)(*given.values())
    # What is solved for loses digits to the condition of the matrix; all else is a short sum.
    tolerance = 1e-9 if name in ("solve", "project_velocity") else 1e-13
    for found in (compiled, python):
        parts = found if isinstance(found, tuple) else (found,)
        for part, expected in zip(parts, plain, strict=True):
            assert np.allclose(np.ravel(part), expected, rtol=tolerance, atol=tolerance * np.abs(expected).max())


@pytest.mark.parametrize("form", ["index3", "ggl", "index1"])
def test_forms_agree_with_python(form: str) -> None:
    way = ways()
    dae = way.native.dae[form]
    rng = np.random.default_rng(4)
    y, ydot, k = rng.uniform(-0.3, 0.3, dae.size), rng.uniform(-1, 1, dae.size), way.native.setup()
    suffix = "" if form == "index3" else f"_{form}"
    residual = getattr(way.module, f"residual{suffix}")(0.01, y, ydot, k)
    jacobian = getattr(way.module, f"jacobian{suffix}")(0.01, y, ydot, 7.5, k)
    assert np.allclose(dae.residual(0.01, y, ydot, k), residual, rtol=1e-13, atol=1e-13 * np.abs(residual).max())
    assert np.allclose(dae.jacobian(0.01, y, ydot, 7.5, k), jacobian, rtol=1e-13, atol=1e-13 * np.abs(jacobian).max())


@pytest.mark.parametrize("form", ["index3", "ggl", "index1"])
def test_jacobians_of_the_forms_are_derivatives(form: str) -> None:
    """Derivatives are taken by complex steps through the generated Python, so that no digits are lost."""
    way = ways()
    dae = way.native.dae[form]
    rng = np.random.default_rng(5)
    y, ydot, k, cj, h = rng.uniform(-0.3, 0.3, dae.size), rng.uniform(-1, 1, dae.size), way.native.setup(), 7.5, 1e-30
    residual = getattr(way.module, "residual" if form == "index3" else f"residual_{form}")
    steps = 1j * h * np.eye(dae.size)
    columns = residual(0.01, y + steps, ydot + cj * steps, k).imag / h
    found = np.zeros((dae.size, dae.size))
    for (i, j), value in zip(dae.pattern.entries, dae.jacobian(0.01, y, ydot, cj, k), strict=True):
        found[i, j] = value
    assert np.allclose(found, columns.T, rtol=1e-12, atol=1e-12 * np.abs(columns).max())


def test_bodies_that_keep_their_coordinates_move_the_same_way() -> None:
    """Crank and slider with three coordinates each: other constraints, the same accelerations and reactions."""
    scene = derive.read(SCENES / "crank_slider_3.toml")
    assert isinstance(scene, Scene)
    small = way_of(replace(scene, name="small"))
    whole = way_of(replace(scene, name="whole", bodies=tuple(_kept(body) for body in scene.bodies)))
    assert (small.nlambda, whole.nlambda) == (10, 15)
    t, rng = 0.004, np.random.default_rng(6)
    shared = {name: rng.uniform(-0.1, 0.1) for name in small.coordinates}
    speeds = {name: rng.uniform(-1, 1) for name in small.coordinates}
    angle = 150 * t
    held = {"crank_phi": angle, "slider_c1": shared["slider_s"]}
    moving = {"crank_phi": 150.0, "slider_c1": speeds["slider_s"]}
    vdot, multipliers = small.solve(t, list(shared.values()), list(speeds.values()), small.setup())
    q = [held.get(name, shared.get(name, 0.0)) for name in whole.coordinates]
    v = [moving.get(name, speeds.get(name, 0.0)) for name in whole.coordinates]
    all_vdot, all_multipliers = whole.solve(t, q, v, whole.setup())
    of_whole = dict(zip(whole.coordinates, all_vdot, strict=True))
    of_whole["slider_s"] = of_whole["slider_c1"]
    reactions = dict(zip(whole.multipliers, all_multipliers, strict=True))
    scale = np.abs(vdot).max()
    for name, value in zip(small.coordinates, vdot, strict=True):
        assert of_whole[name] == pytest.approx(value, abs=1e-9 * scale), name
    for name, value in zip(small.multipliers, multipliers, strict=True):
        assert reactions[name] == pytest.approx(value, abs=1e-9 * np.abs(multipliers).max()), name
    # What the bearing and the drive exert holds a crank without acceleration of its centre against its pin.
    pin = np.array([reactions["crank_pin_1"], reactions["crank_pin_2"]])
    arm = 0.15 * np.array([np.cos(angle), np.sin(angle)])
    assert reactions["crank_bearing_1"] == pytest.approx(pin[0], rel=1e-9)
    assert reactions["crank_bearing_2"] == pytest.approx(pin[1], rel=1e-9)
    assert reactions["motor"] == pytest.approx(arm[0] * pin[1] - arm[1] * pin[0], rel=1e-8)


def way_of(scene: Scene) -> NativeScene:
    return load_scene(beams.build(scene).files, QUICK)


def _kept(body: Any) -> Any:
    """A rigid body with all of its coordinates; the crank has its centre of mass in the bearing."""
    if not isinstance(body, RigidBody):
        return body
    return replace(
        body, mass=body.mass or Fraction(1, 5), inertia=body.inertia or Fraction(1, 900), keep_coordinates=True
    )
