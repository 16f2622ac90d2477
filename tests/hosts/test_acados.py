"""`--to acados`: its expressions in CasADi, and the C that CasADi generates of them, have the numbers of our C.

acados itself is not run: it takes the expressions, and generates C of them as this test does.
"""

from __future__ import annotations

import importlib.util
import sys
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType, SimpleNamespace

import casadi as ca
import numpy as np
import pytest
from host_models import EVERYWHERE, FLEXIBLE_IN_SPACE, PUSHED, STEERED, looked_up
from programs import program, run

import derive
from conftest import ROOT
from derive.spec.toml.read import parse

pytestmark = pytest.mark.hosts

MODELS = {
    "pushed": lambda: parse(PUSHED),
    "steered": lambda: parse(STEERED),
    "looked_up": looked_up,
    "block": lambda: replace(derive.read(ROOT / "scenes/block.toml"), lowering="flat"),
    **{name: partial(parse, text) for name, text in (EVERYWHERE | FLEXIBLE_IN_SPACE).items()},
}
"""A force, a prescribed motion, a table, a body in space."""


@cache
def made(name: str) -> tuple[derive.Native, ModuleType]:
    """The C of a model, and its file for acados."""
    spec = MODELS[name]()
    with TemporaryDirectory() as folder:
        derive.write(derive.exported(spec, "acados"), folder)
        path = f"{folder}/{name}-acados/{name}_acados.py"
        found = importlib.util.spec_from_file_location(f"{name}_acados", path)
        module = importlib.util.module_from_spec(found)
        found.loader.exec_module(module)
    return derive.load(derive.host_model(spec).files), module


def evaluated(name: str) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Values of the symbols near the start, and what our C computes there."""
    native, module = made(name)
    rng = np.random.default_rng(4)
    x, u = np.array(module.X), np.array(module.U)
    x, u, p = x + 0.1 * rng.standard_normal(x.size), u + rng.standard_normal(u.size), 1.1 * np.array(module.P)
    for i in (i for i, name in enumerate(native.coordinates) if name.endswith("e0")):  # accelerations need unit length
        x[i : i + 4] /= np.linalg.norm(x[i : i + 4])
    q, v, k = x[: native.nq], x[native.nq :], native.setup(p)
    k = native.with_inputs(k, u) if u.size else k
    vdot, z = native.solve(0.3, q, v, k) if native.nlambda else (native.accel(0.3, q, v, k), np.empty(0))
    xdot = np.concatenate([native.rates(q, v, k), vdot])
    y = native.evaluate_outputs(0.3, q, v, vdot, z, k) if module.OUTPUTS else np.empty(0)
    form = native.dae["index1"] if native.nlambda else native
    pattern = form.pattern if native.nlambda else native.jacobian_pattern
    ys = np.append(x, z), np.append(xdot, 0 * z)
    jacobian = pattern.dense(form.jacobian(0.3, *ys, 0.0, k))
    return {"t": np.array(0.3), "x": x, "xdot": xdot, "u": u, "z": z, "p": p}, {"f": xdot, "y": y, "jacobian": jacobian}


def value(expression: ca.SX, symbols: SimpleNamespace, at: dict[str, np.ndarray]) -> np.ndarray:
    names = [name for name in at if name != "z" or symbols.z.numel()]
    function = ca.Function("f", [getattr(symbols, name) for name in names], [expression])
    return np.array(function(*(at[name] for name in names)))


def close(values: np.ndarray, exact: np.ndarray) -> bool:
    size = np.max(np.abs(exact), initial=0)
    return bool(np.max(np.abs(values.reshape(exact.shape) - exact), initial=0) <= 1e-12 * size)


@pytest.mark.parametrize("name", MODELS)
def test_the_explicit_form(name: str) -> None:
    at, exact = evaluated(name)
    symbols = made(name)[1].expressions()
    assert close(value(symbols.f_expl_expr, symbols, at), exact["f"])
    assert close(value(symbols.y, symbols, at), exact["y"])
    assert np.max(np.abs(value(symbols.f_impl_expr, symbols, at))) <= 1e-12 * np.max(np.abs(exact["f"]))


@pytest.mark.parametrize("name", MODELS)
def test_the_implicit_form(name: str) -> None:
    """It vanishes with the accelerations and multipliers of the C, and has the derivatives of its form of index 1."""
    at, exact = evaluated(name)
    symbols = made(name)[1].expressions(implicit=True)
    jacobian = ca.jacobian(symbols.f_impl_expr, ca.vertcat(symbols.x, symbols.z))
    assert close(value(jacobian, symbols, at), exact["jacobian"])
    assert np.max(np.abs(value(symbols.f_impl_expr, symbols, at))) <= 1e-11 * np.max(np.abs(exact["jacobian"]))


def test_the_c_that_casadi_generates(tmp_path: Path) -> None:
    at, exact = evaluated("pushed")
    symbols = made("pushed")[1].expressions()
    names = ("x", "u", "p")
    arguments = [getattr(symbols, name) for name in names]
    results = [symbols.f_expl_expr, ca.jacobian(symbols.f_expl_expr, symbols.x)]
    generator = ca.CodeGenerator("ode.c")
    generator.add(ca.Function("ode", arguments, results))
    generator.generate(f"{tmp_path}/")
    run(program("gcc"), "-O1", "-shared", "-fPIC", tmp_path / "ode.c", "-o", tmp_path / "ode.so", "-lm")
    f, by_state = ca.external("ode", str(tmp_path / "ode.so"))(*(at[name] for name in names))
    assert close(np.array(f), exact["f"])
    assert close(np.array(by_state), value(results[1], symbols, at))


@pytest.mark.parametrize("implicit", [False, True])
def test_the_fields_of_the_model(implicit: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """The model has the fields that acados documents; here a class of that name without anything else receives them."""
    monkeypatch.setitem(sys.modules, "acados_template", SimpleNamespace(AcadosModel=SimpleNamespace))
    model = made("pushed")[1].acados_model(implicit)
    fields = {"name", "t", "x", "xdot", "u", "z", "p", "f_impl_expr", "cost_y_expr"}
    assert vars(model).keys() == fields | (set() if implicit else {"f_expl_expr"})
    assert model.z.numel() == (2 if implicit else 0) and model.f_impl_expr.numel() == model.x.numel() + model.z.numel()
    free = {str(s) for s in ca.symvar(model.f_impl_expr)}
    known = {str(s) for s in ca.symvar(ca.vertcat(model.t, model.x, model.xdot, model.u, model.z, model.p))}
    assert free <= known
