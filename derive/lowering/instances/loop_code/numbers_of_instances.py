"""Expressions of constants with the numbers of one instance, exactly where they are rational."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from derive.ir.expressions import Expr, Leaf, Number, Operation, ScalarRef, mapped
from derive.ir.operator_functions import ARITHMETIC, LIBRARY
from derive.ir.statements import Requirement


def evaluated(expression: Expr, values: Mapping[str, Fraction], hoisted: Mapping[str, Expr]) -> Fraction:
    """An expression of the constants of one instance, exactly where its expression is rational."""

    def of(expr: Expr) -> Fraction:
        match expr:
            case Number():
                return expr.value
            case ScalarRef():
                return values[expr.name] if expr.name in values else of(hoisted[expr.name])
            case Operation():
                call = {**ARITHMETIC, **LIBRARY}[expr.kind]
                return Fraction(call(*map(of, expr.args)))
        raise AssertionError("constants have no arrays")

    return of(expression)


def with_numbers(expression: Expr, numbers: Mapping[str, Fraction], hoisted: Mapping[str, Expr]) -> Expr:
    """An expression of constants with numbers for some of them, also in the expressions that constants stand for."""

    def leaf(part: Leaf) -> Expr:
        if not isinstance(part, ScalarRef):
            return part
        if part.name in numbers:
            return Number(numbers[part.name])
        inner = mapped(hoisted[part.name], leaf) if part.name in hoisted else part
        return part if inner == hoisted.get(part.name) else inner

    return mapped(expression, leaf)


def meets(kind: Requirement, expression: Expr) -> bool:
    """Whether an expression of numbers meets a requirement."""
    try:
        value = evaluated(expression, {}, {})
    except ArithmeticError:
        return False
    return kind is not Requirement.POSITIVE or value > 0
