"""Calls of compiled functions: results in given arrays, arrays that are recognised, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import beams
from derive.runtime import compiled_function
from derive.runtime.compiled_model import Native

Q, V = np.array([0.1, -0.2, 0.5, 0.01, -0.02]), np.array([1.0, 2.0, 3.0, -0.5, 0.4])


@pytest.fixture(scope="module")
def native() -> Native:
    return beams.native("point", 2)


@pytest.fixture(scope="module")
def k(native: Native) -> np.ndarray:
    return native.setup()


def test_results_are_written_into_out(native: Native, k: np.ndarray) -> None:
    y, ydot = np.concatenate([Q, V]), np.concatenate([V, Q])
    calls: dict[str, tuple[Any, ...]] = {
        "mass": (Q, k),
        "force": (0.0, Q, V, k),
        "accel": (0.0, Q, V, k),
        "rates": (Q, V, k),
        "residual": (0.0, y, ydot, k),
        "jacobian": (0.0, y, ydot, 10.0, k),
    }
    for name, arguments in calls.items():
        function = getattr(native, name)
        expected = function(*arguments)
        out = np.full_like(expected, np.nan)
        assert function(*arguments, out=out) is out
        np.testing.assert_array_equal(out, expected)


def test_arrays_of_the_last_call_are_not_looked_up_again(
    native: Native, k: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nor is anything allocated for the result; their values are those of now."""
    q, v, out = Q.copy(), V.copy(), np.empty(5)
    native.accel(0.0, q, v, k, out=out)

    def refused(*_: object) -> None:
        raise AssertionError("this has been done already")

    for name in ("checked_vector", "checked_origin", "address_of"):
        monkeypatch.setattr(compiled_function, name, refused)
    monkeypatch.setattr(compiled_function.np, "empty", refused)
    q *= 2
    native.accel(0.0, q, v, k, out=out)
    monkeypatch.undo()
    np.testing.assert_array_equal(out, native.accel(0.0, 2 * Q, V, k))


def test_converted_arguments_are_not_recognised(native: Native, k: np.ndarray) -> None:
    """Their conversion has the values of the call."""
    once, twice = (native.accel(0.0, n * Q, V, k) for n in (1, 2))
    for given in (Q.tolist(), np.array([Q, Q]).T[:, 0]):
        np.testing.assert_array_equal(native.accel(0.0, given, V, k), once)
        given[:] = (2 * Q).tolist()
        np.testing.assert_array_equal(native.accel(0.0, given, V, k), twice)


def test_equal_arrays_are_not_the_same(native: Native, k: np.ndarray) -> None:
    first, second = Q.copy(), Q.copy()
    native.accel(0.0, first, V, k)
    second *= 2
    np.testing.assert_array_equal(native.accel(0.0, second, V, k), native.accel(0.0, 2 * Q, V, k))


def test_values_stay_where_they_are(native: Native, k: np.ndarray) -> None:
    """NumPy would move them elsewhere, and the address that is kept would be that of freed memory."""
    q, out = Q.copy(), np.empty(5)
    native.accel(0.0, q, V, k, out=out)
    for array in (q, out):
        with pytest.raises(ValueError, match="cannot resize an array that references or is referenced"):
            array.resize(1_000_000, refcheck=False)


def test_wrong_outputs_are_refused(native: Native, k: np.ndarray) -> None:
    q, frozen = Q.copy(), np.empty(5)
    native.accel(0.0, q, V, k, out=frozen)
    frozen.setflags(write=False)
    both = np.zeros(9)
    for out, text in (
        (np.empty(4), r"`out` must be an array of 5 doubles \(float64\), not float64 of shape \(4,\)"),
        (np.empty(5, np.float32), "not float32 of shape"),
        ([0.0] * 5, "not list of shape"),
        (np.empty((5, 2))[:, 0], "contiguous and writeable"),
        (frozen, "contiguous and writeable"),
        (q, "shares memory with an argument"),
        (both[4:], "shares memory with an argument"),
    ):
        with pytest.raises(ValueError, match=f"beam_point_2_accel: .*{text}"):
            native.accel(0.0, both[:5] if np.shares_memory(np.asarray(out), both) else q, V, k, out=out)
    both[:5] = Q
    native.accel(0.0, both[:5], V, k, out=frozen.copy())
    assert both[5:].tolist() == [0.0] * 4


def test_an_output_that_became_an_argument_is_refused(native: Native, k: np.ndarray) -> None:
    q, v, out = Q.copy(), V.copy(), np.empty(5)
    native.accel(0.0, q, v, k, out=out)
    native.accel(0.0, q, out, k)
    with pytest.raises(ValueError, match="shares memory with an argument"):
        native.accel(0.0, q, out, k, out=out)
