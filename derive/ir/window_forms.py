"""Linear forms in neighbouring elements of an array, which operations on expressions make."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from derive.ir.expressions import Expr, Number, Operation, Operator
from derive.ir.indices import IndexTerm
from derive.ir.linear_forms import DENSE, FEWEST_FACTORS

ZERO, ONE = Number(Fraction(0)), Number(Fraction(1))

Window = tuple[str, tuple[IndexTerm, ...]]
"""An array, and the part of the indices that the neighbouring elements of an instance share."""


@dataclass(frozen=True)
class WindowForm:
    """A linear form of the elements of a window: their factors by their places, and the constant term."""

    window: Window | None
    factors: Mapping[int, Expr]
    offset: Expr

    def scaled(self, factor: Expr) -> WindowForm:
        """The form times a factor without elements of a window."""
        return WindowForm(
            self.window, {k: _times(factor, x) for k, x in self.factors.items()}, _times(factor, self.offset)
        )

    def plus(self, other: WindowForm) -> WindowForm | None:
        """The sum; None if the windows differ."""
        if self.window and other.window and self.window != other.window:
            return None
        factors = dict(self.factors)
        for k, x in other.factors.items():
            factors[k] = _plus(factors.get(k, ZERO), x)
        return WindowForm(self.window or other.window, factors, _plus(self.offset, other.offset))

    @property
    def is_dense(self) -> bool:
        """Whether the form has enough factors, and few zeros among them."""
        span = max(self.factors) - min(self.factors) + 1 if self.factors else 0
        return len(self.factors) >= FEWEST_FACTORS and len(self.factors) >= DENSE * span


def combined_forms(kind: Operator, forms: Sequence[WindowForm]) -> WindowForm | None:
    """The form of an operation on forms; None if it is not linear, or if its windows differ."""
    first, *others = forms
    match kind:
        case Operator.NEG:
            return first.scaled(Number(Fraction(-1)))
        case Operator.ADD:
            return first.plus(others[0])
        case Operator.SUB:
            return first.plus(others[0].scaled(Number(Fraction(-1))))
        case Operator.MUL:
            number, form = (first, others[0]) if not first.factors else (others[0], first)
            return None if number.factors else form.scaled(number.offset)
        case Operator.DIV:
            (number,) = others
            if number.factors or not isinstance(number.offset, Number) or not number.offset.value:
                return None
            return first.scaled(Number(1 / number.offset.value))
        case _:
            return None


def _times(a: Expr, b: Expr) -> Expr:
    if ZERO in (a, b):
        return ZERO
    if ONE in (a, b):
        return b if a == ONE else a
    if isinstance(a, Number) and isinstance(b, Number):
        return Number(a.value * b.value)
    return Operation(Operator.MUL, (a, b))


def _plus(a: Expr, b: Expr) -> Expr:
    if ZERO in (a, b):
        return b if a == ZERO else a
    if isinstance(a, Number) and isinstance(b, Number):
        return Number(a.value + b.value)
    return Operation(Operator.ADD, (a, b))
