"""Numbers in the motion of a body from its reactions: one product for all terms that have the same number."""

from __future__ import annotations

from fractions import Fraction

import pytest

from derive.ir.analysis import expressions
from derive.ir.expressions import Expr, Number, Operation, Operator, walk
from derive.ir.statements import ForEach, InstanceItem, Let, inside
from kernel.test_instance_lanes import looped

SUMS = (Operator.ADD, Operator.SUB)


def number_of(expr: Expr) -> Fraction | None:
    """The magnitude of the number that multiplies the other factor of a product."""
    if not isinstance(expr, Operation) or expr.kind is not Operator.MUL:
        return None
    return next((abs(arg.value) for arg in expr.args if isinstance(arg, Number)), None)


def lines(kernel: str, section: str) -> list[InstanceItem]:
    """The statements of the loops over bodies in a section of a kernel of three beams."""
    (body,) = (s.body for s in looped("chain_3").kernel(kernel).sections if s.name == section)
    return [item for loop in body if isinstance(loop, ForEach) for item in inside(loop)]


@pytest.mark.parametrize("kernel", ["accel", "solve"])
def test_terms_with_one_number_have_one_product(kernel: str) -> None:
    """Mass and stiffness of a beam are numbers here, by which the reactions at both of its ends are divided."""
    parts = [part for line in lines(kernel, "unknowns") for expr in expressions(line) for part in walk(expr)]
    sums = [part for part in parts if isinstance(part, Operation) and part.kind in SUMS]
    assert sums
    numbers = [[number_of(arg) for arg in part.args] for part in sums]
    assert not [pair for pair in numbers if pair[0] is not None and pair[0] == pair[1]]


def test_free_motion_has_its_coordinate_once() -> None:
    """A deflection accelerates by itself times the difference of two squares of angular velocities."""
    free = [line for line in lines("accel", "bodies") if isinstance(line, Let) and line.name.endswith("_alpha1")]
    (value,) = {line.expr for line in free if line.name.startswith("free")}
    products = [part for part in walk(value) if isinstance(part, Operation) and part.kind is Operator.MUL]
    assert len(products) == 1
