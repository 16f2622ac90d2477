"""Moments of inertia as quadratic forms of the amplitudes, for functions that need nothing else of the sums S.

J = C3 + sum_i (C4_i + S_i) alpha_i with S_i = C4_i + sum_j C5_ij alpha_j. A function that needs the S anyway, as h
does, computes J from them. M does not: where the C5 are sparse, the products alpha_i alpha_j, which all components of J
share, take fewer operations. Dense S are sums of a table instead, see `derive.ir.linear_forms`.
"""

from __future__ import annotations

from collections import Counter
from functools import reduce

import casadi as ca

from derive.algebra import fraction, sp
from derive.ir.linear_forms import FEWEST_FACTORS
from derive.lowering.flat.casadi_symbols import Symbols, added, multiplied
from derive.lowering.flat.context import Context
from derive.mechanics.symbols import Family, identity


def quadratic_inertias(context: Context, symbols: Symbols) -> dict[sp.Symbol, ca.SX]:
    """The values of the moments of inertia of bodies given by numbers, as far as the sums S have more terms."""
    numbers = {c.symbol: c.value for c in context.coefficients if c.value.is_Rational}
    every = [d for d in context.equations.definitions if not d.zero and d.symbol in symbols.values]
    sums = {d.symbol: d.expr for d in every if identity(d.symbol).family is Family.S}
    forms: dict[sp.Symbol, sp.Expr] = {}
    for d in every:
        own = {s: sums[s] for s in d.needs & sums.keys()}
        if identity(d.symbol).family is not Family.INERTIA or not own:
            continue
        lengths = [len(sp.Add.make_args(expr)) for expr in own.values()]
        if max(lengths) >= FEWEST_FACTORS:
            continue
        form = sp.expand(d.expr.xreplace(own).xreplace(numbers))
        amplitudes = all(identity(s).family is Family.AMPLITUDE for s in form.free_symbols)
        if amplitudes and len(sp.Add.make_args(form)) < sum(lengths):
            forms[d.symbol] = form
    varying = Counter(form.as_coeff_Add()[1] for form in forms.values())
    return {symbol: _value(symbols, form, varying) for symbol, form in forms.items()}


def _value(symbols: Symbols, form: sp.Expr, varying: Counter[sp.Expr]) -> ca.SX:
    """A number and a quadratic form; the number comes last if another moment of inertia has the same form."""
    constant, rest = form.as_coeff_Add()
    terms = [_term(symbols, term) for term in sorted(sp.Add.make_args(rest), key=sp.default_sort_key)]
    last = varying[rest] > 1
    values = [*terms, _term(symbols, constant)] if last else [_term(symbols, constant), *terms]
    present = [value for value in values if not value.is_zero()]
    return reduce(added, present)


def _term(symbols: Symbols, term: sp.Expr) -> ca.SX:
    """A number times the product of amplitudes, which is computed once for all terms that have it."""
    number, product = term.as_coeff_Mul()
    value = symbols.number(fraction(number))
    return value if product == 1 else multiplied(value, symbols(product))
