"""The constants that setup computes: expressions of model constants, under names that describe them."""

from __future__ import annotations

from fractions import Fraction
from itertools import count

from derive.ir.expressions import BINARY_OPERATORS, Expr, Number, Operation, Operator, ScalarRef, walk
from derive.ir.statements import Require, Requirement, ReturnCode

WORDS = {
    **{kind: kind.value for kind in BINARY_OPERATORS},
    **{Operator.ADD: "plus", Operator.SUB: "minus", Operator.MUL: "times", Operator.DIV: "over"},
}
MAX_NAME = 60
"""The longest name that a constant gets from its expression; others are numbered."""


class Constants:
    """The constants and checks that setup computes for all kernels of a model.

    coefficients: the names of the model constants that are not numbers. of_instances: those that differ from instance
    to instance, which tables hold, with their expressions. hoisted: expressions of coefficients, by their names.
    requirements: checks of values that depend on constants alone.
    """

    def __init__(self, coefficients: frozenset[str]) -> None:
        self.coefficients = coefficients
        self.of_instances: frozenset[str] = frozenset()
        self.hoisted: dict[Expr, str] = {}
        self.requirements: list[Require] = []
        self._numbers = count(1)

    def require(self, kind: Requirement, expr: Expr, code: ReturnCode, text: str) -> None:
        """Add a check in setup of a value that depends on constants alone."""
        if not any(r.kind == kind and r.expr == expr for r in self.requirements):
            self.requirements.append(Require(kind, expr, code, text))

    def name(self, expr: Expr) -> str:
        """The name of the constant whose value is an expression of coefficients."""
        if expr not in self.hoisted:
            name = self.hoisted[expr] = self._describe(expr) or f"constant_{next(self._numbers)}"
            if any(isinstance(part, ScalarRef) and part.name in self.of_instances for part in walk(expr)):
                self.of_instances |= {name}
        return self.hoisted[expr]

    def _describe(self, expr: Expr) -> str | None:
        """The expression in words; None if they are too long, or if another constant has that name."""
        name = _in_words(expr)
        taken = name in self.coefficients or name in self.hoisted.values()
        return None if taken or len(name) > MAX_NAME or not name.isidentifier() else name


def _in_words(expr: Expr) -> str:
    """A name for a constant expression, such as `c6_2_over_c8_2_2`; factors that are numbers come last."""
    match expr:
        case ScalarRef(name):
            return name
        case Number(Fraction(numerator=1, denominator=d)) if d > 2**20 and d & (d - 1) == 0:
            return f"2_pow_minus_{d.bit_length() - 1}"
        case Number(Fraction(numerator=n, denominator=d)):
            size = str(abs(n)) if d == 1 else f"{abs(n)}_over_{d}"
            return f"minus_{size}" if n < 0 else size
        case Operation(Operator.DIV, (Number(Fraction(numerator=1, denominator=1)), divisor)):
            return f"inverse_{_in_words(divisor)}"
        case Operation(Operator.DIV, (Number() as number, divisor)):
            return f"inverse_{_in_words(divisor)}_times_{_in_words(number)}"
        case Operation(Operator.ADD | Operator.MUL as kind, (Number() as number, other)):
            return f"{_in_words(other)}_{WORDS[kind]}_{_in_words(number)}"
        case Operation(Operator.SUB, (Number() as number, other)):
            return f"minus_{_in_words(other)}_plus_{_in_words(number)}"
        case Operation(kind, (first, second)):
            return f"{_in_words(first)}_{WORDS[kind]}_{_in_words(second)}"
        case Operation(kind, (operand,)):
            return f"{'minus' if kind is Operator.NEG else kind.value}_{_in_words(operand)}"
    return ""
