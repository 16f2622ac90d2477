"""Batches in which states fail: other states keep their bits, and the code is that of the first one."""

from __future__ import annotations

import ctypes
import ctypes.util
import platform

import numpy as np
import pytest
from test_batch import constants, native, one_by_one, same, states

from derive.runtime.native_call import ModelError


@pytest.mark.parametrize(
    ("model", "of_nan"), [("mean_2", 2), ("given_5_loops", 2), ("mean_5_loops", 1), ("mean_2_flat", 1)]
)
@pytest.mark.parametrize("bad", [0, 5, 31, 32, 39])
def test_a_state_that_fails_does_not_touch_the_others(model: str, of_nan: int, bad: int) -> None:
    """The pivot of a NaN is not positive, where it is checked, but a quaternion that is NaN is refused before, where
    accelerations depend on it; a rate of 1e200 gives forces that are not finite."""
    compiled = native(model)
    k, (q, v) = constants(compiled), states(compiled, 40)
    q[:, -1] *= 0.01
    for code, value, state in ((of_nan, np.nan, q), (2, 1e200, v)):
        kept = state[bad].copy()
        state[bad] = value
        single = one_by_one(compiled, "accel", q, v, k)
        assert single[bad] == code
        same(compiled.accel_batch(0.5, q, v, k, check=False), single)
        with pytest.raises(ModelError) as error:
            compiled.accel_batch(0.5, q, v, k)
        assert error.value.code == code
        state[bad] = kept


def test_an_infinite_acceleration_is_no_acceleration() -> None:
    """A spin whose square is infinite pulls both amplitudes outwards: their sum is infinite, and not a NaN."""
    compiled = native("mean_2")
    k, (q, v) = constants(compiled), states(compiled, 3)
    q[1, 3:], v[1, 2:] = 0.1, [1e160, 0, 0]
    single = one_by_one(compiled, "accel", q, v, k)
    assert single[1] == 2
    same(compiled.accel_batch(0.5, q, v, k, check=False), single)


def test_no_state_fails_where_numbers_are_rounded_down() -> None:
    """There x - x, which is NaN for what is not finite, is -0, whose bits are not 0."""
    if platform.machine() not in ("x86_64", "AMD64"):
        pytest.skip("the number of the direction of rounding is that of another processor")
    compiled, library = native("mean_2"), ctypes.CDLL(ctypes.util.find_library("m"))
    k, (q, v) = constants(compiled), states(compiled, 11)
    library.fesetround(0x400)
    try:
        single = [compiled.accel(0.5, *state, k) for state in zip(q, v, strict=True)]
        every = compiled.accel_batch(0.5, q, v, k)
    finally:
        library.fesetround(0)
    assert every.tobytes() == np.array(single).tobytes()


def test_a_pivot_that_vanishes_in_some_states() -> None:
    """Integrals that belong to no body: its inertia is definite for small displacements alone."""
    compiled = native("mean_2_flat")
    k, (q, v) = constants(compiled), states(compiled, 70)
    q[::3, 7:] = [300.0, -300.0]
    single = one_by_one(compiled, "accel", q, v, k)
    assert [b for b, s in enumerate(single) if isinstance(s, int) and s == 1] == [*range(0, 70, 3)]
    same(compiled.accel_batch(0.5, q, v, k, check=False), single)
    with pytest.raises(ModelError, match="flat_mean_2_accel_batch returned 1"):
        compiled.accel_batch(0.5, q, v, k)


def test_the_code_is_that_of_the_first_state_that_fails() -> None:
    compiled = native("mean_2_flat")
    k, (q, v) = constants(compiled), states(compiled, 70)
    q[60] = np.nan
    v[33] = 1e200
    for first, code in ((33, 2), (7, 1)):
        q[first] = np.nan if code == 1 else q[first]
        with pytest.raises(ModelError) as error:
            compiled.accel_batch(0.5, q, v, k)
        assert error.value.code == code
