"""Accelerations of planar bodies whose mass matrix in the body frame is constant but for the row of phi."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import beams
import derive
from conftest import QUICK
from derive.ir.expressions import Number, Operation, Operator, ScalarRef, walk
from derive.lowering.flat.constant_elimination import reduced_system
from derive.runtime.native_call import ModelError

LOADED: dict[str, Any] = {"gravity": ["1/3", -9], "damping": {"mass": "1/3", "stiffness": "1/50"}, "markers": {}}


@cache
def made(frame: str, n: int, order: int = 1, terms: str | None = None) -> beams.Made:
    """A beam with gravity and damping."""
    return beams.build(beams.beam(frame, n, **LOADED, **({"order": order, "terms": terms} if terms else {})))


def divisions(model: derive.Model) -> int:
    """The divisions of `accel`; those by numbers are literals."""
    parts = (part for item in model.kernel("accel").statements for part in walk(item.expr))
    return sum(isinstance(p, Operation) and p.kind is Operator.DIV and not isinstance(p.args[1], Number) for p in parts)


@pytest.mark.parametrize("n", [1, 4])
@pytest.mark.parametrize("frame", beams.FRAMES)
def test_accelerations_take_a_single_division(frame: str, n: int) -> None:
    assert divisions(made(frame, n).model) == 1


@pytest.mark.parametrize(("frame", "terms", "reduced"), [
    ("mean", "truncated", True),
    ("point", "truncated", False),
    ("mean", "full", False),
])  # fmt: skip
def test_where_more_rows_depend_on_the_state_all_of_m_is_factorised(frame: str, terms: str, reduced: bool) -> None:
    """Second order couples a translation to the shapes through the state, or makes the block of the shapes vary."""
    assert (reduced_system(made(frame, 2, 2, terms).equations.expanded()) is not None) is reduced


@pytest.mark.parametrize("terms", [None, "truncated"])
@pytest.mark.parametrize("frame", beams.FRAMES)
def test_accelerations_with_gravity_and_damping_fulfil_the_equations(frame: str, terms: str | None) -> None:
    """M vdot + h = 0 with the generated M and h, which know neither the body frame nor the elimination."""
    built = made(frame, 3, 2, terms)
    native = derive.load(built.files, QUICK)
    k, pattern = native.setup(), built.model.pattern("mass", "M")
    for seed in range(3):
        q, v = beams.state(3, seed)
        q[3:] *= 0.1  # truncated equations have a definite M for small deflections only
        values, h = native.mass_force(0.0, q, v, k)
        M = np.zeros((6, 6))
        for (i, j), value in zip(pattern.entries, values, strict=True):
            M[i, j] = M[j, i] = value
        vdot = native.accel(0.0, q, v, k)
        assert np.max(np.abs(M @ vdot + h)) < 1e-12 * np.max(np.abs(M) @ np.abs(vdot) + np.abs(h))


def test_centrifugal_forces_on_the_shapes_cancel_exactly() -> None:
    """They are the elastic block times the amplitudes, so that the inverse leaves phidot^2 alpha_i of them."""
    system = reduced_system(beams.made("point", 4).equations.expanded())
    assert system is not None
    ring = system.polynomials.ring
    spin = ring.gens[ring.symbols.index(next(s for s in ring.symbols if s.name == "phidot"))]
    for i, free in system.free.items():
        squares = [(powers, c) for powers, c in free.terms() if ring({powers: ring.domain.one}) % spin**2 == 0]
        amplitudes = [ring.symbols[powers.index(1)].name for powers, _ in squares]
        assert amplitudes == ([f"alpha{i - 2}"] if i > 2 else []) and all(c == 1 for _, c in squares)


@pytest.mark.parametrize("frame", beams.FRAMES)
def test_a_pivot_that_is_positive_in_every_state_is_compared_with_zero_alone(frame: str) -> None:
    """Its constant part and its quadratic form are positive definite beyond rounding errors."""
    system = reduced_system(made(frame, 4).equations.expanded())
    assert system is not None and system.is_definite
    (required,) = (s for s in made(frame, 4).model.kernel("accel").statements if getattr(s, "code", 0) == 1)
    assert isinstance(required.expr, ScalarRef)


@pytest.mark.parametrize(("part", "code"), [("1/10^3", 0), ("1/10^9", 1)])
def test_shapes_too_nearly_dependent_return_1(part: str, code: int) -> None:
    """The pivot of the second is part^2 times its moment; below VANISHING of that, setup says that it vanished."""
    spec = derive.planar_beam(
        "dependent",
        ansatz=["xi^2 - 1/3", f"xi^2 - 1/3 + ({part})*(xi^3 - 3/5*xi)"],
        frame="given",
        mass=beams.MASS,
        length=beams.LENGTH,
        bending_stiffness=beams.BENDING,
    )
    built = beams.build(spec)
    native = derive.load(built.files, QUICK)
    assert (reduced_system(built.equations.expanded()) is None) is bool(code)
    if code == 0:
        q, v = beams.state(2)
        assert np.all(np.isfinite(native.accel(0.0, q, v, native.setup())))
        return
    with pytest.raises(ModelError) as caught:
        native.setup()
    assert caught.value.code == code
