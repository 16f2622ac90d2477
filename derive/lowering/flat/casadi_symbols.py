"""The conversion of SymPy expressions of the derivation to CasADi expressions.

The constants of CasADi are doubles, so that exact numbers would be rounded. Therefore every number that is not an
integer becomes a CasADi symbol; `Symbols.leaves` maps these symbols to the leaves of the kernel.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from fractions import Fraction
from functools import partial, reduce

import casadi as ca

from derive.algebra import fraction, sp
from derive.ir.expressions import Expr, Leaf, Number, Operation, Operator, ScalarRef, TableValue
from derive.lowering.flat.shared_sums import SharedSums
from derive.lowering.flat.term_order import FactorPlace, TermOrder
from derive.mechanics.time_functions import (
    Absolute,
    Atan2,
    Exp,
    Log,
    Lookup,
    Maximum,
    Minimum,
    Select,
    Sign,
    SmoothStep,
    Tanh,
    Wrapped,
)

added, subtracted, multiplied, divided = (
    partial(ca.SX.binary, operation) for operation in (ca.OP_ADD, ca.OP_SUB, ca.OP_MUL, ca.OP_DIV)
)
"""Operations on two CasADi scalars.

The operators of Python do the same and take eight times as long, since they look for NumPy arrays first.
"""

CHAIN = 8
"""The largest number of terms of a sum that are added one after the other."""


class Symbols:
    """The CasADi values of SymPy symbols, and the kernel leaves of CasADi symbols.

    early, late: the symbols that come first and last in products, see `TermOrder`. model: the name of the model, with
    which the functions of its tables begin. sums: what sums share. fixed: the values of symbols whose definitions a
    function computes in another way.
    """

    def __init__(
        self,
        early: frozenset[sp.Symbol],
        late: frozenset[sp.Symbol],
        model: str = "",
        sums: SharedSums | None = None,
    ) -> None:
        self.order, self.model = TermOrder(early, late, sums or SharedSums()), model
        self.values: dict[sp.Symbol, ca.SX] = {}
        self.inputs: list[ca.SX] = []
        self.leaves: list[Leaf] = []
        self.fixed: dict[sp.Symbol, ca.SX] = {}
        self._numbers: dict[Fraction, ca.SX] = {}
        self._converted: dict[sp.Expr, ca.SX] = {}

    def copy(self) -> Symbols:
        """A copy of the symbols and values, to which others can be added."""
        result = copy(self)
        result.values, result.inputs, result.leaves = dict(self.values), [*self.inputs], [*self.leaves]
        result.fixed = dict(self.fixed)
        result._numbers, result._converted = dict(self._numbers), dict(self._converted)
        return result

    def input(self, symbol: sp.Symbol, leaf: Leaf) -> None:
        """Declare a symbol whose value is a leaf: an element of an argument, a coefficient, or a number."""
        self.values[symbol] = self._leaf(leaf)

    def define(self, symbol: sp.Symbol, expr: sp.Expr) -> ca.SX:
        """Define the value of a symbol, by an expression if it is not fixed, and return it."""
        self.values[symbol] = self.fixed[symbol] if symbol in self.fixed else self(expr)
        return self.values[symbol]

    def values_of(self, symbols: Iterable[sp.Symbol]) -> list[ca.SX]:
        """The values of several symbols."""
        return [self.values[symbol] for symbol in symbols]

    def evaluated(self, exprs: Iterable[sp.Expr], values: Mapping[sp.Symbol, ca.SX]) -> list[ca.SX]:
        """The CasADi values of expressions in which some symbols, which have no value otherwise, have these values."""
        before = self.values, self._converted
        self.values, self._converted = {**self.values, **values}, {}
        result = [self(expr) for expr in exprs]
        self.values, self._converted = before
        return result

    @property
    def lookups(self) -> dict[Lookup, ca.SX]:
        """The look-ups in tables so far, and their CasADi symbols."""
        return {expr: value for expr, value in self._converted.items() if isinstance(expr, Lookup)}

    def number(self, value: Fraction) -> ca.SX:
        """The CasADi value of an exact number."""
        if value.denominator == 1 and abs(value.numerator) < 2**53:
            return ca.SX(int(value))
        return self._exact(value)

    def divisor(self, expr: sp.Expr) -> ca.SX:
        """The CasADi value of an expression that may divide: CasADi would round the quotients of whole numbers."""
        if expr.is_Rational and expr.q == 1 and abs(expr.p) > 1:
            return self._exact(Fraction(int(expr.p)))
        return self(expr)

    def _exact(self, value: Fraction) -> ca.SX:
        """A symbol for a number, because CasADi rounds constants, for example in the derivative of x / 10."""
        if value not in self._numbers:
            self._numbers[value] = self._leaf(Number(value))
        return self._numbers[value]

    def _leaf(self, leaf: Leaf) -> ca.SX:
        """A new CasADi symbol for a leaf."""
        symbol = ca.SX.sym(f"in{len(self.leaves)}")
        self.inputs.append(symbol)
        self.leaves.append(leaf)
        return symbol

    def __call__(self, expr: sp.Expr) -> ca.SX:
        """The CasADi value of an expression of +, *, powers, square roots and `CALLS`. Raises TypeError."""
        if expr not in self._converted:
            self._converted[expr] = self._convert(sp.sympify(expr))
        return self._converted[expr]

    def _convert(self, expr: sp.Expr) -> ca.SX:
        if expr.is_Symbol:
            return self.values[expr]
        if expr.is_Rational:
            return self.number(fraction(expr))
        if expr.is_Add:
            return self._sum(expr)
        if expr.is_Mul or expr.is_Pow:
            return self._product(expr)
        if isinstance(expr, Lookup):
            return self._table_value(expr)
        if isinstance(expr, SmoothStep):
            return self._smooth_step(expr)
        if type(expr) in CALLS:
            return self.call(CALLS[type(expr)], *map(self, expr.args))
        raise TypeError(f"no lowering for {expr.func.__name__}: {expr}")

    def call(self, function: Callable[..., ca.SX], *args: ca.SX) -> ca.SX:
        """The value of a function; CasADi would evaluate and round one of numbers alone, as cos(1) is."""
        first, *others = args
        if all(arg.is_constant() for arg in args):
            first = self._exact(Fraction(int(first)))
        return function(first, *others)

    def _smooth_step(self, expr: SmoothStep) -> ca.SX:
        """A smooth step from x0 to x1, or a derivative of it, by which CasADi must not round 1 / (x1 - x0)."""
        x, x0, x1, order = expr.args
        difference = x1 - x0
        exact = difference.is_Rational
        width = self._exact(fraction(difference)) if exact else self(difference)
        s = ca.fmin(ca.fmax((self(x) - self(x0)) / width, 0), 1)
        return _smooth_polynomial(s, width, int(order))

    def _table_value(self, expr: Lookup) -> ca.SX:
        """A look-up in a table, which CasADi knows as a symbol; its argument depends on t and constants alone."""
        table, order, argument = expr.args
        return self._leaf(TableValue(table_name(self.model, str(table)), int(order), _argument(argument)))

    def _sum(self, expr: sp.Expr) -> ca.SX:
        """A sum in a fixed order. A long one is made of several, whose additions do not wait for each other."""
        order = self.order.sum(expr)
        if order.varying is not None:
            return reduce(added, map(self, order.constant), self(order.varying))
        sign, total = self._total(order.terms)
        return total if sign > 0 else -total

    def _total(self, terms: Sequence[tuple[int, sp.Expr]]) -> tuple[int, ca.SX]:
        """The sign and the value of a sum of terms with their signs, of which positive ones come first."""
        if len(terms) > CHAIN:
            half = (len(terms) + 1) // 2
            (sign, first), (other, second) = self._total(terms[:half]), self._total(terms[half:])
            return sign, (added if sign == other else subtracted)(first, second)
        sign = terms[0][0]
        total = self(terms[0][1])
        for other, term in terms[1:]:
            total = (added if other == sign else subtracted)(total, self(term))
        return sign, total

    def _product(self, expr: sp.Expr) -> ca.SX:
        """A product: early factors, one division, the number, then the other factors, so that terms share prefixes."""
        order = self.order.product(expr)
        magnitude = order.magnitude
        factors: dict[FactorPlace, list[ca.SX]] = {place: [] for place in FactorPlace}
        for base, place, root, count in order.factors:
            value = self.call(ca.sqrt, self(base)) if root else self(base)
            value = 2 * value if base == order.doubled else value
            factors[place].extend([value] * count)
        first, last, below = factors.values()
        if magnitude.numerator == 1 and (first or last) and not _is_dyadic(magnitude):
            below.append(self._exact(1 / magnitude))  # m/7 is rounded once, m*(1/7) twice
        elif magnitude != 1 or not (first or last):
            last.insert(0, self.number(magnitude))
        if not first:
            first, last = last, []
        result = reduce(multiplied, first)
        if below:
            result = divided(result, reduce(multiplied, below))
        result = reduce(multiplied, last, result)
        return -result if order.negative else result


def table_name(model: str, table: str) -> str:
    """The name of the function of a table in the generated code."""
    return f"{model}_spline_{table}"


def _argument(expr: sp.Expr) -> Expr:
    """The argument of a table as an expression of a kernel: numbers, names, sums, products and quotients."""
    if expr.is_Symbol:
        return ScalarRef(expr.name)
    if expr.is_Rational:
        return Number(fraction(expr))
    if expr.is_Add or expr.is_Mul:
        kind = Operator.ADD if expr.is_Add else Operator.MUL
        return reduce(
            lambda a, b: Operation(kind, (a, b)),
            map(_argument, expr.as_ordered_factors() if expr.is_Mul else expr.as_ordered_terms()),
        )
    if expr.is_Pow and expr.exp == -1:
        return Operation(Operator.DIV, (Number(Fraction(1)), _argument(expr.base)))
    raise TypeError(f"no lowering for {expr.func.__name__} in the argument of a table: {expr}")


def _smooth_polynomial(s: ca.SX, width: ca.SX, order: int) -> ca.SX:
    """A derivative of the polynomial of degree five; s is constant outside, where the derivatives vanish."""
    match order:
        case 0:
            return s * s * s * (10 + s * (6 * s - 15))
        case 1:
            return 30 * s * s * (1 - s) * (1 - s) / width
        case 2:
            return 60 * s * (1 - s) * (1 - 2 * s) / (width * width)
    raise TypeError("a smooth step has two continuous derivatives; there is no lowering for further ones")


def _absolute(x: ca.SX) -> ca.SX:
    """CasADi's own fabs also stands for the root of a square, which has its own message."""
    return ca.sign(x) * x


CALLS: dict[type[sp.Expr], Callable[..., ca.SX]] = {
    sp.sin: ca.sin,
    sp.cos: ca.cos,
    Exp: ca.exp,
    Log: ca.log,
    Tanh: ca.tanh,
    Sign: ca.sign,
    Absolute: _absolute,
    Atan2: ca.atan2,
    Wrapped: lambda x, s: s * ca.atan2(ca.sin(x / s), ca.cos(x / s)),
    Minimum: ca.fmin,
    Maximum: ca.fmax,
    Select: lambda a, b, x, y: ca.if_else(a < b, x, y),
}
"""The functions of expressions."""


def _is_dyadic(value: Fraction) -> bool:
    return value.denominator & (value.denominator - 1) == 0
