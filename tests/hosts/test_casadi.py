"""`--to casadi`: the external function and all its derivatives, against those that CasADi takes of the kernels."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from importlib.metadata import version
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from host_models import EVERYWHERE, FLEXIBLE_IN_SPACE, LINKS, PUSHED, STEERED, looked_up
from programs import program, run

import derive
from conftest import ROOT
from derive.export.casadi.graph import model_graph
from derive.export.host_model import HostModel, host_model
from derive.export.interface import exported_files
from derive.export.registry import INTERFACES
from derive.spec.toml.read import parse

pytestmark = pytest.mark.hosts

TIMED = PUSHED.replace('"pushed"', '"timed"').replace(
    'components = [{ input = "push" }, 0]', 'components = [{ input = "push" }, "sin(3*t)"]'
)
MODELS = {
    "pushed": lambda: parse(PUSHED),
    "steered": lambda: parse(STEERED),
    "timed": lambda: parse(TIMED),
    "looked_up": looked_up,
    "four_bar": lambda: derive.read(ROOT / "scenes/four_bar.toml"),
    "spinning_beam": lambda: derive.read(ROOT / "scenes/spinning_beam.toml"),
    "block": lambda: replace(derive.read(ROOT / "scenes/block.toml"), lowering="flat"),
    **{name: partial(parse, text) for name, text in (EVERYWHERE | FLEXIBLE_IN_SPACE | LINKS).items()},
}
"""A force, a prescribed motion, a function of the time, a table, a scene without ports, bodies in plane and space."""

TIMED_MODELS = ("timed", "looked_up", "four_bar", "spinning_beam")
"""The models with functions of time, by which CasADi takes no derivatives."""
WARNINGS = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("casadi")


@cache
def host_of(name: str) -> HostModel:
    return host_model(MODELS[name](), sensitivities=True)


@cache
def library(name: str, folder: Path) -> Path:
    """The shared library of a model, compiled without warnings."""
    derive.write(exported_files(host_of(name), "casadi", INTERFACES["casadi"]), folder)
    sources = [folder / f"{name}-casadi/{part}.c" for part in (f"{name}_casadi", name, "ode")]
    run(program("gcc"), *WARNINGS, "-O1", "-shared", "-fPIC", *sources, "-o", folder / f"{name}.so", "-lm")
    return folder / f"{name}.so"


@cache
def graph(name: str) -> ca.Function:
    """The function in CasADi's symbols."""
    return model_graph(host_of(name))


def point(host: HostModel, rng: np.random.Generator) -> list[np.ndarray]:
    """t, x, u and p near the start."""
    x, u, p = (np.array([v.start for v in part]) for part in (host.states, host.inputs, host.parameters))
    return [np.array(0.7), x + 0.1 * rng.standard_normal(x.size), u + rng.standard_normal(u.size), 1.1 * p]


def close(values: ca.DM, exact: ca.DM) -> bool:
    difference = np.abs(np.array(values) - np.array(exact))
    return values.shape == exact.shape and bool(
        np.all(difference <= 1e-11 * np.max(np.abs(np.array(exact)), initial=0))
    )


@pytest.mark.parametrize("name", MODELS)
def test_values_and_jacobians(name: str, folder: Path) -> None:
    host, own = host_of(name), graph(name)
    function = ca.external(name, str(library(name, folder)))
    at = point(host, np.random.default_rng(1))
    values, exact = function.call(at), own.call(at)
    assert all(map(close, values, exact))
    assert (function.name_in(), function.name_out()) == (own.name_in(), own.name_out())
    blocks, theirs = function.jacobian().call(at + values), own.jacobian().call(at + exact)
    for block, other, key in zip(blocks, theirs, function.jacobian().name_out(), strict=True):
        if key in ("jac_xdot_t", "jac_y_t"):
            assert block.nnz() == 0 and function.is_diff_in(0) == (name not in TIMED_MODELS)
        else:
            assert block.sparsity() == other.sparsity() and close(block, other), key


@pytest.mark.parametrize("name", MODELS)
def test_products_with_the_jacobians(name: str, folder: Path) -> None:
    host, own = host_of(name), graph(name)
    function, rng = ca.external(name, str(library(name, folder))), np.random.default_rng(2)
    at = point(host, rng)
    values = own.call(at)
    forward = [ca.DM(0), *(ca.DM(rng.standard_normal(x.size)) for x in at[1:])]
    for ours, theirs in zip(*(f.forward(1).call([*at, *values, *forward]) for f in (function, own)), strict=True):
        assert close(ours, theirs)
    reverse = [ca.DM(rng.standard_normal(y.shape)) for y in values]
    results = [f.reverse(1).call([*at, *values, *reverse])[1:] for f in (function, own)]
    for ours, theirs in zip(*results, strict=True):
        assert close(ours, theirs)


@pytest.mark.parametrize("name", FLEXIBLE_IN_SPACE)
def test_accelerations_of_flexible_bodies_in_space_are_those_of_the_c(name: str, folder: Path) -> None:
    """In several states beside the start, to 1e-12 of the largest; CasADi calls the library, and our runtime the C."""
    host, function = host_of(name), ca.external(name, str(library(name, folder)))
    native, rng = derive.load(host.files), np.random.default_rng(5)
    for _ in range(5):
        _, x, u, p = point(host, rng)
        x[7 : native.nq] *= 0.01  # amplitudes
        e0 = native.coordinates.index("rod_e0")
        x[e0 : e0 + 4] /= np.linalg.norm(x[e0 : e0 + 4])
        q, v, k = x[: native.nq], x[native.nq :], native.with_inputs(native.setup(p), u)
        exact = np.concatenate([native.rates(q, v, k), native.solve(0.0, q, v, k)[0]])
        assert np.array(function(0, x, u, p)[0]).ravel() == pytest.approx(exact, rel=0, abs=1e-12 * np.abs(exact).max())


def test_the_initial_values(folder: Path) -> None:
    host = host_of("steered")
    initial = ca.external("steered_initial", str(library("steered", folder)))()
    for key, part in (("x", host.states), ("u", host.inputs), ("p", host.parameters)):
        assert np.array(initial[key]).ravel().tolist() == [v.start for v in part]


def test_a_failure_of_the_model_is_one_of_the_function(folder: Path) -> None:
    """A stiffness that is not finite."""
    host = host_of("pushed")
    function = ca.external("pushed", str(library("pushed", folder)))
    at = point(host, np.random.default_rng(1))
    for f, arguments in ((function, at), (function.jacobian(), [*at, 0, 0])):
        with pytest.raises(RuntimeError, match="pushed"):
            f.call([*arguments[:3], ca.DM(np.nan), *arguments[4:]])


def test_an_expression_of_the_function_has_sparse_derivatives(folder: Path) -> None:
    """Problems of optimal control use derivatives in this way: through an integration step."""
    host = host_of("pushed")
    at = point(host, np.random.default_rng(3))[1:]
    results = []
    for f in (ca.external("pushed", str(library("pushed", folder))), graph("pushed")):
        x, u, p = (ca.MX.sym(name, value.size) for name, value in zip("xup", at, strict=True))
        end = x + 0.01 * f(0, x + 0.005 * f(0, x, u, p)[0], u, p)[0]
        results.append(ca.Function("step", [x, u, p], [ca.jacobian(end, ca.vertcat(x, u, p))])(*at))
    assert close(*results) and results[0].nnz() < results[0].numel()


def test_the_page_states_the_version_that_is_tried() -> None:
    stated = (ROOT / "docs/hosts.md").read_text()
    assert f"Tried with CasADi {version('casadi')}" in stated
