"""(5), (6), (22) and the conditions, as the tool uses them, against the printed ones."""

from __future__ import annotations

import pytest
import sympy as sp

from derive.mechanics.bodies.beam_functions import polynomial
from derive.mechanics.bodies.reference_conditions import conditions
from derive.mechanics.motion.kinematics import PHI, RDDOT, RDOT, MovingFrame, PlanarRotation, R
from derive.spec.model.beam_parts import Frame
from paper import printed

ANGLE, OMEGA, ALPHA = sp.symbols("phi phidot phiddot")


def fields() -> tuple[PlanarRotation, MovingFrame]:
    rotation = PlanarRotation(ANGLE)
    return rotation, MovingFrame((rotation.generator,), (OMEGA,), (ALPHA,))


def vectors(*names: str) -> list[sp.Matrix]:
    return [sp.Matrix(sp.symbols(f"{n}_1 {n}_2")) for n in names]


def spatial(vector: sp.Matrix) -> sp.Matrix:
    return sp.Matrix([*vector, 0])


def test_rotation_is_26_and_its_axis_27() -> None:
    rotation, frame = fields()
    q = rotation.tensor.subs(rotation.functions)
    assert sp.Matrix(printed.ROTATION_26)[:2, :2] == q
    assert frame.angular_velocity_tensor / OMEGA == sp.Matrix([[0, -1], [1, 0]])


def test_acceleration_is_5() -> None:
    """Q times the derived field, without cddot, for r, rdot and rddot with free components."""
    _, frame = fields()
    r, rdot, rddot = vectors("r", "rdot", "rddot")
    values = {R: r, RDOT: rdot, RDDOT: rddot}
    found = sum((tensor * values[name] for name, tensor in frame.acceleration.items()), sp.zeros(2, 1))
    q = sp.Matrix(printed.ROTATION_26)
    omega, omegadot = sp.Matrix([0, 0, OMEGA]), sp.Matrix([0, 0, ALPHA])
    expected = printed.acceleration_5(sp.zeros(3, 1), q, omega, omegadot, spatial(r), spatial(rdot), spatial(rddot))
    assert (q * spatial(found) - expected).applyfunc(sp.expand) == sp.zeros(3, 1)


def test_virtual_displacement_is_6() -> None:
    _, frame = fields()
    r, shape = vectors("r", "Phi")
    values = {R: r, PHI: shape}
    turn, stretch = sp.symbols("dphi dalpha")
    (rotation,), deformation = frame.rotations(), frame.deformation()
    found = turn * sum((tensor * values[name] for name, tensor in rotation.items()), sp.zeros(2, 1))
    found += stretch * sum((tensor * values[name] for name, tensor in deformation.items()), sp.zeros(2, 1))
    q = sp.Matrix(printed.ROTATION_26)
    delta_u = spatial(stretch * shape)
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
        found = sum(a * condition.on(polynomial([0] * n + [1])) for n, a in enumerate(amplitudes))
        ratio = sp.cancel(found / line)
        assert ratio.is_number and ratio != 0
