"""Conversion of SymPy expressions of the derivation to functions of time, and to text in the notation of a user."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import reduce

from derive.algebra import fraction, sp
from derive.errors import TisserandError
from derive.mechanics.fixed_symbols import t
from derive.mechanics.quantity import function_constant
from derive.mechanics.time_functions import (
    Absolute,
    Atan2,
    Exp,
    Log,
    Lookup,
    Maximum,
    Minimum,
    Select,
    SmoothStep,
    Tanh,
)
from derive.spec.model.quantity import Parameter
from derive.spec.model.time_function import Spline, TimeFunction


class NoTimeFunction(TisserandError):
    """An expression is not a function of time that a specification can have."""


KINDS: Mapping[type[sp.Expr], str] = {
    sp.sin: "sin",
    sp.cos: "cos",
    Exp: "exp",
    Log: "log",
    Tanh: "tanh",
    Absolute: "abs",
    Minimum: "min",
    Maximum: "max",
    Atan2: "atan2",
}
"""The kinds of functions whose operands are the arguments of the SymPy expression, by the class of the expression."""


def time_function(expr: sp.Expr, parameters: Iterable[Parameter], splines: Mapping[str, Spline]) -> TimeFunction:
    """The function of time that an expression of t and of the constants of `parameters` is; tables are by name.

    Raises NoTimeFunction.
    """
    constants = {function_constant(p): TimeFunction("parameter", parameter=p) for p in parameters}

    def call(kind: str, *args: sp.Expr) -> TimeFunction:
        return TimeFunction(kind, tuple(map(convert, args)))

    def convert(expr: sp.Expr) -> TimeFunction:
        if expr == t:
            return TimeFunction("t")
        if expr in constants:
            return constants[expr]
        if expr.is_Rational:
            return _number(expr)
        if expr.is_Add:
            return _sum(expr, convert)
        if expr.is_Mul or expr.is_Pow:
            return _product(expr, convert)
        match expr:
            case Select(args=(a, b, x, y)):
                return TimeFunction("piecewise", (call("less", a, b), convert(x), convert(y)))
            case SmoothStep(args=(x, x0, x1, order)) if order == 0:
                return call("step", x, x0, x1)
            case Lookup(args=(name, order, x)) if order == 0:
                return TimeFunction("spline", (convert(x),), spline=splines[str(name)])
        if type(expr) in KINDS:
            return call(KINDS[type(expr)], *expr.args)
        raise NoTimeFunction(str(expr))

    return convert(folded(expr))


def _number(value: sp.Rational) -> TimeFunction:
    return TimeFunction("number", value=fraction(value))


def _sum(expr: sp.Expr, convert: Callable[[sp.Expr], TimeFunction]) -> TimeFunction:
    """A sum in a fixed order, with a positive term first if there is one."""
    terms = [(term.could_extract_minus_sign(), term) for term in sorted(expr.args, key=sp.default_sort_key)]
    terms.sort(key=lambda signed: signed[0])
    (_, first), *others = terms
    result = convert(first)
    for negative, term in others:
        result = TimeFunction("sub" if negative else "add", (result, convert(-term if negative else term)))
    return result


def _product(expr: sp.Expr, convert: Callable[[sp.Expr], TimeFunction]) -> TimeFunction:
    """A product in a fixed order, divided by the product of the factors with negative powers."""
    weight, rest = expr.as_coeff_Mul()
    if weight.is_negative:
        return TimeFunction("neg", (convert(-expr),))
    small = max(weight.p, weight.q) < 2**53  # others are rounded once
    above = [_number(sp.Integer(weight.p) if small else weight)] if weight.p != 1 or not small else []
    below = [_number(sp.Integer(weight.q))] if weight.q != 1 and small else []
    for base, exponent in sorted(map(_factor, sp.Mul.make_args(rest)), key=sp.default_sort_key):
        (above if exponent > 0 else below).append(_power(convert(base), abs(exponent)))
    product = [reduce(lambda a, b: TimeFunction("mul", (a, b)), factors) for factors in (above, below) if factors]
    if not below:
        return product[0]
    return TimeFunction("div", (product[0] if above else _number(sp.S.One), product[-1]))


def _factor(factor: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    base, exponent = factor.as_base_exp()
    if not (2 * exponent).is_Integer:
        raise NoTimeFunction(str(factor))
    return base, exponent


def _power(base: TimeFunction, exponent: sp.Rational) -> TimeFunction:
    """A power with a positive exponent that is whole or half of a whole number."""
    if exponent.q == 2:
        base, exponent = TimeFunction("sqrt", (base,)), 2 * exponent
    return base if exponent == 1 else TimeFunction("pow", (base, _number(exponent)))


def folded(expr: sp.Expr) -> sp.Expr:
    """Replace functions of numbers by their value where it is exact."""
    return expr.replace(_is_known, _known_value)


def _is_known(expr: sp.Expr) -> bool:
    match expr:
        case Select(args=(a, b, _, _)) | Minimum(args=(a, b)) | Maximum(args=(a, b)):
            return bool(a.is_Rational and b.is_Rational)
        case Absolute(args=(a,)):
            return bool(a.is_Rational)
        case Exp(args=(a,)) | Tanh(args=(a,)):
            return bool(a == 0)
        case Log(args=(a,)):
            return bool(a == 1)
    return False


def _known_value(expr: sp.Expr) -> sp.Expr:
    match expr:
        case Select(args=(a, b, x, y)):
            return x if a < b else y
        case Minimum(args=args):
            return min(args)
        case Maximum(args=args):
            return max(args)
        case Absolute(args=(a,)):
            return abs(a)
        case Exp():
            return sp.S.One
    return sp.S.Zero
