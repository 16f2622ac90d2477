"""Generated C says what went wrong: 1 a pivot vanished, 2 a value is not finite or not positive."""

from __future__ import annotations

import numpy as np
import pytest
from toolchain import special

import beams
import derive
from conftest import QUICK
from derive.errors import TisserandError
from derive.runtime.compiled_model import Native
from derive.runtime.native_call import ModelError

BAD = [-1.0, 0.0, -0.0, np.nan, np.inf, -np.inf]


def constant(frame: str, name: str) -> int:
    """The index of a constant in k."""
    return [c.name for c in beams.made(frame, 2).model.constants].index(name)


def code_of_accel(native: Native, q: np.ndarray, v: np.ndarray, k: np.ndarray) -> int:
    try:
        assert np.all(np.isfinite(native.accel(0.0, q, v, k)))
    except ModelError as error:
        return error.code
    return 0


@pytest.mark.parametrize("bad", BAD)
@pytest.mark.parametrize("parameter", [0, 1, 2])
@pytest.mark.parametrize("frame", ["mean", "point"])
def test_setup_refuses_bad_parameters(frame: str, parameter: int, bad: float) -> None:
    native = beams.native(frame, 2)
    p = native.defaults.copy()
    native.setup(p)
    p[parameter] = bad
    with pytest.raises(
        ModelError, match=f"beam_{frame}_2_setup returned 2: a value is not finite or not positive"
    ) as e:
        native.setup(p)
    assert e.value.code == 2


@pytest.mark.parametrize("p", [[1, 1e-120, 1], [1e-320, 1, 1], [1e308, 1e200, 1], [1, 1, 1e308]])
def test_setup_refuses_constants_that_are_not_finite(p: list[float]) -> None:
    with pytest.raises(ModelError):
        beams.native("mean", 2).setup(p)


def test_a_pivot_that_setup_checks_gives_no_acceleration_where_it_vanishes() -> None:
    """For the mean frame the pivot of phi is J, which is C3 when the beam is straight; setup returns 1 for C3 <= 0."""
    native = beams.native("mean", 2)
    q, v = beams.state(2)
    q[3:] = 0.0
    k = native.setup()
    assert code_of_accel(native, q, v, k) == 0
    for tampered in (0.0, np.nan):
        k[constant("mean", "C3")] = tampered
        assert code_of_accel(native, q, v, k) == 2


@pytest.mark.parametrize(("part", "code"), [("1/10^5", 0), ("4/10^6", 0), ("2/10^7", 1), ("1/10^9", 1)])
def test_a_pivot_of_rounding_error_returns_1(part: str, code: int) -> None:
    """The shape is a rotation but for part^2 * 12 * 4/175 of the moment of inertia, which VANISHING is compared with.

    That is what phi keeps while the beam is straight; a deflection adds to it.
    """
    spec = derive.planar_beam(
        "rotation",
        ansatz=[f"xi + ({part})*(xi^3 - 3/5*xi)", "xi^2 - 1/3"],
        frame="given",
        mass=beams.MASS,
        length=beams.LENGTH,
        bending_stiffness=beams.BENDING,
    )
    native = derive.load(beams.build(spec).files, QUICK)
    q, v = beams.state(2)
    k = native.setup()
    assert code_of_accel(native, q, v, k) == 0
    q[3:] = 0.0
    assert code_of_accel(native, q, v, k) == code


def test_accel_refuses_what_is_not_finite() -> None:
    """Translations are the exception, since nothing depends on them; nor does it on phi in the mean frame."""
    for frame, first in (("mean", 3), ("point", 2)):
        native = beams.native(frame, 2)
        k = native.setup()
        for bad in (np.nan, np.inf):
            for place in range(first, 5):
                q, v = beams.state(2)
                q[place] = bad
                assert code_of_accel(native, q, v, k) in (1, 2)
            for place in range(2, 5):
                q, v = beams.state(2)
                v[place] = bad
                assert code_of_accel(native, q, v, k) == 2


def test_accel_refuses_an_overflow() -> None:
    native = beams.native("mean", 2)
    q, v = beams.state(2)
    v[2] = 1e200
    assert code_of_accel(native, q, v, native.setup()) == 2


def test_a_folded_model_needs_no_parameters() -> None:
    native = derive.load(special("folded_mean").files)
    assert (native.np, native.nk, native.parameters) == (0, 0, ())
    k = native.setup()
    assert k.shape == (0,)
    q, v = beams.state(2)
    same = beams.native("mean", 2)
    expected = same.accel(0.0, q, v, same.setup([7 / 3, 0.7, 2.0]))
    assert np.allclose(native.accel(0.0, q, v, k), expected, rtol=1e-13, atol=0)


def test_errors_of_a_model_are_arithmetic_errors() -> None:
    error = ModelError("beam_accel", 1)
    assert isinstance(error, ArithmeticError) and isinstance(error, TisserandError)
    assert str(error) == "beam_accel returned 1: a pivot vanished"
    assert str(ModelError("beam_accel", 7)) == "beam_accel returned 7: unknown"
