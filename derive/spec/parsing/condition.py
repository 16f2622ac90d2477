"""Conditions on the columns of a trajectory, such as "rod_phi > pi/2", read by a parser that accepts nothing else."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from derive.errors import quoted
from derive.spec.parsing.faults import did_you_mean, names_text
from derive.spec.parsing.parser import ExpressionError, Parser, Token

Row = Mapping[str, float]
"""The values of columns by their names."""
Evaluate = Callable[[Row], float]

FUNCTIONS: dict[str, Callable[[float], float]] = {
    "sin": math.sin,
    "cos": math.cos,
    "sqrt": math.sqrt,
    "exp": math.exp,
    "log": math.log,
    "tanh": math.tanh,
    "abs": abs,
}


@dataclass(frozen=True)
class Condition:
    """A comparison of two expressions of columns: `text` as it is written, `names` those of its columns.

    value: the value for a row; the condition holds where it is positive, or, with `crossing`, where its sign changes.
    """

    text: str
    names: frozenset[str]
    value: Evaluate
    crossing: bool


def condition(text: str, columns: Collection[str] | None = None) -> Condition:
    """The condition that `text` denotes: two expressions with <, > or = between; `columns` are the names it may use.

    Any names are accepted if `columns` is None. Raises ExpressionError.
    """
    sides = re.fullmatch(r"([^<>=]+)(<=?|>=?|==?)([^<>=]+)", text)
    if sides is None:
        raise ExpressionError(
            f'{quoted(text)} is no comparison; write one such as "rod_phi > pi/2" or "slider_s = 0.2"'
        )
    left, right = (_Columns(side, columns) for side in (sides[1], sides[3]))
    a, b = left.parse(), right.parse()
    sign = -1.0 if sides[2].startswith("<") else 1.0
    names = frozenset(left.used | right.used)
    return Condition(text.strip(), names, lambda row: sign * (a(row) - b(row)), sides[2].startswith("="))


class _Columns(Parser[Evaluate]):
    made_of = "a condition is made of columns, numbers, pi, + - * / ^, parentheses and " + ", ".join(FUNCTIONS)
    names: ClassVar[tuple[str, ...]] = ("a column", "pi")
    functions: ClassVar[tuple[str, ...]] = tuple(FUNCTIONS)

    def __init__(self, text: str, columns: Collection[str] | None) -> None:
        super().__init__(text)
        self.columns, self.used = columns, set[str]()

    def _name(self, token: Token) -> Evaluate:
        if token.text in self.functions or self._next.text == "(":
            return super()._name(token)
        return self.named(token.text, token)

    def constant(self, value: Fraction, at: Token) -> Evaluate:
        number = float(value)
        return lambda row: number

    def named(self, name: str, at: Token) -> Evaluate:
        if name == "pi":
            return lambda row: math.pi
        if self.columns is not None and name not in self.columns:
            known = f"the columns are {names_text(self.columns)}"
            self.fail(at, f"there is no column {quoted(name)}{did_you_mean(name, self.columns, known)}")
        self.used.add(name)
        return lambda row: row[name]

    def called(self, function: str, arguments: tuple[Evaluate, ...], at: Token) -> Evaluate:
        if len(arguments) != 1:
            self.fail(at, f"{function} takes one argument, and here are {len(arguments)}")
        (argument,) = arguments
        return lambda row: FUNCTIONS[function](argument(row))

    def added(self, a: Evaluate, b: Evaluate, at: Token) -> Evaluate:
        return lambda row: a(row) + b(row)

    def negative(self, a: Evaluate, at: Token) -> Evaluate:
        return lambda row: -a(row)

    def times(self, a: Evaluate, b: Evaluate, at: Token) -> Evaluate:
        return lambda row: a(row) * b(row)

    def divided(self, a: Evaluate, b: Evaluate, at: Token, divisor_at: Token) -> Evaluate:
        return lambda row: a(row) / b(row)

    def raised(self, a: Evaluate, power: int, at: Token) -> Evaluate:
        return lambda row: a(row) ** power
