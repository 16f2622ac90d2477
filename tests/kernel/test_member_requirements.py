"""Requirements on numbers in which the bodies of a class differ are checked for each body."""

from __future__ import annotations

from fractions import Fraction

import pytest

import derive
from derive.ir.expressions import Expr, Number, Operation, Operator, ScalarRef
from derive.ir.statements import Requirement, ReturnCode
from derive.lowering.flat.graph import LoweringError
from derive.lowering.instances import lower
from derive.lowering.instances.loop_code.context import InstanceContext
from derive.mechanics.multibody.mechanism import Mechanism

MASS = ScalarRef("rod_0_mass")
"""The name of the masses of all members, after the first of them."""


def context(*masses: int) -> InstanceContext:
    """Free beams of one class that differ in their masses."""
    rod = {"ansatz": ["1", "xi", "xi^2"], "bending_stiffness": 1, "length": 1}
    bodies = {f"rod_{k}": {**rod, "mass": mass} for k, mass in enumerate(masses)}
    mechanism = derive.derive(derive.scene("rods", bodies=bodies))
    assert isinstance(mechanism, Mechanism)
    result = InstanceContext(mechanism)
    assert [len(of.of.members) for of in result.classes] == [len(masses)]
    return result


def requirements(of: InstanceContext, expr: Expr) -> list[tuple[Expr, str]]:
    """The checks that setup has of a requirement that a value be positive."""
    of.constants.require(Requirement.POSITIVE, expr, ReturnCode.PIVOT, "a pivot vanished")
    return [(r.expr, r.text) for r in lower._of_all(of).requirements]


def less(first: Expr, second: Expr) -> Expr:
    return Operation(Operator.SUB, (first, second))


def test_numbers_are_checked_at_generation() -> None:
    limit = Number(Fraction(3))
    assert requirements(context(4, 5), less(MASS, limit)) == []
    with pytest.raises(LoweringError, match="rod_1: a pivot vanished, whatever the state"):
        requirements(context(4, 2), less(MASS, limit))
    with pytest.raises(LoweringError, match="rod_0: a pivot vanished"):
        requirements(context(3, 4), Operation(Operator.DIV, (limit, less(MASS, limit))))


def test_constants_that_stand_for_numbers_are_checked() -> None:
    of = context(4, 2)
    name = of.constants.name(less(MASS, Number(Fraction(3))))
    with pytest.raises(LoweringError, match="rod_1: a pivot vanished"):
        requirements(of, ScalarRef(name))


def test_what_depends_on_constants_of_setup_is_checked_there_for_each_body() -> None:
    root = ScalarRef("root_of_two")
    checks = requirements(context(4, 2), less(MASS, root))
    values = [(less(Number(Fraction(mass)), root), f"rod_{k}: a pivot vanished") for k, mass in enumerate((4, 2))]
    assert checks == values
