"""(5), (6), (22) and the conditions, as the tool uses them, against the printed ones."""

from __future__ import annotations

import pytest
import sympy as sp

from derive.mechanics.conditions import conditions, xi
from derive.mechanics.kinematics import RDOT, MovingFrame, PlanarRotation, R, phi
from derive.spec import Frame
from paper import printed

ANGLE, OMEGA, ALPHA = sp.symbols("phi phidot phiddot")


def fields() -> tuple[PlanarRotation, MovingFrame]:
    rotation = PlanarRotation(ANGLE)
    shapes = tuple(sp.symbols(f"alpha{i}dot alpha{i}ddot") for i in (1, 2))
    return rotation, MovingFrame(rotation.generator, OMEGA, ALPHA, shapes)


def spatial(vector: sp.Matrix) -> sp.Matrix:
    return sp.Matrix([*vector, 0])


def test_rotation_is_26_and_its_axis_27() -> None:
    rotation, frame = fields()
    q = rotation.tensor.subs(rotation.functions)
    assert sp.Matrix(printed.ROTATION_26)[:2, :2] == q
    assert frame.generator == sp.Matrix([[0, -1], [1, 0]])


def test_acceleration_is_5() -> None:
    """Q times the derived field, without cddot, for r, rdot and rddot with free components."""
    _, frame = fields()
    r, rdot, phi1, phi2 = (sp.Matrix(sp.symbols(f"{n}_1 {n}_2")) for n in ("r", "rdot", "Phi1", "Phi2"))
    values = {R: r, RDOT: rdot, phi(1): phi1, phi(2): phi2}
    found = sum((tensor * values[name] for name, tensor in frame.acceleration.items()), sp.zeros(2, 1))
    q = sp.Matrix(printed.ROTATION_26)
    uddot = phi1 * sp.Symbol("alpha1ddot") + phi2 * sp.Symbol("alpha2ddot")
    omega, omegadot = sp.Matrix([0, 0, OMEGA]), sp.Matrix([0, 0, ALPHA])
    expected = printed.acceleration_5(sp.zeros(3, 1), q, omega, omegadot, spatial(r), spatial(rdot), spatial(uddot))
    turned = q * spatial(found)
    assert (turned - expected).applyfunc(sp.expand) == sp.zeros(3, 1)


def test_virtual_displacement_is_6() -> None:
    _, frame = fields()
    r, phi1, phi2 = (sp.Matrix(sp.symbols(f"{n}_1 {n}_2")) for n in ("r", "Phi1", "Phi2"))
    values = {R: r, phi(1): phi1, phi(2): phi2}
    turn, first, second = sp.symbols("dphi dalpha1 dalpha2")
    found = sp.zeros(2, 1)
    for variation, field in zip((turn, first, second), frame.virtual_displacements(), strict=True):
        found += variation * sum((tensor * values[name] for name, tensor in field.items()), sp.zeros(2, 1))
    q = sp.Matrix(printed.ROTATION_26)
    delta_u = spatial(first * phi1 + second * phi2)
    expected = printed.virtual_displacement_6(sp.zeros(3, 1), q, sp.Matrix([0, 0, turn]), spatial(r), delta_u)
    assert (q * spatial(found) - expected).applyfunc(sp.expand) == sp.zeros(3, 1)


@pytest.mark.parametrize(
    ("frame", "expected"),
    [
        (Frame("point", sp.S.Zero), (printed.CONDITION_28, printed.CONDITION_29)),
        (Frame("mean"), (printed.CONDITION_35, printed.CONDITION_37)),
    ],
)
def test_conditions_on_the_cubic_are_the_printed_ones(frame: Frame, expected: tuple[sp.Expr, ...]) -> None:
    """(28), (29) and (35), (37): the same line in a0..a3, up to a factor."""
    amplitudes = sp.symbols("a0 a1 a2 a3")
    for condition, line in zip(conditions(frame), expected, strict=True):
        found = sum(a * condition.on(sp.Poly(xi**n, xi, domain="QQ")) for n, a in enumerate(amplitudes))
        ratio = sp.cancel(found / line)
        assert ratio.is_number and ratio != 0
