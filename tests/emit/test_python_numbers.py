"""The generated Python takes single states as numbers of Python, and many as they are, with the results of arrays."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from toolchain import MODELS

import beams


def names_of(model: str) -> dict[str, Any]:
    """A generated module of its own, whose functions may be replaced."""
    return beams.run_module(MODELS[model]().files)


def as_lists(given: tuple[Any, ...]) -> list[Any]:
    """Vectors as lists, which are converted to arrays."""
    return [x.tolist() if isinstance(x, np.ndarray) else x for x in given]


def beam(names: dict[str, Any]) -> tuple[Any, ...]:
    """The arguments t, q, v, k of a beam with two shapes."""
    return 0.5, np.array([0.1, 0.2, 0.3, 0.01, 0.02]), np.arange(5.0), names["setup"](np.array(names["DEFAULTS"]))


@pytest.mark.parametrize("model", ["mean_2", "point_2", "folded_point", "given_2_flat"])
def test_a_single_state_is_computed_with_numbers(model: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """No vector of doubles is converted to anything but numbers, in any function but `setup`."""
    names, rng = names_of(model), np.random.default_rng(1)
    k = names["setup"](np.array(names["DEFAULTS"]))
    cases = []
    for kernel in MODELS[model]().model.kernels[1:]:
        random = (rng.uniform(-0.5, 0.5, None if a.scalar else a.size) for a in kernel.arguments)
        given = tuple(k if a.name == "k" else x for a, x in zip(kernel.arguments, random, strict=True))
        cases.append((kernel.name, given, names[kernel.name](*as_lists(given))))

    def refused(*_: object) -> None:
        raise AssertionError("a vector of doubles is used as it is")

    monkeypatch.setitem(names["accel"].__globals__, "_arrays", refused)
    for name, given, expected in cases:
        found = names[name](*given)
        for ours, of_arrays in zip(*((x if isinstance(x, tuple) else (x,)) for x in (found, expected)), strict=True):
            assert ours.dtype == np.float64 and ours.shape == of_arrays.shape
            assert np.allclose(ours, of_arrays, rtol=1e-13, atol=1e-15), name
    with pytest.raises(AssertionError):  # lists are converted
        names["mass"](*as_lists(cases[0][1]))


@pytest.mark.parametrize("model", ["mean_2", "given_2_flat", "given_3_loops"])
@pytest.mark.parametrize("shape", [(7,), (1,), (2, 3)])
def test_many_states_are_not_converted(model: str, shape: tuple[int, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    """Arrays of doubles are used as they are, also beside vectors and numbers, which broadcast."""
    names, rng = names_of(model), np.random.default_rng(2)
    k = names["setup"](np.array(names["DEFAULTS"]))
    cases = []
    for kernel in MODELS[model]().model.kernels[1:]:
        state = {a.name: rng.uniform(-0.5, 0.5, (*shape, a.size)) for a in kernel.arguments if not a.scalar}
        state |= {"k": k} | ({"v": state["v"][(0,) * len(shape)]} if "v" in state else {})
        given = tuple(0.5 if a.scalar else state[a.name] for a in kernel.arguments)
        cases.append((kernel.name, given, names[kernel.name](*as_lists(given))))

    def refused(*_: object) -> None:
        raise AssertionError("arrays of doubles are used as they are")

    monkeypatch.setitem(names["mass"].__globals__, "_array", refused)
    for name, given, expected in cases:
        found = names[name](*given)
        for ours, of_lists in zip(*((x if isinstance(x, tuple) else (x,)) for x in (found, expected)), strict=True):
            assert ours.dtype == np.float64 and ours.shape[:-1] == shape and ours.flags.c_contiguous
            assert ours.tobytes() == of_lists.tobytes(), name
    with pytest.raises(AssertionError):
        names["mass"](*as_lists(cases[0][1]))


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_what_numbers_refuse_has_the_result_of_arrays() -> None:
    """The cosine of inf is NaN, and where C divides by zero there is an error with its code, not that of Python."""
    names = names_of("point_2")
    t, q, v, k = beam(names)
    q[2] = math.inf
    expected = names["force"](*as_lists((t, q, v, k)))
    assert np.isnan(expected).any()
    assert np.array_equal(names["force"](t, q, v, k), expected, equal_nan=True)
    assert np.array_equal(names["force"](t, q=q, v=v, k=k), expected, equal_nan=True)
    t, q, v, k = beam(names)
    for given in ((t, q, v, 0 * k), as_lists((t, q, v, 0 * k))):
        with pytest.raises(names["ModelError"], match="not finite") as caught:
            names["accel"](*given)
        assert caught.value.code == 2


@pytest.mark.parametrize("model", ["mean_2", "point_2", "given_2_flat"])
def test_sequences_of_numbers_have_the_results_of_vectors(model: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The functions of `numbers` take lists and return sequences of floats, without NumPy."""
    names, rng = names_of(model), np.random.default_rng(3)
    k = names["setup"](np.array(names["DEFAULTS"]))
    numbers, cases = names["numbers"], []
    for kernel in MODELS[model]().model.kernels[1:]:
        random = (rng.uniform(-0.5, 0.5, None if a.scalar else a.size) for a in kernel.arguments)
        given = tuple(k if a.name == "k" else x for a, x in zip(kernel.arguments, random, strict=True))
        cases.append((kernel, given, names[kernel.name](*given)))
    assert sorted(vars(numbers)) == sorted(kernel.name for kernel, _, _ in cases)
    monkeypatch.setitem(names["accel"].__globals__, "numpy", None)
    for kernel, given, expected in cases:
        found = getattr(numbers, kernel.name)(*as_lists(given))
        several = len(kernel.outputs) > 1
        for ours, of_arrays in zip(found if several else (found,), expected if several else (expected,), strict=True):
            assert all(isinstance(x, int | float) for x in ours)
            assert list(ours) == of_arrays.tolist(), kernel.name


def test_functions_of_numbers_are_those_of_arrays() -> None:
    numbers = names_of("mean_2")["_NUMBERS"]
    values = (-1.0, -0.5, 0.0, 0.5, 2.0, math.inf, math.nan)
    for name in ("minimum", "maximum", "atan2"):
        for a, b in itertools.product(values, values):
            assert np.array_equal(getattr(numbers, name)(a, b), getattr(np, name)(a, b), equal_nan=True), (name, a, b)
    for name in ("sin", "cos", "sqrt", "exp", "log", "tanh"):
        assert getattr(numbers, name)(0.7) == pytest.approx(getattr(np, name)(0.7), rel=1e-15)
    for holds in (True, False):
        assert numbers.where(holds, 1.0, 2.0) == np.where(holds, 1.0, 2.0)
        assert numbers.logical_not(holds) == np.logical_not(holds)
    assert [numbers.isfinite(x) for x in values] == np.isfinite(values).tolist()
