"""`--to jax`: under NumPy and JAX the numbers are those of the C, and gradients are the generated Jacobians."""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from functools import cache, partial
from tempfile import TemporaryDirectory
from types import ModuleType

import numpy as np
import pytest
from host_models import EVERYWHERE, PUSHED, STEERED, looked_up
from programs import package

import derive
from conftest import ROOT
from derive.errors import SpecError
from derive.export.host_model import HostModel, host_model
from derive.export.jax import SLOW
from derive.export.registry import INTERFACES
from derive.spec.toml.read import parse

pytestmark = pytest.mark.hosts

MODELS = {
    "pushed": lambda: parse(PUSHED),
    "steered": lambda: parse(STEERED),
    "looked_up": looked_up,
    "four_bar": lambda: derive.read(ROOT / "scenes/four_bar.toml"),
    "block": lambda: replace(derive.read(ROOT / "scenes/block.toml"), lowering="flat"),
    **{name: partial(parse, text) for name, text in EVERYWHERE.items()},
}
"""A force, a prescribed motion, a table and a step, a scene without ports, a body in space."""


@pytest.fixture(scope="module")
def jax() -> ModuleType:
    module = package("jax")
    module.config.update("jax_enable_x64", True)
    return module


@cache
def made(name: str) -> tuple[HostModel, derive.Native, ModuleType]:
    """A model as hosts see it, its C, and its module."""
    spec = MODELS[name]()
    with TemporaryDirectory() as folder:
        derive.write(derive.exported(spec, "jax"), folder)
        found = importlib.util.spec_from_file_location(f"jax_{name}", f"{folder}/{name}-jax/{name}.py")
        module = importlib.util.module_from_spec(found)
        found.loader.exec_module(module)
    host = host_model(spec)
    return host, derive.load(host.files), module


def point(module: ModuleType, seed: int) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
    """t, x, u and p near the start."""
    rng = np.random.default_rng(seed)
    x, u = np.array(module.X), np.array(module.U)
    return 0.3, x + 0.1 * rng.standard_normal(x.size), u + rng.standard_normal(u.size), 1.1 * np.array(module.P)


def of_the_c(host: HostModel, native: derive.Native, at: tuple) -> tuple[np.ndarray, np.ndarray]:
    t, x, u, p = at
    q, v = x[: native.nq], x[native.nq :]
    k = native.with_inputs(native.setup(p), u) if host.inputs else native.setup(p)
    xdot = np.concatenate([native.rates(q, v, k), native.accel(t, q, v, k)])
    return xdot, native.evaluate_outputs(t, q, v, *native.solve(t, q, v, k), k) if host.outputs else np.empty(0)


def close(values: object, exact: np.ndarray) -> bool:
    values = np.asarray(values)
    scale = np.max(np.abs(exact), initial=0)
    return values.shape == exact.shape and bool(np.all(np.abs(values - exact) <= 1e-12 * scale))


@pytest.mark.parametrize("name", MODELS)
def test_numbers_are_those_of_the_c(name: str, jax: ModuleType) -> None:
    host, native, module = made(name)
    at = point(module, 1)
    exact = of_the_c(host, native, at)
    assert all(map(close, module.rhs(*at), exact))
    assert isinstance(module.rhs(*at)[0], np.ndarray)
    looped = host.model.lowering == "instances"
    assert INTERFACES["jax"].notes(host) == ((SLOW,) if looped else ())
    values = module.rhs(*map(jax.numpy.asarray, at)) if looped else jax.jit(module.rhs)(*at)
    assert all(map(close, values, exact))
    assert isinstance(values[0], jax.Array)


@pytest.mark.parametrize("name", ["pushed", "steered", "looked_up", "block"])
def test_gradients_are_the_generated_jacobian(name: str, jax: ModuleType) -> None:
    """dF/dy of the residual, in forward and in reverse mode."""
    host, native, module = made(name)
    t, x, u, p = point(module, 2)
    rng = np.random.default_rng(3)
    y = np.append(x, rng.standard_normal(native.nlambda))
    ydot, k = rng.standard_normal(y.size), module.setup(p)
    own = native.with_inputs(native.setup(p), u) if host.inputs else native.setup(p)
    exact = native.jacobian_pattern.dense(native.jacobian(t, y, ydot, 0.0, own))
    rest = (u, k) if host.inputs else (k,)
    for mode in (jax.jacfwd, jax.jacrev):
        assert close(jax.jit(mode(module.residual, 1))(t, y, ydot, *rest), exact)


def test_many_states_at_once(jax: ModuleType) -> None:
    """Many states are computed by vmap, and by a leading axis of NumPy."""
    host, native, module = made("pushed")
    t, _, u, p = point(module, 1)
    states = np.array([point(module, seed)[1] for seed in range(5)])
    for results in (jax.vmap(module.rhs, (None, 0, None, None))(t, states, u, p), module.rhs(t, states, u, p)):
        for k, x in enumerate(states):
            assert all(map(close, (result[k] for result in results), of_the_c(host, native, (t, x, u, p))))


def test_failures_are_nan(jax: ModuleType) -> None:
    """Where the C returns a code, results are NaN without an error, in a batch for the failing states alone."""
    _, native, module = made("pushed")
    t, x, u, _ = point(module, 1)
    with pytest.raises(derive.ModelError):
        native.setup([np.inf])
    assert np.all(np.isnan(jax.jit(module.setup)(np.array([np.inf]))))
    bad = np.array([x, np.where(np.arange(x.size) == 2, np.nan, x)])
    xdot, _ = jax.jit(module.rhs)(t, bad, u, np.array(module.P))
    assert np.all(np.isfinite(xdot[0])) and np.all(np.isnan(xdot[1][native.nq :]))


def test_wrong_sizes_and_loops_are_refused() -> None:
    *_, module = made("pushed")
    with pytest.raises(ValueError, match="p needs 1 elements along its last axis"):
        module.setup(np.ones(2))
    spec = replace(derive.read(ROOT / "scenes/block.toml"), lowering="loops")
    with pytest.raises(SpecError, match="straight-line code"):
        derive.exported(spec, "jax")


def test_the_page_states_the_version_that_is_tried(jax: ModuleType) -> None:
    assert f"Tried with JAX {jax.__version__} " in (ROOT / "docs/hosts.md").read_text()
