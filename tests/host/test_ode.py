"""The first-order form of a model and its derivatives in C, against differences."""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from toolchain import C99, CPP11, WARNINGS, run, tool

import derive
from conftest import QUICK, ROOT
from derive.backends.model_files import emit
from derive.generated_models import generated
from derive.runtime.integrators.compilation import header_flags, write_sources
from derive.runtime.loading import shared_library
from derive.runtime.native_scene import NativeScene
from derive.spec.toml.read import parse

LINKAGE = """
name = "linkage"
scene.gravity = [0, -9.81]
ground.markers = { a = [0, 0], b = [{ symbol = "distance", default = 1.5 }, 0] }
[bodies.left]
mass = { symbol = "m", default = 1.3 }
length = { symbol = "l", default = 1.2 }
bending_stiffness = { symbol = "EI", default = 7 }
markers = { end = -1, tip = 1 }
start = { position = [0.4, 0.4], angle = 0.8, guess = true }
[bodies.right]
mass = 0.7
inertia = 0.1
markers = { tip = [-0.5, 0], end = [0.5, 0.1] }
start = { position = [1.2, 0.4], angle = -0.6, guess = true }
[bodies.slider]
mass = 0.4
inertia = 0.05
markers = { pin = [0, 0] }
start = { position = [1.6, 0.1], guess = true }
[joints.first]
kind = "revolute"
between = ["ground.a", "left.end"]
start = { speed = 0.4, guess = true }
[joints.middle]
kind = "revolute"
between = ["left.tip", "right.tip"]
[joints.last]
kind = "revolute"
between = ["right.end", "slider.pin"]
[joints.guide]
kind = "translational"
between = ["ground.b", "slider.pin"]
axis = [1, 0.2]
[inputs.push]
value = "2"
[forces.push]
at = "slider.pin"
components = [{ input = "push" }, 0]
[outputs.tip]
kind = "position"
marker = "left.tip"
[outputs.support]
kind = "reaction"
joint = "first"
[outputs.acceleration]
kind = "acceleration"
marker = "right.end"
[simulation]
duration = 1
output = 0.1
"""


class Ode:
    """The C of a model with `ode.c`, called with NumPy."""

    def __init__(self, spec: Any) -> None:
        model = derive.lower(derive.derive(spec), sensitivities=True)
        with tempfile.TemporaryDirectory() as folder:
            name, paths = write_sources(emit(model, spec), ["ode"], Path(folder))
            self.library = shared_library(paths, Path(folder), [*QUICK, *header_flags(name, Path(folder))])
        self.native = NativeScene(self.library, name)
        self.model, self.n = ctypes.c_void_p(self.native.address), self.native.nq + self.native.nv
        self.work = np.empty(self.library.tisserand_ode_work(self.model))
        self.inputs = len(model.inputs)

    def constants(self, pu: np.ndarray) -> np.ndarray:
        k = np.array(self.native.setup(pu[: self.native.np]))
        k[len(k) - self.inputs :] = pu[self.native.np :]
        return k

    def call(self, name: str, k: np.ndarray, t: float, *arguments: np.ndarray | int | None) -> int:
        class Structure(ctypes.Structure):
            _fields_ = [(member, ctypes.c_void_p) for member in ("model", "k", "work")]

        own = Structure(self.model, k.ctypes.data, self.work.ctypes.data)
        given = [ctypes.c_void_p(a.ctypes.data) if isinstance(a, np.ndarray) else a for a in arguments]
        code: int = getattr(self.library, f"tisserand_ode_{name}")(ctypes.byref(own), ctypes.c_double(t), *given)
        return code

    def rates(self, k: np.ndarray, t: float, y: np.ndarray) -> np.ndarray:
        ydot = np.empty(self.n)
        assert self.call("rates", k, t, y, ydot) == 0
        return ydot


SPECS: dict[str, Callable[[], Any]] = {
    "linkage": lambda: parse(LINKAGE),
    "planar": lambda: derive.read(ROOT / "scenes/free_beam_point.toml"),
    "spatial": lambda: derive.symbolic_body("body", 2, frame="given", lowering="flat"),
}


@cache
def made(name: str) -> Ode:
    return Ode(SPECS[name]())


def point(ode: Ode, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Parameters and inputs, and a state (consistent for the linkage)."""
    rng = np.random.default_rng(7)
    defaults = ode.native.defaults
    p = defaults + (defaults == 0) * rng.uniform(0.5, 1.0, len(defaults))
    pu = np.append(p, rng.uniform(1, 2, ode.inputs))
    if name == "linkage":
        start = derive.initial_state(SPECS[name](), ode.native, ode.constants(pu))
        return pu, np.concatenate([start.q, start.v])
    y = rng.uniform(-0.3, 0.3, ode.n)
    if name == "spatial":
        y[3:7] = [0.9, 0.1, -0.2, 0.3]
        y[3:7] /= np.linalg.norm(y[3:7])
        large = ("m", "C3_11_", "C3_22_", "C3_33_", "c8_1_1_", "c8_2_2_")  # so that M is definite
        pu = np.array([5.0 if p in large else x for p, x in zip(ode.native.parameters, 0.1 * pu, strict=True)])
    return pu, y


def difference(function: Callable[[float], np.ndarray], h: float) -> np.ndarray:
    """The derivative at 0, with an error of order h^4."""
    near, far = ((function(s) - function(-s)) / (2 * s) for s in (h, 2 * h))
    return np.asarray((4 * near - far) / 3)


@pytest.mark.parametrize("name", SPECS)
def test_changes_are_derivatives(name: str) -> None:
    ode, t = made(name), 0.3
    pu, y = point(ode, name)
    k, change = ode.constants(pu), np.empty(ode.n)
    ydot = ode.rates(k, t, y)
    assert ode.call("linearise", k, t, y) == 0
    scale = np.abs(ydot).max()
    for i in range(ode.n):
        unit = np.eye(ode.n)[i]
        assert ode.call("change", k, t, y, unit, -1, change) == 0
        expected = difference(lambda s, unit=unit: ode.rates(k, t, y + s * unit), 1e-4)  # type: ignore[misc]
        assert change == pytest.approx(expected, abs=1e-7 * max(scale, np.abs(expected).max()))
        assert ode.call("linearise", k, t, y) == 0
    moved = np.random.default_rng(1).normal(size=ode.n)
    for j in range(len(pu)):

        def along(s: float, j: int = j) -> np.ndarray:
            return ode.rates(ode.constants(pu + s * (np.arange(len(pu)) == j)), t, y + s * moved)

        expected = difference(along, 1e-4)
        assert ode.call("linearise", k, t, y) == 0
        assert ode.call("change", k, t, y, moved, j, change) == 0
        assert change == pytest.approx(expected, abs=1e-7 * max(scale, np.abs(expected).max()))


@pytest.mark.parametrize("name", SPECS)
def test_outputs_have_derivatives_and_all_are_transposed(name: str) -> None:
    ode, t = made(name), 0.3
    pu, y = point(ode, name)
    k, nout = ode.constants(pu), len(ode.native.outputs) if name == "linkage" else 0
    assert (nout > 0) == (name == "linkage")

    def values(pu: np.ndarray, y: np.ndarray) -> np.ndarray:
        ydot, multipliers, out = np.empty(ode.n), np.empty(20), np.empty(nout)
        assert ode.call("evaluate", ode.constants(pu), t, y, ydot, multipliers, out) == 0
        return np.append(ydot, out)

    assert ode.call("linearise", k, t, y) == 0
    rng, results = np.random.default_rng(3), np.empty(ode.n + nout)
    dy, dpu = rng.normal(size=ode.n), rng.normal(size=len(pu)) * np.abs(pu)
    assert ode.call("directional", k, t, y, dy, dpu, results[: ode.n], results[ode.n :]) == 0
    expected = difference(lambda s: values(pu + s * dpu, y + s * dy), 1e-4)
    assert results == pytest.approx(expected, abs=2e-7 * np.abs(expected).max())
    assert ode.call("linearise", k, t, y) == 0
    weights, gradient = rng.normal(size=ode.n + nout), np.empty(ode.n + len(pu))
    assert ode.call("adjoint", k, t, y, weights[: ode.n], weights[ode.n :], gradient[: ode.n], gradient[ode.n :]) == 0
    assert gradient @ np.append(dy, dpu) == pytest.approx(weights @ results, rel=1e-11)


def test_start_states_stay_consistent() -> None:
    """States are consistent to second order in the change; q and v change least in the metric of M."""
    ode, t, h = made("linkage"), 0.0, 1e-4
    native: Any = ode.native
    pu, y = point(ode, "linkage")
    dy = np.empty(ode.n)
    for name in ("distance", "l", "EI"):
        j = native.parameters.index(name)
        assert ode.call("start_change", ode.constants(pu), t, y, j, dy) == 0
        for found, functions in ((0, "constraints"), (1, "constraint_rates")):

            def along(s: float, functions: str = functions, found: int = found, j: int = j) -> np.ndarray:
                k, at = ode.constants(pu + s * (np.arange(len(pu)) == j)), y + s * dy
                q, v = at[: native.nq], at[native.nq :]
                return np.asarray(getattr(native, functions)(t, q, *((v,) if found else ()), k))

            assert np.abs(difference(along, h)).max() < 1e-9
        assert (np.abs(dy).max() > 0.01) == (name != "EI")
        M = native.mass_pattern.dense(native.mass(y[: native.nq], ode.constants(pu)))
        G = native.constraint_pattern.dense(native.constraint_jacobian(t, y[: native.nq], ode.constants(pu)))
        lam = np.linalg.lstsq(G.T, M @ dy[: native.nq], rcond=None)[0]
        assert np.abs(G.T @ lam - M @ dy[: native.nq]).max() < 1e-12  # no part along the constraints


def test_models_without_sensitivities_say_so() -> None:
    spec = SPECS["planar"]()
    ode = made("planar")
    files = generated(spec)[1]
    native = derive.load(files, QUICK)
    kept, ode.model = ode.model, ctypes.c_void_p(native.address)
    try:
        assert ode.call("linearise", native.setup(), 0.0, np.zeros(ode.n)) == 6
        assert ode.call("change", native.setup(), 0.0, np.zeros(ode.n), None, 0, np.empty(ode.n)) == 6
    finally:
        ode.model = kept


@pytest.mark.parametrize("language", [("gcc", *C99), ("g++", *CPP11), ("clang", *C99)], ids=["C", "C++", "clang"])
def test_no_warnings(language: tuple[str, ...], tmp_path: Path) -> None:
    spec = SPECS["planar"]()
    name, _ = write_sources(generated(spec)[1], ["ode"], tmp_path)
    flags = (*WARNINGS, *header_flags(name, tmp_path))
    run(tool(language[0]), *language[1:], "-O2", *flags, "-c", tmp_path / "ode.c", "-o", tmp_path / "ode.o")
