"""The check by which kernels refuse a quaternion of length zero, which is no rotation.

A quaternion is assumed to have unit length: of one with the length s the kernels make s^2 times a rotation tensor,
and integrators normalise it. Zero would make the body vanish without a word. What is wrong with an argument comes
before what follows from it: where the quaternion is NaN, accel reports it, and not the pivots that are NaN as well.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import reduce

from derive.ir.expressions import Expr, Operation, Operator, ScalarRef
from derive.ir.kernel import Kernel, Section
from derive.ir.statements import Require, Requirement, ReturnCode
from derive.mechanics.equations import Equations
from derive.roles import Role

COMPONENTS = 4
ZERO_QUATERNION = "the quaternion is zero or NaN"


def with_attitude_check(kernel: Kernel, equations: Equations) -> Kernel:
    """The kernel, with a check before everything else if it reads a quaternion."""
    checks = attitude_checks(equations, kernel.used)
    if not checks:
        return kernel
    section = Section("attitude", "", "check that the quaternion is neither zero nor NaN", checks)
    return replace(kernel, sections=(section, *kernel.sections))


def attitude_checks(equations: Equations, used: Collection[str]) -> tuple[Require, ...]:
    """The checks of the quaternions of which some elements are used."""
    every = [str(c.q) for c in equations.coordinates if c.role is Role.QUATERNION]
    quaternions = [every[start : start + COMPONENTS] for start in range(0, len(every), COMPONENTS)]
    return tuple(map(_check, (elements for elements in quaternions if {*elements} & {*used})))


def _check(elements: Sequence[str]) -> Require:
    """The check of the quaternion with these elements."""
    squares: list[Expr] = [Operation(Operator.MUL, (ScalarRef(e), ScalarRef(e))) for e in elements]
    return Require(Requirement.POSITIVE, reduce(_sum, squares), ReturnCode.NOT_FINITE, ZERO_QUATERNION)


def _sum(a: Expr, b: Expr) -> Expr:
    return Operation(Operator.ADD, (a, b))
