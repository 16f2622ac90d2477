"""The number that a formula is, when its symbols have numbers: so that a wrong sign or factor on a page is noticed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np
import sympy as sp

from derive.mechanics.fixed_symbols import MASS
from derive.mechanics.typed_symbol import Symbol
from derive.report.document.formula import (
    Call,
    Fenced,
    Formula,
    FormulaRow,
    Name,
    NumberToken,
    OperatorToken,
    Part,
    Power,
    Quotient,
    Root,
)
from derive.report.notation.expressions import Notation

Numbers = Mapping[Formula, float]
SUM = "\N{N-ARY SUMMATION}"


def number(formula: Formula | None, known: Numbers) -> float:
    """The number of a formula; `known` has those of the symbols, as they are written."""
    if formula is None:
        return 0.0  # a structural zero
    if formula in known:
        return known[formula]
    match formula:
        case NumberToken(text):
            return float(text)
        case Name() if formula.text == SUM:
            return 1.0  # one summand of it
        case FormulaRow(parts):
            return _row(parts, known)
        case Quotient(above, below):
            return number(above, known) / number(below, known)
        case Power(base, exponent):
            return number(base, known) ** number(exponent, known)
        case Root(of):
            return math.sqrt(number(of, known))
        case Fenced(of):
            return number(of, known)
        case Call(name, of):
            return {"sin": math.sin, "cos": math.cos}[name](number(of, known))
    raise KeyError(formula)


def _row(parts: tuple[Formula, ...], known: Numbers) -> float:
    """A sum of products."""
    total, product, sign = 0.0, 1.0, 1.0
    for k, part in enumerate(parts):
        if isinstance(part, OperatorToken):
            assert part.text in ("+", "-")
            total, product = total + sign * product if k else 0.0, 1.0
            sign = -1.0 if part.text == "-" else 1.0
        else:
            product *= number(part, known)
    return total + sign * product


def total(parts: Iterable[Part], known: Numbers) -> float:
    """The number of a sum."""
    return sum((1.0 if p.sign == "+" else -1.0) * number(p.formula, known) for p in parts)


def magnitude(parts: Iterable[Part], known: Numbers) -> float:
    """The sum of the magnitudes of the parts of an equation."""
    return sum(abs(number(p.formula, known)) for p in parts)


class Draw:
    """Random numbers for symbols, and for the formulas that they are written as. No two symbols are written alike."""

    def __init__(self, notation: Notation, seed: int = 5) -> None:
        self.notation = notation
        self.symbols: dict[sp.Symbol, float] = {}
        self.formulas: dict[Formula, float] = {}
        self._owner: dict[Formula, sp.Symbol] = {}
        self._rng = np.random.default_rng(seed)

    def add(self, *exprs: sp.Expr) -> None:
        """Draw numbers for the symbols of expressions."""
        symbols = {s for expr in exprs for s in sp.sympify(expr).free_symbols}
        for symbol in sorted(symbols - self.symbols.keys(), key=str):
            same = self._same(symbol)
            if same not in self.symbols:
                self.give(same, float(self._rng.uniform(0.5, 2.0)))
            self.give(symbol, self.symbols[same])

    def give(self, symbol: sp.Symbol, value: float) -> None:
        """A number for one symbol."""
        written, owner = self.notation.formula(symbol), self._same(symbol)
        assert self._owner.setdefault(written, owner) == owner, f"{symbol} and {self._owner[written]}"
        self.symbols[symbol] = value
        self.formulas[written] = value
        self.formulas[self.notation.written(symbol).formula] = value

    def _same(self, symbol: sp.Symbol) -> sp.Symbol:
        """The symbol that stands for the same: an integral for the parameter that it is, m for the mass."""
        if symbol == MASS and self.notation.mass is not None:
            return self.notation.mass
        if isinstance(symbol, Symbol) and symbol.identity.parameter:
            return Symbol(replace(symbol.identity, parameter=False))
        return symbol

    def of(self, expr: sp.Expr) -> float:
        """The number of an expression."""
        values = {s: sp.Float(self.symbols[s]) for s in expr.free_symbols}
        return float(expr.xreplace(values))
