"""Integrals in closed form of powers of t times factors without switches: waves, exponentials, powers, logarithms."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import factorial

from derive.algebra import sp
from derive.mechanics.fixed_symbols import t
from derive.mechanics.time_functions import Absolute, Exp, Log, Select, Tanh, TimeOperation
from derive.mechanics.time_integrals.linear_arguments import Linear, at, linear_in_t

SMALLEST = 1e-18
"""The bound below which terms of a series are left out."""


def smooth_integral(n: int, others: sp.Expr) -> Callable[[sp.Expr], sp.Expr] | None:
    """The integral of t^n times factors without switches, as a function of its lower end; None without a rule."""
    waves: list[tuple[sp.Expr, bool, sp.Expr]] = [(sp.S.One, False, sp.S.Zero)]
    growth = sp.S.Zero
    single: tuple[sp.Expr, sp.Expr] | None = None
    for factor, exponent in others.as_powers_dict().items():
        if factor == 1:
            continue
        argument = factor.args[0] if isinstance(factor, (sp.sin, sp.cos, Exp, Log, Tanh)) else factor
        if linear_in_t(argument) is None:
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
    """The integral of `_from_zero` where |k + i w| t is less than `end`, by the series of the exponential function.

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
    """The integral of t^n times a power of a linear argument x, log x or tanh x; None for other factors."""
    linear = linear_in_t(factor.args[0] if isinstance(factor, TimeOperation) else factor)
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
