"""Frames as exact linear conditions, and what they refuse."""

from __future__ import annotations

from fractions import Fraction

import pytest
import sympy as sp

from derive.mechanics.bodies.beam_functions import BeamFunction
from derive.mechanics.bodies.reference_conditions import (
    ConditionError,
    assumed_shapes,
    conditions,
    end_conditions,
)
from derive.spec.model.beam_parts import AssumedDeflection, Ends, Frame, Polynomial

ZERO, xi = Fraction(0), sp.Symbol("xi")
FRAMES = {
    "mean": Frame("mean"),
    "point": Frame("point", ZERO),
    "point_off_centre": Frame("point", Fraction(1, 2)),
    "chord": Frame("chord"),
    "left": Frame("tangent", Fraction(-1)),
    "right": Frame("tangent", Fraction(1)),
}


def monomials(count: int) -> tuple[Polynomial, ...]:
    return tuple((*[ZERO] * power, Fraction(1)) for power in range(count))


def poly(shape: BeamFunction) -> sp.Poly:
    return sp.Poly([sp.Rational(c) for c in reversed(shape.coefficients)], xi, domain="QQ")


def integral(of: sp.Poly) -> sp.Rational:
    primitive = of.integrate()
    return primitive.eval(1) - primitive.eval(-1)


@pytest.mark.parametrize("n", [1, 2, 3, 6, 10])
@pytest.mark.parametrize("name", FRAMES)
def test_shapes_meet_the_conditions_exactly(name: str, n: int) -> None:
    shapes = assumed_shapes(AssumedDeflection(monomials(n + 2), FRAMES[name]))
    assert len(shapes) == n
    for shape in shapes:
        assert [c.on(shape) for c in conditions(FRAMES[name])] == [0, 0]


@pytest.mark.parametrize("n", range(1, 11))
def test_the_mean_frame_gives_legendre_polynomials(n: int) -> None:
    """The matrix c8 = m/(2n+1) is diagonal: the integral of P_n^2 over the beam is 2/(2n+1)."""
    shapes = [poly(s) for s in assumed_shapes(AssumedDeflection(monomials(n + 2), FRAMES["mean"], orthogonal=True))]
    assert shapes == [sp.Poly(sp.legendre(k, xi), xi, domain="QQ") for k in range(2, n + 2)]
    for i, first in enumerate(shapes):
        for j, second in enumerate(shapes):
            assert integral(first * second) == (sp.Rational(2, 2 * (i + 2) + 1) if i == j else 0)


def test_the_point_frame_leaves_monomials() -> None:
    shapes = assumed_shapes(AssumedDeflection(monomials(6), FRAMES["point"]))
    assert tuple(shape.coefficients for shape in shapes) == monomials(6)[2:]


@pytest.mark.parametrize("name", FRAMES)
def test_orthogonal_shapes_span_the_same_and_are_orthogonal(name: str) -> None:
    plain = [poly(s) for s in assumed_shapes(AssumedDeflection(monomials(6), FRAMES[name]))]
    shapes = [poly(s) for s in assumed_shapes(AssumedDeflection(monomials(6), FRAMES[name], orthogonal=True))]
    assert all(integral(a * b) == 0 for a in shapes for b in shapes if a != b)
    rows = sp.Matrix([[p.coeff_monomial(xi**k) for k in range(6)] for p in plain + shapes])
    assert rows.rank() == len(plain) == len(shapes)


@pytest.mark.parametrize("name", FRAMES)
def test_the_first_derivative_that_does_not_vanish_at_the_end_is_one(name: str) -> None:
    for shape in map(poly, assumed_shapes(AssumedDeflection(monomials(6), FRAMES[name]))):
        values = [shape.diff((xi, k)).eval(1) if k else shape.eval(1) for k in range(6)]
        assert next(v for v in values if v != 0) == 1


def test_pinned_ends_leave_one_quartic_in_the_mean_frame() -> None:
    """The one combination of P2, P3, P4 without curvature at the ends."""
    (shape,) = assumed_shapes(AssumedDeflection(monomials(5), FRAMES["mean"], True, "pinned"))
    expected = sp.Poly(xi**4 - 6 * xi**2 + sp.Rational(9, 5), xi, domain="QQ")
    assert poly(shape) * expected.eval(1) == expected


@pytest.mark.parametrize(("ends", "orders"), [("pinned", (2,)), ("free", (2, 3))])
@pytest.mark.parametrize("name", FRAMES)
def test_conditions_at_the_ends_hold_beside_those_of_the_frame(name: str, ends: Ends, orders: tuple[int, ...]) -> None:
    shapes = assumed_shapes(AssumedDeflection(monomials(9), FRAMES[name], ends=ends))
    assert len(shapes) == 9 - 2 - 2 * len(orders) == 7 - len(end_conditions(ends))
    for shape in shapes:
        assert [c.on(shape) for c in conditions(FRAMES[name])] == [0, 0]
        assert all(poly(shape).diff((xi, order)).eval(at) == 0 for order in orders for at in (-1, 1))


def test_an_ansatz_too_short_for_conditions_at_the_ends_is_refused() -> None:
    (text,) = refusal(monomials(4), FRAMES["chord"], "pinned")
    assert "chord frame (v(-1) = 0 and v(1) = 0) and of pinned ends (v''(-1) = 0 and v''(1) = 0); add poly" in text


def refusal(ansatz: tuple[Polynomial, ...], frame: Frame, ends: Ends | None = None) -> tuple[str, ...]:
    with pytest.raises(ConditionError) as caught:
        assumed_shapes(AssumedDeflection(ansatz, frame, ends=ends))
    return caught.value.problems


def test_an_ansatz_of_rigid_motions_is_empty_after_the_conditions() -> None:
    (text,) = refusal(monomials(2), FRAMES["mean"])
    assert "empty after the conditions of the mean frame (int v dxi = 0 and int xi v dxi = 0)" in text


def test_dependent_polynomials_are_named() -> None:
    (text,) = refusal((*monomials(4), (ZERO, ZERO, Fraction(2))), FRAMES["mean"])
    assert "linearly dependent: -2*(xi^2) + (2*xi^2) = 0" in text


def test_a_zero_polynomial_is_dependent() -> None:
    (text,) = refusal((*monomials(4), ()), FRAMES["mean"])
    assert "linearly dependent: (0) = 0" in text


def test_rigid_motion_left_in_given_shapes_is_named() -> None:
    translation, rotation = refusal(monomials(4), Frame("given"))
    assert "(1) = 1, a translation" in translation
    assert "(xi) = xi, a rotation" in rotation
    hidden = ((Fraction(1), Fraction(2), Fraction(3)), (ZERO, ZERO, Fraction(1)))
    (text,) = refusal(hidden, Frame("given"))
    assert "= 2*xi + 1, a rigid motion" in text


def test_given_shapes_without_rigid_motion_are_taken() -> None:
    shapes = assumed_shapes(AssumedDeflection(monomials(4)[2:], Frame("given")))
    assert tuple(shape.coefficients for shape in shapes) == monomials(4)[2:]
