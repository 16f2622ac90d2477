"""Accelerations of planar bodies whose mass matrix in the body frame is constant but for the row of phi."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import beams
import derive
from conftest import QUICK
from derive.ir.expressions import Number, Operation, Operator, walk
from derive.ir.interpreter import interpret
from derive.ir.statements import Require, ReturnCode
from derive.lowering.flat.constant_elimination import reduced_system
from derive.runtime.native_call import ModelError

EVERY_FRAME = [
    pytest.param(f, marks=pytest.mark.long if f in ("point_off_centre", "chord") else ()) for f in beams.FRAMES
]
"""The others differ from the tangent frame in the values of their integrals alone."""
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
@pytest.mark.parametrize("frame", EVERY_FRAME)
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
@pytest.mark.parametrize("frame", EVERY_FRAME)
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


STRETCHING = {"ansatz": ["xi"], "stiffness": {"symbol": "EA", "default": 1000}}
"""A displacement along the axis, whose damping ratio has roots of another parameter."""


@pytest.mark.parametrize("frame", ["mean", "point"])
@pytest.mark.parametrize(
    ("mass", "ratio"), [({"symbol": "m", "default": 1.3}, 0.03), (2, {"symbol": "zeta", "default": 0.03})]
)
@pytest.mark.parametrize("more", [{}, {"order": 2}, {"axial": STRETCHING}, {"order": 2, "axial": STRETCHING}])
def test_damping_ratios_have_roots_of_parameters(frame: str, mass: Any, more: dict[str, Any], ratio: Any) -> None:
    """Mass and stiffness are taken as squares of their roots, so that elimination remains exact."""
    beam = beams.beam(frame, 2, mass=mass, damping={"ratio": ratio}, markers={}, **more)
    derived = derive.derive(beam)
    equations, model = derived.expanded(), derive.lower(derived, explicit=True)
    assert (reduced_system(equations) is not None) is ("order" not in more or frame == "mean")
    n, k = len(equations.rows), interpret(model.kernel("setup"), {"p": list(model.defaults)})["k"]
    state = {"t": 0.0, "q": [0.0, 0.0, 0.3, *[0.03] * (n - 3)], "v": np.linspace(1.0, -2.0, n).tolist(), "k": k}
    both, pattern = interpret(model.kernel("mass_force"), state), model.pattern("mass", "M")
    M, h = np.zeros((n, n)), np.array(both["h"], dtype=float)
    for (i, j), value in zip(pattern.entries, both["M"], strict=True):
        M[i, j] = M[j, i] = value
    vdot = np.array(interpret(model.kernel("accel"), state)["vdot"], dtype=float)
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


@pytest.mark.parametrize("frame", EVERY_FRAME)
def test_of_a_pivot_that_is_positive_in_every_state_setup_checks_the_constant(frame: str) -> None:
    """Its constant part and its quadratic form are positive definite beyond rounding errors."""
    built = made(frame, 4)
    system = reduced_system(built.equations.expanded())
    assert system is not None and system.is_definite and system.is_positive
    checks = [s for s in built.model.kernel("accel").statements if isinstance(s, Require)]
    assert [s.code for s in checks] == [ReturnCode.NOT_FINITE]
    texts = [s.text for s in built.model.kernel("setup").statements if isinstance(s, Require)]
    assert "the pivot of phi vanished" in texts


@pytest.mark.parametrize("frame", EVERY_FRAME)
@pytest.mark.parametrize("size", [1.0, 1e5, 1e150])
def test_without_a_check_of_the_pivot_every_amplitude_has_finite_accelerations_or_a_code(
    frame: str, size: float
) -> None:
    """Amplitudes of any size: what is not finite has a code."""
    built = made(frame, 4)
    native = derive.load(built.files, QUICK)
    k = native.setup()
    for direction in np.vstack([np.eye(4), -np.eye(4), np.random.default_rng(1).normal(size=(20, 4))]):
        q, v = np.zeros(7), np.zeros(7)
        q[3:], v[2] = size * direction, 1.0
        try:
            vdot = native.accel(0.0, q, v, k)
        except ModelError as error:
            assert error.code == 2 and size > 1e100
            continue
        assert np.all(np.isfinite(vdot))


@pytest.mark.parametrize("state", ["q", "v"])
def test_a_nan_in_any_amplitude_or_velocity_returns_2(state: str) -> None:
    """The sum of the accelerations has all of them, so that the pivot need not be compared."""
    native = derive.load(made("point", 3).files, QUICK)
    k = native.setup()
    for element in range(2, 6):
        q, v = beams.state(3)
        (q if state == "q" else v)[element] = np.nan
        with pytest.raises(ModelError) as caught:
            native.accel(0.0, q, v, k)
        assert caught.value.code == 2


def test_a_pivot_within_rounding_errors_of_zero_is_checked() -> None:
    """The form has a pivot of 8e-14 of its diagonal: above VANISHING, but below what rounding its products may take."""
    built = beams.build(dependent("11/(2*10^7)"))
    system = reduced_system(built.equations.expanded())
    assert system is not None and not system.is_positive
    assert any(s.code == 1 for s in built.model.kernel("accel").statements if isinstance(s, Require))


def dependent(part: str) -> derive.PlanarBeam:
    """A beam with two shapes that differ by `part` of a third one."""
    return derive.planar_beam(
        "dependent",
        ansatz=["xi^2 - 1/3", f"xi^2 - 1/3 + ({part})*(xi^3 - 3/5*xi)"],
        frame="given",
        mass=beams.MASS,
        length=beams.LENGTH,
        bending_stiffness=beams.BENDING,
    )


@pytest.mark.parametrize(("part", "code"), [("1/10^3", 0), ("1/10^9", 1)])
def test_shapes_too_nearly_dependent_return_1(part: str, code: int) -> None:
    """The pivot of the second is part^2 times its moment; below VANISHING of that, setup says that it vanished."""
    built = beams.build(dependent(part))
    native = derive.load(built.files, QUICK)
    assert (reduced_system(built.equations.expanded()) is None) is bool(code)
    if code == 0:
        q, v = beams.state(2)
        assert np.all(np.isfinite(native.accel(0.0, q, v, native.setup())))
        return
    with pytest.raises(ModelError) as caught:
        native.setup()
    assert caught.value.code == code
