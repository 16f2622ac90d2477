"""The generated Python: NumPy alone, leading batch axes for every function, and the numbers of the C."""

from __future__ import annotations

import ast
import itertools
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from generated_sine import sines
from toolchain import EVERY_MODEL, MODELS, OTHERS, run, text_of, written

import beams
import derive
from conftest import QUICK
from derive.ir.kernel import Kernel
from derive.runtime.compiled_model import Native
from derive.runtime.native_call import ModelError

SOME = (
    *("mean_2", "point_2", "tangent_2", "folded_mean", "folded_point", "half_folded", "no_markers", "unlucky_names"),
    *("given_2_flat", "block_flat"),
)
OF_SOME = [pytest.param(name, marks=pytest.mark.long if name in OTHERS else ()) for name in SOME]

BATCHES = {
    "t": (3, 1),
    "cj": (4,),
    "q": (3, 4),
    "v": (4,),
    "y": (3, 4),
    "ydot": (3, 1),
    "F": (4,),
    "k": (4,),
    "p": (3, 4),
}
"""Leading axes that broadcast to (3, 4), different ones for each argument."""


@cache
def module(model: str) -> dict[str, Any]:
    """The names of the generated Python of one of MODELS."""
    return beams.run_module(MODELS[model]().files)


@cache
def native(model: str) -> Native:
    """The compiled C; sine and cosine are called one by one, as Python calls them."""
    return derive.load(MODELS[model]().files, (*QUICK, "-fno-builtin"))


def arguments(model: str, kernel: Kernel, batches: dict[str, tuple[int, ...]] | None = None) -> list[np.ndarray]:
    """Arguments of a kernel, those in `batches` with leading axes."""
    rng = np.random.default_rng(0)
    names, found = module(model), []
    for argument in kernel.arguments:
        batch = (batches or {}).get(argument.name, ())
        own = () if argument.scalar else (argument.size,)
        if argument.name in ("p", "k"):
            p = np.array(names["DEFAULTS"]) * rng.uniform(0.5, 2.0, (*batch, len(names["DEFAULTS"])))
            found.append(p if argument.name == "p" else names["setup"](p))
        else:
            found.append(rng.uniform(-0.5, 0.5, (*batch, *own)))
    return found


def as_tuple(values: Any) -> tuple[np.ndarray, ...]:
    return values if isinstance(values, tuple) else (values,)


def by_c(model: str, name: str, given: list[Any]) -> tuple[np.ndarray, ...]:
    """The outputs of a function in C."""
    if name.startswith("marker_"):
        return native(model).marker(name.removeprefix("marker_"), *given)
    if name.startswith("load_"):
        return (native(model).load(name.removeprefix("load_"), *given),)
    return as_tuple(getattr(native(model), name)(*given))


class PlainNumPy:
    """NumPy with the sine and cosine of the generated C in place of its own."""

    @staticmethod
    def sin(x: float) -> float:
        return float(sines(np.array([x]))[0][0])

    @staticmethod
    def cos(x: float) -> float:
        return float(sines(np.array([x]))[1][0])

    def __getattr__(self, name: str) -> Any:
        return getattr(np, name)


# What it needs, what it says


@pytest.mark.parametrize("model", EVERY_MODEL)
def test_imports_numpy_alone(model: str) -> None:
    tree = ast.parse(text_of(MODELS[model](), ".py"))
    imported = {n.module for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)}
    imported |= {alias.name for n in ast.walk(tree) if isinstance(n, ast.Import) for alias in n.names}
    assert imported - sys.stdlib_module_names == {"numpy"}


def test_runs_without_tisserand(tmp_path: Path) -> None:
    (source,) = written(beams.made("point", 2).files, tmp_path)
    program = """
import sys
sys.path.insert(0, ".")
import beam_point_2 as beam
k = beam.setup(beam.DEFAULTS)
print(beam.energy([0, 0, 1, 0.1, 0.2], [1, 2, 3, 4, 5], k).shape)
print(sorted({"derive", "sympy", "casadi", "scipy", "jinja2"} & set(sys.modules)))
"""
    assert run(sys.executable, "-I", "-W", "error", "-c", program, cwd=source.parent) == "(2,)\n[]\n"


@pytest.mark.parametrize("model", OF_SOME)
def test_describes_the_model(model: str) -> None:
    names, c = module(model), native(model)
    assert names["NAME"] == c.name
    assert names["COORDINATES"] == c.coordinates
    assert names["PARAMETERS"] == c.parameters
    assert names["DEFAULTS"] == tuple(c.defaults)
    assert names["MARKERS"] == c.markers
    assert len(names["CONSTANTS"]) == c.nk
    assert len(names["UNITS"]) == c.np
    if "e0" not in names["COORDINATES"]:
        assert tuple(f"{name}dot" for name in names["COORDINATES"]) == names["VELOCITIES"]
    patterns = {"MASS": c.mass_pattern, "JACOBIAN": c.jacobian_pattern}
    patterns |= {f"MARKER_{m.upper()}": c.marker_pattern(m) for m in c.markers}
    for name, pattern in patterns.items():
        expected = (pattern.rows, pattern.cols, pattern.colptr, pattern.rowidx, pattern.symmetric)
        assert tuple(names[name]) == expected


# Values


@pytest.mark.parametrize("model", OF_SOME)
def test_gives_the_numbers_of_c_to_the_last_bit(model: str) -> None:
    """Operations have the same order as in C; NumPy's own sine may differ in the last bit, so it is replaced."""
    names = {**module(model)}
    exec(compile(text_of(MODELS[model](), ".py"), f"{model}.py", "exec"), names)
    names["numpy"] = PlainNumPy()
    for kernel in MODELS[model]().model.kernels:
        name, given = kernel.name, arguments(model, kernel)
        expected = by_c(model, name, given)
        found = as_tuple(names[name](*(value.tolist() for value in given)))  # lists have no namespace but the module's
        assert len(found) == len(expected), name
        for ours, of_c in zip(found, expected, strict=True):
            assert np.array_equal(ours, of_c), name
        for ours, of_c in zip(as_tuple(module(model)[name](*given)), expected, strict=True):
            assert np.allclose(ours, of_c, rtol=1e-12, atol=1e-13 * np.max(np.abs(of_c), initial=0.0)), name


@pytest.mark.parametrize("model", OF_SOME)
def test_batches_broadcast(model: str) -> None:
    """A batch gives what a loop over it gives, member by member; a constant entry fills the batch, too."""
    for kernel in MODELS[model]().model.kernels:
        name, function = kernel.name, module(model)[kernel.name]
        given = arguments(model, kernel, BATCHES)
        own = [0 if argument.scalar else 1 for argument in kernel.arguments]
        shape = np.broadcast_shapes(*(g.shape[: g.ndim - rank] for g, rank in zip(given, own, strict=True)))
        full = [np.broadcast_to(g, (*shape, *g.shape[g.ndim - rank :])) for g, rank in zip(given, own, strict=True)]
        found = as_tuple(function(*given))
        for output, values in zip(kernel.outputs, found, strict=True):
            assert values.shape == (*shape, len(output.elements)), name
        for member in np.ndindex(shape):
            alone = as_tuple(function(*(f[member] for f in full)))
            for ours, single in zip(found, alone, strict=True):
                atol = 1e-14 * np.max(np.abs(single), initial=0.0)
                assert np.allclose(ours[member], single, rtol=1e-13, atol=atol), name


@pytest.mark.parametrize("model", OF_SOME)
def test_any_one_argument_may_be_a_batch(model: str) -> None:
    """An argument that the function does not read may be a batch, too; empty batches are batches."""
    for kernel in MODELS[model]().model.kernels:
        for argument, count in itertools.product(kernel.arguments, (2, 0)):
            found = as_tuple(module(model)[kernel.name](*arguments(model, kernel, {argument.name: (count,)})))
            for output, values in zip(kernel.outputs, found, strict=True):
                assert values.shape == (count, len(output.elements)), kernel.name


def test_sweeps_parameters() -> None:
    """Accelerations of many beams from their parameters at once agree with those of the C one by one."""
    names, c = module("point_2"), native("point_2")
    q, v = beams.state(2)
    sweep = np.array(names["DEFAULTS"]) * np.random.default_rng(3).uniform(0.3, 3.0, (7, 3))
    found = names["accel"](0.0, q, v, names["setup"](sweep))
    expected = np.array([c.accel(0.0, q, v, c.setup(p)) for p in sweep])
    assert np.allclose(found, expected, rtol=1e-12, atol=0)


def test_takes_lists_and_tuples() -> None:
    names = module("point_2")
    q, v = beams.state(2)
    k = names["setup"]((1, 2, 3))
    assert np.array_equal(k, names["setup"](np.array([1.0, 2.0, 3.0])))
    assert np.array_equal(names["accel"](0, list(q), tuple(v), list(k)), names["accel"](0.0, q, v, k))
    assert np.array_equal(names["mass"]([list(q)] * 2, k), names["mass"](np.array([q, q]), k))


# Refusals


@pytest.mark.parametrize("bad", [-1.0, 0.0, np.nan, np.inf])
@pytest.mark.parametrize(("place", "symbol"), [(0, "m"), (1, "l"), (2, "EI")])
def test_setup_refuses_bad_parameters(place: int, symbol: str, bad: float) -> None:
    """One of a batch is enough."""
    p = np.ones((4, 3))
    p[2, place] = bad
    with (
        np.errstate(all="ignore"),
        pytest.raises(ValueError, match=f"^{symbol} must be (positive|finite)$"),
    ):
        module("mean_2")["setup"](p)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize(
    ("model", "inertia"), [pytest.param("mean_2_flat", "C3_11", marks=pytest.mark.long), ("given_2_flat", "c8_1_1")]
)
def test_accel_is_nan_where_a_pivot_vanishes_and_right_elsewhere(model: str, inertia: str) -> None:
    names, c = module(model), native(model)
    _, q, v, _ = arguments(model, MODELS[model]().model.kernel("accel"))
    k = np.tile(c.setup(), (5, 1))
    for member, value in ((1, -1.0), (3, np.nan)):
        k[member, names["CONSTANTS"].index(inertia)] = value
    found = names["accel"](0.0, q, v, k)
    assert np.array_equal(np.isnan(found).all(axis=1), [False, True, False, True, False])
    assert np.allclose(found[[0, 2, 4]], c.accel(0.0, q, v, c.setup()), rtol=1e-12, atol=0)
    for member in (1, 3):
        with pytest.raises(names["ModelError"], match=r"the pivot of .* vanished") as caught:
            names["accel"](0.0, q, v, k[member])
        assert caught.value.code == 1


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize(("place", "value"), [(2, 1e200), (4, np.inf)])
def test_accel_fails_where_c_returns_a_code(place: int, value: float) -> None:
    """A single state with the same code; of a batch, the state has NaN in every element and the others are right."""
    names, c = module("mean_2"), native("mean_2")
    k = c.setup()
    q, v = np.tile(beams.state(2)[0], (3, 1)), np.tile(beams.state(2)[1], (3, 1))
    v[1, place] = value
    with pytest.raises(ModelError) as of_c:
        c.accel(0.0, q[1], v[1], k)
    with pytest.raises(names["ModelError"], match="an acceleration is not finite") as of_python:
        names["accel"](0.0, q[1], v[1], k)
    assert of_python.value.code == of_c.value.code == 2
    found = names["accel"](0.0, q, v, k)
    assert np.allclose(found, c.accel_batch(0.0, q, v, k, check=False), rtol=1e-12, atol=0, equal_nan=True)
    assert np.array_equal(np.isnan(found), np.tile([[False], [True], [False]], 5))


@pytest.mark.parametrize("model", OF_SOME)
def test_wrong_lengths_are_refused(model: str) -> None:
    """Such as y in place of q, which begins with q."""
    for kernel in MODELS[model]().model.kernels:
        given = arguments(model, kernel)
        for place, (argument, value) in enumerate(zip(kernel.arguments, given, strict=True)):
            for wrong in () if argument.scalar else (np.append(value, 0.0), np.append(value, [0.0] * 5), np.array(1.0)):
                with pytest.raises(ValueError, match=rf"^{argument.name}\b.*\b{len(value)}\b"):
                    module(model)[kernel.name](*given[:place], wrong, *given[place + 1 :])


# Types


@pytest.mark.parametrize("model", OF_SOME)
def test_single_precision_stays_single(model: str) -> None:
    for kernel in MODELS[model]().model.kernels:
        found = as_tuple(module(model)[kernel.name](*(a.astype(np.float32) for a in arguments(model, kernel))))
        assert {values.dtype for values in found} == {np.dtype(np.float32)}, kernel.name


def test_arrays_of_integers_are_numbers() -> None:
    setup = module("mean_2")["setup"]
    big = [1, 5_000_000, 1]
    assert np.array_equal(setup(np.array(big)), setup(big))


def test_complex_steps_pass() -> None:
    """Derivatives by complex steps: the imaginary part survives every function that has no requirements."""
    names = module("point_2")
    q, v = beams.state(2)
    k = names["setup"](names["DEFAULTS"])
    step = 1e-30
    change = names["energy"](q + 1j * step * v, v, k).imag / step
    assert change.shape == (2,)
    assert np.all(change != 0)


# dense


def test_dense_unfolds_patterns() -> None:
    names = module("point_2")
    pattern = names["Pattern"](2, 3, (0, 1, 1, 3), (1, 0, 1), False)
    assert names["dense"](pattern, [1.0, 2.0, 3.0]).tolist() == [[0.0, 0.0, 2.0], [1.0, 0.0, 3.0]]
    lower = names["Pattern"](2, 2, (0, 2, 3), (0, 1, 1), True)
    batch = np.arange(12.0).reshape(2, 2, 3)
    unfolded = names["dense"](lower, batch)
    assert unfolded.shape == (2, 2, 2, 2)
    for member in np.ndindex(2, 2):
        a, b, c = batch[member]
        assert unfolded[member].tolist() == [[a, b], [b, c]]


def test_dense_mass_solves_for_the_accelerations() -> None:
    names = module("point_2")
    q, v = beams.state(2)
    k = names["setup"](names["DEFAULTS"])
    values, h = names["mass_force"](0.0, q, v, k)
    mass = names["dense"](names["MASS"], values)
    assert np.array_equal(mass, mass.T)
    residual = mass @ names["accel"](0.0, q, v, k) + h
    assert np.max(np.abs(residual)) < 1e-11 * np.max(np.abs(h))
