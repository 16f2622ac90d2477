"""Integrals of functions of time in closed form: what a drive turns through whose speed is a function of t.

An expression is expanded to a sum of products, and each product is integrated by a rule: powers of t times sines,
cosines and exponentials of linear arguments; powers, logarithms and tanh of a linear argument; smooth steps and tables,
whose antiderivatives are polynomials; and products with switches (piecewise functions, steps, abs, min, max), which are
integrated from switch to switch. Each integral is written in the time since its lower end, so that polynomials far from
t = 0 lose no digits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import lru_cache
from math import factorial

import sympy as sp
from sympy.core.symbol import Str

from derive.mechanics.quantity import function
from derive.mechanics.symbols import t
from derive.mechanics.time_expressions import NoTimeFunction, folded, time_function
from derive.mechanics.time_functions import (
    Absolute,
    Exp,
    Log,
    Lookup,
    Maximum,
    Minimum,
    Select,
    SmoothStep,
    Tanh,
    TimeOperation,
)
from derive.spec.model.time_function import TimeFunction, parts

SWITCHES = (Select, SmoothStep, Absolute, Minimum, Maximum)
"""The functions that are another expression on the other side of a time."""
MAX_CHOICES = 64
"""The most choices of two expressions in an integral, which products of many switches exceed."""

SMALLEST = 1e-18
"""Terms of a series below this are left out."""

Linear = tuple[sp.Expr, sp.Expr]
"""The coefficients c and d of an argument c t + d."""


class NoClosedForm(Exception):
    """A function of time whose integral no rule knows; `part` is the product without a rule."""

    def __init__(self, part: TimeFunction | None) -> None:
        super().__init__("the integral has no closed form")
        self.part = part


@lru_cache(maxsize=256)
def time_integral(of: TimeFunction) -> TimeFunction:
    """The integral of a function from 0 to t, as a function of t. Raises NoClosedForm."""
    integrator = _Integrator(of)
    return integrator.written(integrator.integral(function(of), sp.S.Zero, whole=True))


class _Integrator:
    """The rules, with the parameters of a function and the tables that it reads; integrals of tables are added."""

    def __init__(self, of: TimeFunction) -> None:
        self.splines = {part.spline.name: part.spline for part in parts(of) if part.spline is not None}
        self.choices = 0
        self.parameters = tuple(part.parameter for part in parts(of) if part.parameter is not None)

    def written(self, expr: sp.Expr) -> TimeFunction:
        """An expression as a function of time."""
        return time_function(expr, self.parameters, self.splines)

    def integral(self, expr: sp.Expr, base: sp.Expr, whole: bool = False) -> sp.Expr:
        """The integral of an expression from `base`, which does not depend on t, to t.

        whole: whether it is no part of a choice.
        """
        groups: dict[sp.Expr, dict[int, sp.Expr]] = {}
        for term in (term for term in sp.Add.make_args(_expanded(expr)) if term != 0):
            constant, rest = term.as_independent(t, as_Add=False)
            n, others = _power_of_t(rest)
            polynomial = groups.setdefault(others, {})
            polynomial[n] = polynomial.get(n, 0) + constant
        results = []
        for others, polynomial in groups.items():
            try:
                results.append(self._product(polynomial, others, base, whole))
            except NoClosedForm:
                if not whole:
                    raise
                raise NoClosedForm(self._text(_sum(polynomial) * others)) from None  # as it is written, not a choice
        return sp.Add(*results)

    def _product(self, polynomial: dict[int, sp.Expr], others: sp.Expr, base: sp.Expr, whole: bool) -> sp.Expr:
        """The integral of a polynomial, as coefficients of powers of t, times other factors."""
        rules = [self._iterated(n, others, whole) or _smooth(n, others) for n in polynomial]
        if None not in rules:
            return sp.Add(*(c * rule(base) for c, rule in zip(polynomial.values(), rules, strict=True) if rule))
        selection = _selection(others)
        self.choices += 1
        if selection is None or self.choices > MAX_CHOICES:
            raise NoClosedForm(None)
        return self._selected(selection, _sum(polynomial), base)

    def _text(self, term: sp.Expr) -> TimeFunction | None:
        try:
            return self.written(term)
        except NoTimeFunction:
            return None

    def _selected(self, choice: Select, factor: sp.Expr, base: sp.Expr) -> sp.Expr:
        """The integral of a factor times a choice of two expressions."""
        a, end, *values = choice.args
        x, y = (factor * value for value in values)
        if a != t:
            return Select(a, end, self.integral(x, base), self.integral(y, base))
        known = base.is_Rational and end.is_Rational
        if not known or base <= end:
            before, after = self.integral(x, base), self.integral(y, end)
            later = Select(t, end, before, at(before, end) + after)
            if known:
                return later
        before, after = self.integral(x, end), self.integral(y, base)
        sooner = Select(t, end, at(after, end) + before, after)
        return sooner if known else Select(base, end, later, sooner)

    def _iterated(self, n: int, others: sp.Expr, whole: bool) -> Callable[[sp.Expr], sp.Expr] | None:
        """By parts, for t^n times a smooth step or a table of a linear argument, whose antiderivatives are known.

        Between other switches a step is a choice of polynomials, which are shorter when they are multiplied.
        """
        match others:
            case SmoothStep(args=(argument, x0, x1, _)) if whole and (linear := _linear(argument)) is not None:
                return _by_parts(n, linear, lambda x, m: _step_antiderivative(x, x0, x1, m))
            case Lookup(args=(name, _, argument)) if (linear := _linear(argument)) is not None:
                return _by_parts(n, linear, lambda x, m: self._table_antiderivative(str(name), x, m))
        return None

    def _table_antiderivative(self, name: str, x: sp.Expr, m: int) -> sp.Expr:
        """The m-th antiderivative of a table, which is a polynomial of degree m - 1 more outside its rows."""
        spline = self.splines[name]
        inside = Minimum(Maximum(x, _exact(spline.knots[0])), _exact(spline.knots[-1]))
        tables = [spline]
        for order in range(1, m + 1):
            tables.append(tables[-1].antiderivative(f"{name}_integral{order}_"))  # a name that no user can give
        self.splines.update((table.name, table) for table in tables)
        values = (Lookup(Str(table.name), sp.S.Zero, x) for table in reversed(tables))
        return sp.Add(*(value * (x - inside) ** i / factorial(i) for i, value in enumerate(values)))


def _sum(polynomial: dict[int, sp.Expr]) -> sp.Expr:
    """A polynomial in t from its coefficients."""
    return sp.Add(*(c * t**n for n, c in polynomial.items()))


def at(expr: sp.Expr, time: sp.Expr) -> sp.Expr:
    """An expression at a time, with the switches of numbers decided."""
    return folded(sp.sympify(expr).subs(t, time))


def _expanded(expr: sp.Expr) -> sp.Expr:
    """An expression as a sum of products; denominators stay as they are."""
    below = {power: sp.Dummy() for power in expr.atoms(sp.Pow) if power.exp.is_negative and power.base.has(t)}
    return sp.expand(expr.xreplace(below)).xreplace({dummy: power for power, dummy in below.items()})


def _exact(value: float) -> sp.Rational:
    return sp.Rational(value)


def _linear(argument: sp.Expr) -> Linear | None:
    """The coefficients of an argument that is linear in t; None if it is not, or does not depend on t."""
    expanded = sp.expand(argument)
    slope = expanded.coeff(t, 1)
    rest = sp.expand(expanded - slope * t)
    return None if slope == 0 or slope.has(t) or rest.has(t) else (slope, rest)


def _power_of_t(product: sp.Expr) -> tuple[int, sp.Expr]:
    """The exponent n of the factor t^n, and the other factors."""
    exponent = product.as_powers_dict().get(t, 0)
    n = int(exponent) if exponent == int(exponent) and exponent > 0 else 0
    return n, product / t**n


def _by_parts(
    n: int, linear: Linear, antiderivative: Callable[[sp.Expr, int], sp.Expr]
) -> Callable[[sp.Expr], sp.Expr]:
    """The integral of t^n g(c t + d), from the m-th antiderivatives of g as functions of its argument and of m."""
    c, d = linear
    x = c * t + d
    weights = ((-1) ** j * factorial(n) // factorial(n - j) * t ** (n - j) / c ** (j + 1) for j in range(n + 1))
    whole = sp.Add(*(weight * antiderivative(x, j + 1) for j, weight in enumerate(weights)))
    return lambda base: whole - at(whole, base)


def _step_antiderivative(x: sp.Expr, x0: sp.Expr, x1: sp.Expr, m: int) -> sp.Expr:
    """The m-th antiderivative of the smooth step, zero before it."""
    s = sp.Symbol("s")
    polynomials = [s**3 * (10 + s * (6 * s - 15))]
    for _ in range(m):
        polynomials.append(sp.integrate(sp.expand(polynomials[-1]), s))
    width = x1 - x0
    ratio = (x - x0) / width
    inside, behind = Minimum(Maximum(ratio, sp.S.Zero), sp.S.One), Maximum(ratio - 1, sp.S.Zero)
    power = 3 + m
    within = inside**power * sp.horner(sp.expand(polynomials[m] / s**power)).subs(s, inside)
    beyond = (behind**i / factorial(i) * polynomials[m - i].subs(s, 1) for i in range(1, m + 1))
    return width**m * (within + sp.Add(*beyond))


# ---- smooth products ----


def _smooth(n: int, others: sp.Expr) -> Callable[[sp.Expr], sp.Expr] | None:
    """The integral of t^n times factors without switches, as a function of its lower end; None without a rule."""
    waves: list[tuple[sp.Expr, bool, sp.Expr]] = [(sp.S.One, False, sp.S.Zero)]
    growth = sp.S.Zero
    single: tuple[sp.Expr, sp.Expr] | None = None
    for factor, exponent in others.as_powers_dict().items():
        if factor == 1:
            continue
        argument = factor.args[0] if isinstance(factor, (sp.sin, sp.cos, Exp, Log, Tanh)) else factor
        if _linear(argument) is None:
            return None
        match factor:
            case sp.sin() | sp.cos() if exponent.is_Integer and exponent > 0:
                for _ in range(int(exponent)):
                    waves = [*_times(waves, isinstance(factor, sp.sin), argument)]
            case Exp() if exponent.is_Integer:
                growth += exponent * argument
            case _ if single is None and exponent.is_Rational and not isinstance(factor, (sp.sin, sp.cos, Exp)):
                single = factor, exponent
            case _:
                return None
    if single is None:
        return lambda base: sp.Add(*(c * _wave(n, growth, sine, phase, base) for c, sine, phase in waves))
    if growth != 0 or len(waves) > 1 or waves[0][2] != 0:
        return None
    return _of_linear(n, *single)


def _times(
    waves: list[tuple[sp.Expr, bool, sp.Expr]], sine: bool, b: sp.Expr
) -> Iterator[tuple[sp.Expr, bool, sp.Expr]]:
    """The product of a sum of sines (True) and cosines (False) with one more, as a sum."""
    for weight, first, a in waves:
        half = weight / 2
        product = first != sine  # a sine times a cosine is a sum of sines
        yield (-half if first and sine else half), product, sp.expand(a + b)
        yield (-half if sine and not first else half), product, sp.expand(a - b)


def _wave(n: int, growth: sp.Expr, sine: bool, phase: sp.Expr, base: sp.Expr) -> sp.Expr:
    """The integral of t^n exp(growth) times the sine or the cosine of `phase`, both linear in t, from `base` to t."""
    since = t - base
    k, w = (sp.expand(x).coeff(t, 1) for x in (growth, phase))
    shift, angle = sp.expand(at(growth, base)), sp.expand(at(phase, base))
    scale = Exp(shift) if shift != 0 else sp.S.One
    of = sp.sin if sine else sp.cos
    powers = ((m, sp.binomial(n, m) * base ** (n - m)) for m in range(n + 1))
    return scale * sp.Add(*(c * _from_zero(m, k, w, of, angle).subs(t, since) for m, c in powers if c != 0))


def _from_zero(n: int, k: sp.Expr, w: sp.Expr, of: type[sp.Expr], angle: sp.Expr) -> sp.Expr:
    """The integral of t^n exp(k t) sin(w t + angle), or of the cosine, from 0 to t.

    Without a power of t the differences of both ends are written as products, which lose no digits for small k and w.
    """
    if w == 0 and k == 0:
        return of(angle) * t ** (n + 1) / (n + 1)
    if n == 0 and k == 0:
        return 2 * sp.sin(w * t / 2) / w * of(w * t / 2 + angle)
    if n == 0 and w == 0:
        return of(angle) * (Exp(k * t) + 1) * Tanh(k * t / 2) / k
    size = k**2 + w**2
    real, imaginary = k / size, -w / size  # 1/(k + i w), whose powers are the coefficients
    a, b = real, imaginary
    first, second = sp.S.Zero, sp.S.Zero
    for j in range(n + 1):
        weight = (-1) ** j * factorial(n) // factorial(n - j) * t ** (n - j)
        first, second = first + weight * a, second + weight * b
        a, b = a * real - b * imaginary, a * imaginary + b * real
    cosine, sine = sp.cos(w * t + angle), sp.sin(w * t + angle)
    whole = first * cosine - second * sine if of is sp.cos else first * sine + second * cosine
    whole = (Exp(k * t) if k != 0 else 1) * whole
    end = max(2, n // 2)
    return Select(size * t**2, sp.Integer(end**2), _series(n, k, w, of, angle, end), whole - at(whole, sp.S.Zero))


def _series(n: int, k: sp.Expr, w: sp.Expr, of: type[sp.Expr], angle: sp.Expr, end: int) -> sp.Expr:
    """The same where |k + i w| t is less than `end`, by the series of the exponential function, whose terms are small.

    The closed form is a difference of terms that are larger by n!/(|k + i w| t)^(n + 1).
    """
    real, imaginary = sp.S.One, sp.S.Zero  # the powers of k + i w
    coefficients = []
    bound, j = 1.0, 0
    while bound > SMALLEST:
        first, second = (sp.cos(angle), sp.sin(angle)) if of is sp.cos else (sp.sin(angle), -sp.cos(angle))
        coefficients.append((real * first - imaginary * second) / (factorial(j) * (n + j + 1)))
        real, imaginary = sp.expand(real * k - imaginary * w), sp.expand(real * w + imaginary * k)
        j += 1
        bound *= end / j
    result = sp.S.Zero
    for coefficient in reversed(coefficients):
        result = coefficient + t * result
    return t ** (n + 1) * result


def _of_linear(n: int, factor: sp.Expr, exponent: sp.Expr) -> Callable[[sp.Expr], sp.Expr] | None:
    """The integral of t^n times a power of a linear argument x, or times log x, or of tanh x; None of others."""
    linear = _linear(factor.args[0] if isinstance(factor, TimeOperation) else factor)
    assert linear is not None
    c, d = linear
    x = c * t + d
    match factor:
        case Log() if exponent == 1:
            part = _power(n + 1, sp.Integer(-1), linear)
            whole = (t ** (n + 1) * factor - c * part) / (n + 1)
        case Tanh() if exponent == 1 and n == 0:
            size = Absolute(x)
            whole = (size + Log(1 + Exp(-2 * size))) / c
        case TimeOperation():
            return None
        case _:
            whole = _power(n, exponent, linear)
    return lambda base: whole - at(whole, base)


def _power(n: int, exponent: sp.Expr, linear: Linear) -> sp.Expr:
    """An antiderivative of t^n x^exponent, with t = (x - d)/c and the expansion of its power."""
    c, d = linear
    x = c * t + d
    result = sp.S.Zero
    for j in range(n + 1):
        weight, r = sp.binomial(n, j) * (-d) ** (n - j) / c ** (n + 1), exponent + j + 1
        result += weight * (Log(Absolute(x)) if r == 0 else x**r / r)
    return result


# ---- switches ----


def _selection(others: sp.Expr) -> Select | None:
    """The same as a choice of two expressions, by the first switch of a linear argument; None if there is none."""
    for switch in sp.preorder_traversal(others):
        if isinstance(switch, SWITCHES) and switch.has(t) and (choice := _choice(switch)) is not None:
            a, b, x, y = choice.args
            return Select(a, b, others.xreplace({switch: x}), others.xreplace({switch: y}))
    return None


def _choice(switch: sp.Expr) -> Select | None:
    """A switch as a choice by time, or by what does not depend on t; None where its argument is not linear."""
    match switch:
        case Select(args=(a, b, x, y)):
            return switch if not (a - b).has(t) else _sides(a - b, x, y)
        case Absolute(args=(a,)):
            return _sides(a, -a, a)
        case Minimum(args=(a, b)):
            return _sides(a - b, a, b)
        case Maximum(args=(a, b)):
            return _sides(a - b, b, a)
        case SmoothStep(args=(a, x0, x1, _)):
            s = (a - x0) / (x1 - x0)
            between = s**3 * (10 + s * (6 * s - 15))
            forward = _sides(a - x0, sp.S.Zero, Select(a, x1, between, sp.S.One))
            if forward is None or (x1 - x0).is_Rational:
                return forward
            backward = _sides(a - x1, sp.S.One, Select(a, x0, between, sp.S.Zero))  # where parameters exchange the ends
            return Select(x0, x1, forward, backward)
    return None


def _sides(difference: sp.Expr, below: sp.Expr, above: sp.Expr) -> Select | None:
    """A choice by the sign of a difference that is linear in t; where the sign of its slope is open, of two such."""
    linear = _linear(difference)
    if linear is None:
        return None
    c, d = linear
    rising, falling = Select(t, -d / c, below, above), Select(t, -d / c, above, below)
    if c.is_Rational:
        return rising if c > 0 else falling
    return Select(sp.S.Zero, c, rising, falling)
