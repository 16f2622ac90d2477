"""Integrals of functions of time in closed form: the motion of a drive whose speed is a function of t.

An expression is expanded to a sum of products, and each product is integrated by a rule: powers of t times sines,
cosines and exponentials of linear arguments; powers, logarithms and tanh of a linear argument; smooth steps and tables,
whose antiderivatives are polynomials; and products with switches (piecewise functions, steps, abs, min, max), which are
integrated from switch to switch. Each integral is written in the time since its lower end, so that polynomials far from
t = 0 lose no digits.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from math import factorial

from sympy.core.symbol import Str

from derive.algebra import sp
from derive.mechanics.fixed_symbols import t
from derive.mechanics.quantity import function
from derive.mechanics.time_expressions import NoTimeFunction, time_function
from derive.mechanics.time_functions import Lookup, Maximum, Minimum, Select, SmoothStep
from derive.mechanics.time_integrals.linear_arguments import Linear, at, linear_in_t
from derive.mechanics.time_integrals.no_closed_form import NoClosedForm
from derive.mechanics.time_integrals.smooth_products import smooth_integral
from derive.mechanics.time_integrals.switches import selection
from derive.spec.model.time_function import TimeFunction, parts

MAX_CHOICES = 64
"""The largest number of choices of two expressions in an integral; products of many switches exceed it."""


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
        rules = [self._iterated(n, others, whole) or smooth_integral(n, others) for n in polynomial]
        if None not in rules:
            return sp.Add(*(c * rule(base) for c, rule in zip(polynomial.values(), rules, strict=True) if rule))
        choice = selection(others)
        self.choices += 1
        if choice is None or self.choices > MAX_CHOICES:
            raise NoClosedForm(None)
        return self._selected(choice, _sum(polynomial), base)

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
        """The integral by parts of t^n times a smooth step or a table of a linear argument, with known antiderivatives.

        Between other switches a step is a choice of polynomials, which are shorter when they are multiplied.
        """
        match others:
            case SmoothStep(args=(argument, x0, x1, _)) if whole and (linear := linear_in_t(argument)) is not None:
                return _by_parts(n, linear, lambda x, m: _step_antiderivative(x, x0, x1, m))
            case Lookup(args=(name, _, argument)) if (linear := linear_in_t(argument)) is not None:
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


def _expanded(expr: sp.Expr) -> sp.Expr:
    """An expression as a sum of products; denominators stay as they are."""
    below = {power: sp.Dummy() for power in expr.atoms(sp.Pow) if power.exp.is_negative and power.base.has(t)}
    return sp.expand(expr.xreplace(below)).xreplace({dummy: power for power, dummy in below.items()})


def _exact(value: float) -> sp.Rational:
    return sp.Rational(value)


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
