"""Sums of straight-line code: what a sparse body in space shares, and how many additions wait for each other."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import sympy as sp

import derive
from derive.ir.expressions import Expr, Operation, Operator, ScalarRef
from derive.ir.kernel import Kernel
from derive.ir.statements import Let
from derive.lowering.flat.shared_sums import SharedSums
from derive.mechanics.bodies.modal_body import ModalBody
from derive.mechanics.symbols import local
from derive.mechanics.terms import Intermediate, ModelConstant


@cache
def model(n: int) -> derive.Model:
    """A body that bends in a plane: orthonormal modes along x2 on a line along x1, all integrals exact."""
    C5 = np.zeros((n, n, 3, 3))
    C5[range(n), range(n)] = np.diag([1.0, 0.0, 1.0])
    unit, zero = np.eye(n), np.zeros((n, 3))
    body = ModalBody(
        name=f"line{n}",
        doc="modes of a line",
        origin="",
        mass=1.0,
        c1=np.zeros(3),
        c2=zero,
        C3=np.diag([0.0, 0.25, 0.25]),
        C4=np.zeros((n, 3, 3)),
        C5=C5,
        c6=zero,
        c7=np.zeros((n, n, 3)),
        c8=unit,
        stiffness=50 * unit,
        damping=np.zeros((n, n)),
    )
    return derive.lower(derive.derive_modal(body, None, "flat"))


@pytest.mark.parametrize("n", [8, 32])
def test_moments_of_inertia_share_their_sum(n: int) -> None:
    """J_11 and J_33 differ by a constant: squares, n - 1 additions, and one for the constant."""
    assert model(n).kernel("mass").operations == 2 * n


@pytest.mark.parametrize("n", [8, 32])
def test_rows_of_shapes_share_the_square_of_the_spin(n: int) -> None:
    """K alpha - alpha (oo_11 + oo_33): three operations a shape, two for J and two for Sdot."""
    few, many = (model(k).kernel("force").operations for k in (n, 2 * n))
    assert many - few == 7 * n


@pytest.mark.parametrize("name", ["mass", "force"])
def test_no_long_chain_of_additions(name: str) -> None:
    """The sums over 32 shapes are balanced trees of chains of eight terms; what follows takes four more additions."""
    assert longest_chain(model(32).kernel(name)) <= 7 + 2 + 4


def test_a_sum_of_equal_quantities_is_a_product() -> None:
    """Where two such sums were, -a - b with a = b became -2 + a."""
    a, b = local("a"), local("b")
    constants = [ModelConstant(symbol, sp.Rational(9, 10), "", "", "") for symbol in (a, b)]
    sums = SharedSums([Intermediate(local(f"sum_{sign}"), sign * (a + b), "", "", "") for sign in (-1, 1)], constants)
    assert sums.divided(-a - b) == (-2 * a, ())


def longest_chain(kernel: Kernel) -> int:
    """The largest number of additions and subtractions of which each needs the one before."""
    depths: dict[str, int] = {}

    def depth(expr: Expr) -> int:
        if isinstance(expr, ScalarRef):
            return depths.get(expr.name, 0)
        if not isinstance(expr, Operation):
            return 0
        return (expr.kind in (Operator.ADD, Operator.SUB)) + max(map(depth, expr.args))

    for item in kernel.statements:
        value = depth(item.expr)
        if isinstance(item, Let):
            depths[item.name] = value
    return max(depths.values())
