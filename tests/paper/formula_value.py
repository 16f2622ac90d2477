"""The value of a formula of the audit: vectors, tensors and columns of them as arrays of SymPy expressions.

A value has its shape indices first and its components last. Factors are taken from left to right; `.`, `><` and `:`
multiply components, factors beside each other are scaled, or form a dyad, and a row times a column is summed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from derive.report.document.formula import (
    Call,
    Fenced,
    Formula,
    FormulaRow,
    Name,
    NumberToken,
    OperatorToken,
    Power,
    Quotient,
)

CROSS = "\u00d7"


@dataclass(frozen=True)
class Value:
    """`columns` is the number of shape indices; `row` says that it is transposed."""

    data: np.ndarray
    columns: int = 0
    row: bool = False

    @property
    def rank(self) -> int:
        return self.data.ndim - self.columns


def scalar(x: Any) -> Value:
    return Value(np.array(sp.sympify(x), dtype=object))


def tensor(matrix: sp.Matrix) -> Value:
    """A vector or a tensor."""
    data = np.array(matrix.tolist(), dtype=object)
    return Value(data[:, 0] if matrix.cols == 1 else data)


def column(entries: Sequence[Any]) -> Value:
    """A column, or a table, of scalars, vectors or tensors."""
    if isinstance(entries[0], list | tuple):
        parts = [column(row) for row in entries]
    else:
        parts = [tensor(e) if isinstance(e, sp.MatrixBase) else scalar(e) for e in entries]
    return Value(np.array([p.data for p in parts], dtype=object), parts[0].columns + 1)


Names = Mapping[str, Value]


@dataclass(frozen=True)
class Meaning:
    """The values of names, and the way to integrate: `integral` gets an integrand as a function of the names."""

    names: Names
    integral: Callable[[Callable[[Names], Value]], Value] | None = None

    def value(self, formula: Formula) -> Value:
        return _Evaluation(self.names, self.integral).value(formula)


def product(sign: str, a: Value, b: Value) -> Value:
    contracted = {"·": 1, ":": 2}.get(sign, 0)
    summed = sign == "" and a.columns > 0 and b.columns > 0 and not b.row
    left, right = _letters(a, "abcdef"), _letters(b, "uvwxyz")
    if summed:
        right = left[a.columns - 1] + right[1:]
    if contracted:
        right = right[: b.columns] + left[len(left) - contracted :] + right[b.columns + contracted :]
    if sign == CROSS:
        crossed = [product("", _component(a, i), _component(b, j)).data for i in range(3) for j in range(3)]
        pairs = ((5, 7), (6, 2), (1, 3))
        data = np.stack([crossed[p] - crossed[q] for p, q in pairs], axis=-1)
        return Value(data, data.ndim - 1)
    shared = set(left) & set(right)
    shapes = [x for x in left[: a.columns] + right[: b.columns] if x not in shared]
    components = [x for x in left[a.columns :] + right[b.columns :] if x not in shared]
    data = np.einsum(f"{left},{right}->{''.join(shapes + components)}", a.data, b.data)
    return Value(np.asarray(data, dtype=object), len(shapes), a.row and not summed)


def _letters(value: Value, letters: str) -> str:
    return letters[: value.data.ndim]


def _component(value: Value, k: int) -> Value:
    return Value(np.asarray(value.data[..., k], dtype=object), value.columns, value.row)


@dataclass
class _Evaluation:
    names: Names
    integral: Callable[[Callable[[Names], Value]], Value] | None

    def value(self, formula: Formula) -> Value:
        match formula:
            case NumberToken(text):
                return scalar(sp.Integer(text))
            case Quotient(above, below):
                return product("", self.value(above), scalar(1 / self.value(below).data.item()))
            case Fenced(of):
                return self.value(of)
            case Name():
                return self._name(formula)
            case Power(base, Name("c")):
                return self._conjugate(self.value(base))
            case Power(base, exponent):
                return scalar(self.value(base).data.item() ** self.value(exponent).data.item())
            case Call(name, of):
                return scalar(getattr(sp, name)(self.value(of).data.item()))
            case FormulaRow(parts):
                return self._sum(list(parts))
        raise TypeError(formula)

    def _name(self, name: Name) -> Value:
        key = "_".join((name.text + name.dots * "'", *name.below))
        found = self.names[key]
        if name.above == ("c",):
            return self._conjugate(found)
        return Value(found.data, found.columns, row=True) if name.above == ("T",) else found

    def _conjugate(self, value: Value) -> Value:
        return Value(np.swapaxes(value.data, -1, -2), value.columns)

    def _sum(self, parts: list[Formula]) -> Value:
        terms: list[tuple[int, list[Formula]]] = [(1, [])]
        inside = False
        for part in parts:
            inside = (inside or _is_integral(part)) and part != OperatorToken("d")
            if part in (OperatorToken("+"), OperatorToken("-")) and not inside:
                terms.append((1 if part == OperatorToken("+") else -1, []))
            else:
                terms[-1][1].append(part)
        values = [(sign, self._product(factors)) for sign, factors in terms if factors]
        sign, first = values[0]
        data = sign * first.data
        for sign, value in values[1:]:
            data = data + sign * value.data
        return Value(np.asarray(data, dtype=object), first.columns, first.row)

    def _product(self, factors: list[Formula]) -> Value:
        total, sign = scalar(1), ""
        at = 0
        while at < len(factors):
            factor = factors[at]
            at += 1
            if isinstance(factor, OperatorToken) and factor.text in ("·", CROSS, ":", "/"):
                sign = factor.text
                continue
            if _is_integral(factor):
                end = factors.index(OperatorToken("d"), at)
                integrand = FormulaRow(tuple(factors[at:end]))
                assert self.integral is not None
                found = self.integral(lambda names, f=integrand: _Evaluation(names, self.integral).value(f))
                at = end + 2
            elif isinstance(factor, Power) and factor.base == OperatorToken("∂"):
                found, at = self.names["second derivative"], at + 4
            elif isinstance(factor, OperatorToken):  # delta x, d X
                following = factors[at]
                assert isinstance(following, Name)
                found, at = self.names[f"{factor.text} {following.text}"], at + 1
            elif factor == Name("tr", style="word"):
                found, at = scalar(sum(self.value(factors[at]).data.diagonal())), at + 1
            else:
                found = self.value(factor)
            if sign == "/":
                sign, found = "", scalar(1 / found.data.item())
            total, sign = product(sign, total, found), ""
        return total


def _is_integral(formula: Formula) -> bool:
    return isinstance(formula, Name) and formula.text == "∫"
