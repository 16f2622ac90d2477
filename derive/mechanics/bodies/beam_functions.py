"""Functions of xi along a beam whose products, derivatives and integrals have closed forms.

A function is a sum of terms coefficient xi^n exp(rate xi). Polynomials have the rate zero and rational coefficients, so
that all that is computed with them is exact. Sines and hyperbolic functions are pairs of exponentials, whose rates are
whole multiples of wave numbers, real and imaginary ones: which exponentials cancel in a product, and leave a power of
xi, is known exactly. Coefficients and wave numbers are computed with WORKING_DIGITS digits; what vanishes to
NEGLIGIBLE_DIGITS of them is zero, and the integrals that a model uses are rounded to doubles, see `rational`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache, cached_property, lru_cache
from typing import Any

import mpmath

from derive.algebra import sp
from derive.spec.model.beam_parts import Polynomial

WORKING_DIGITS = 200
"""The precision: antiderivatives divide by small differences of wave numbers, which leaves 60 digits and more."""
NEGLIGIBLE_DIGITS = 40

ARITHMETIC = mpmath.MPContext()
"""The mpmath context of irrational coefficients; its precision is independent of the global one."""
ARITHMETIC.dps = WORKING_DIGITS

NEGLIGIBLE = ARITHMETIC.mpf(10) ** -NEGLIGIBLE_DIGITS

LEFT, RIGHT = Fraction(-1), Fraction(1)
"""The ends of the beam."""

KEPT = 4096
"""The number of products, values and integrals that are kept: most bodies of a scene have the same shapes."""

Real = Any
"""A coefficient: a Fraction, or a number of ARITHMETIC."""


@dataclass(frozen=True, order=True)
class WaveNumber:
    """A positive number, known by its name, of which rates are multiples."""

    name: str
    value: Real = field(compare=False)


Rate = tuple[tuple[WaveNumber, int, int], ...]
"""A rate: the sum of (a + i b) w over its entries w, a, b, with at most one entry for each wave number."""
Term = tuple[Rate, int]
"""The identity of a function exp(rate xi) xi^n: its rate and its power."""


@dataclass(frozen=True)
class RealTerm:
    """The term xi^power exp(growth xi) (cosine cos(frequency xi) + sine sin(frequency xi)), in doubles."""

    power: int
    growth: float
    frequency: float
    cosine: float
    sine: float

    def texts(self) -> Iterator[str]:
        """The summands as text, in decimals."""
        power = f" xi^{self.power}" if self.power > 1 else " xi" * self.power
        growth = f" exp({self.growth!r} xi)" if self.growth else ""
        for factor, wave in ((self.cosine, "cos"), (self.sine, "sin")):
            if factor:
                yield f"{factor!r}{power}{growth}" + (f" {wave}({self.frequency!r} xi)" if self.frequency else "")


@dataclass(frozen=True)
class BeamFunction:
    """A real function of xi; the coefficients of its terms do not vanish."""

    terms: Mapping[Term, Real]

    @cached_property
    def _hash(self) -> int:
        return hash(frozenset(self.terms.items()))

    def __hash__(self) -> int:
        return self._hash

    @property
    def is_exact(self) -> bool:
        """Whether the function is a polynomial with rational coefficients."""
        return all(isinstance(c, Fraction) for c in self.terms.values())

    @property
    def is_zero(self) -> bool:
        """Whether the function vanishes everywhere."""
        return not self.terms

    @property
    def is_odd(self) -> bool:
        """Whether the function is odd, f(-xi) = -f(xi)."""
        mirrored = {(_negative(rate), n): -c if n % 2 else c for (rate, n), c in self.terms.items()}
        return not _sum((self.terms, mirrored))

    @property
    def coefficients(self) -> Polynomial:
        """The coefficients of 1, xi, xi^2, ... of an exact polynomial."""
        assert self.is_exact, "of polynomials alone"
        powers = {n: c for (_, n), c in self.terms.items()}
        return tuple(powers.get(n, Fraction(0)) for n in range(max(powers, default=-1) + 1))

    @property
    def real_terms(self) -> tuple[RealTerm, ...]:
        """The terms of the function in doubles, for texts and drawings; conjugate exponentials are merged."""
        return tuple(self._real_terms())

    def _real_terms(self) -> Iterator[RealTerm]:
        for (rate, n), c in self.terms.items():
            growth, frequency = float(_value(rate).real), float(_value(rate).imag)
            if frequency >= 0:
                twice = 2.0 if frequency > 0 else 1.0
                re, im = (float(c), 0.0) if isinstance(c, Fraction) else (float(c.real), float(c.imag))
                yield RealTerm(n, growth, frequency, twice * re, -twice * im)

    @property
    def text(self) -> str:
        """The function as a specification writes it, or in decimals."""
        if self.is_exact:
            return _polynomial_text(self.coefficients)
        summands = (summand for term in self.real_terms for summand in term.texts())
        return " + ".join(summands).replace("+ -", "- ")

    def __add__(self, other: BeamFunction) -> BeamFunction:
        return BeamFunction(_sum((self.terms, other.terms)))

    def __sub__(self, other: BeamFunction) -> BeamFunction:
        return self + -other

    def __neg__(self) -> BeamFunction:
        return self.scaled(Fraction(-1))

    @lru_cache(KEPT)  # noqa: B019  functions are few, and kept on purpose
    def __mul__(self, other: BeamFunction) -> BeamFunction:
        pairs = ((left, right) for left in self.terms.items() for right in other.terms.items())
        return BeamFunction(_sum({(_added(r, s), n + k): a * b} for ((r, n), a), ((s, k), b) in pairs))

    def scaled(self, factor: Real) -> BeamFunction:
        """The product of the function and a number."""
        return BeamFunction({term: c * factor for term, c in self.terms.items()} if factor else {})

    @lru_cache(KEPT)  # noqa: B019  functions are few, and kept on purpose
    def derivative(self, order: int = 1) -> BeamFunction:
        """The derivative of some order by xi."""
        if order == 0:
            return self
        parts: list[dict[Term, Real]] = []
        for (rate, n), c in self.terms.items():
            if n:
                parts.append({(rate, n - 1): c * n})
            if rate:
                parts.append({(rate, n): c * _value(rate)})
        return BeamFunction(_sum(parts)).derivative(order - 1)

    def antiderivative(self) -> BeamFunction:
        """An antiderivative: of xi^n exp(r xi) the sum over k of (-1)^(n-k) n!/k! xi^k exp(r xi)/r^(n-k+1)."""
        parts: list[dict[Term, Real]] = []
        for (rate, n), c in self.terms.items():
            if not rate:
                parts.append({(rate, n + 1): c / (n + 1)})
                continue
            factor, r = c / _value(rate), _value(rate)
            for k in range(n, -1, -1):
                parts.append({(rate, k): factor})
                factor *= -k / r
        return BeamFunction(_sum(parts))

    @lru_cache(KEPT)  # noqa: B019  functions are few, and kept on purpose
    def at(self, xi: Fraction) -> Real:
        """The value of the function at a position."""
        if self.is_exact:
            return sum((c * xi**n for (_, n), c in self.terms.items()), Fraction(0))
        parts = list(self._parts_at(xi))
        return _real(parts, sum(map(_size, parts)))

    @lru_cache(KEPT)  # noqa: B019  functions are few, and kept on purpose
    def integral(self, start: Fraction = LEFT) -> Real:
        """The integral from a position to the right end; zero where it is negligible against that of the terms."""
        if self.is_exact:
            primitive = self.antiderivative()
            return primitive.at(RIGHT) - primitive.at(start)
        parts = (c * _integral(rate, n, start) for (rate, n), c in self.terms.items())
        size = sum(_size(c) * _growth(rate) for (rate, _), c in self.terms.items())
        return _real(parts, size)

    def _parts_at(self, xi: Fraction) -> Iterator[Real]:
        """The values of the terms at a position, complex numbers."""
        return (c * xi**n * _exponential(rate, xi) for (rate, n), c in self.terms.items())


def polynomial(coefficients: Iterable[Fraction | int]) -> BeamFunction:
    """The polynomial with these coefficients of 1, xi, xi^2, ...; none give zero."""
    return BeamFunction({((), n): Fraction(c) for n, c in enumerate(coefficients) if c})


NOTHING, ONE, XI = polynomial([]), polynomial([1]), polynomial([0, 1])


def exponential(wave: WaveNumber, real: int, imaginary: int, coefficient: Real) -> BeamFunction:
    """The complex function coefficient exp((real + i imaginary) wave xi), a part of a real function."""
    return BeamFunction({(((wave, real, imaginary),), 0): ARITHMETIC.mpc(coefficient)})


def rational(number: Real) -> sp.Rational:
    """A number in the derivation, see `fraction`."""
    exact = fraction(number)
    return sp.Rational(exact.numerator, exact.denominator)


def fraction(number: Real) -> Fraction:
    """An exact number: a fraction as it is, any other as the double next to it, the same on any machine."""
    return number if isinstance(number, Fraction) else Fraction(float(number))


def _polynomial_text(coefficients: Polynomial) -> str:
    """The text of a polynomial, highest power first: 3*xi^2/2 - 1/2; a positive constant before -xi^2."""
    powers = [(n, c) for n, c in enumerate(coefficients) if c]
    if not (len(powers) == 2 and powers[0][0] == 0 and powers[0][1] > 0 > powers[1][1]):
        powers.reverse()
    text = "".join(f" {'-' if c < 0 else '+'} {_monomial_text(n, abs(c))}" for n, c in powers)
    return ("-" if text.startswith(" - ") else "") + text[3:] if text else "0"


def _monomial_text(power: int, coefficient: Fraction) -> str:
    """A positive number times a power of xi."""
    if not power:
        return str(coefficient)
    number = f"{coefficient.numerator}*" if coefficient.numerator > 1 else ""
    divisor = f"/{coefficient.denominator}" if coefficient.denominator > 1 else ""
    return f"{number}xi{f'^{power}' if power > 1 else ''}{divisor}"


def _sum(parts: Iterable[Mapping[Term, Real]]) -> dict[Term, Real]:
    """The sum of sums of terms, without terms that cancel."""
    totals: dict[Term, Real] = {}
    sizes: dict[Term, Real] = {}
    for part in parts:
        for term, c in part.items():
            totals[term] = totals[term] + c if term in totals else c
            sizes[term] = sizes.get(term, 0) + _size(c)
    return {term: c for term, c in totals.items() if not _negligible(c, sizes[term])}


def _negligible(number: Real, size: Real) -> bool:
    """Whether a number is negligible compared with numbers of some size."""
    return not number if isinstance(number, Fraction) else bool(_size(number) <= NEGLIGIBLE * size)


def _size(number: Real) -> Real:
    """The size of a real or complex number, up to a factor of sqrt(2)."""
    return abs(number) if isinstance(number, Fraction) else abs(number.real) + abs(number.imag)


def _real(parts: Iterable[Real], size: Real) -> Real:
    """The real part of a sum, or the exact zero."""
    total = sum(parts, ARITHMETIC.mpc(0)).real
    return Fraction(0) if _negligible(total, size) else total


def _added(a: Rate, b: Rate) -> Rate:
    """The sum of two rates."""
    if not (a and b):
        return a or b
    total = {wave: (x, y) for wave, x, y in a}
    for wave, x, y in b:
        known = total.get(wave, (0, 0))
        total[wave] = known[0] + x, known[1] + y
    return tuple((wave, x, y) for wave, (x, y) in sorted(total.items()) if x or y)


def _negative(rate: Rate) -> Rate:
    return tuple((wave, -x, -y) for wave, x, y in rate)


@cache
def _value(rate: Rate) -> Real:
    """A rate as a complex number."""
    parts = (ARITHMETIC.mpc(x, y) * wave.value for wave, x, y in rate)
    return sum(parts, ARITHMETIC.mpc(0))


@cache
def _exponential(rate: Rate, xi: Fraction) -> Real:
    """The value of exp(rate xi), a product of powers of few exponentials."""
    result = ARITHMETIC.mpc(1)
    for wave, real, imaginary in rate:
        if real:
            result *= _unit_exponential(wave, False, xi) ** real
        if imaginary:
            result *= _unit_exponential(wave, True, xi) ** imaginary
    return result


@cache
def _unit_exponential(wave: WaveNumber, imaginary: bool, xi: Fraction) -> Real:
    return ARITHMETIC.exp(ARITHMETIC.mpc(0, wave.value * xi) if imaginary else wave.value * xi)


@cache
def _growth(rate: Rate) -> Real:
    """The size of exp(rate xi) at the end where it is larger."""
    return max(_size(_exponential(rate, end)) for end in (LEFT, RIGHT))


@cache
def _integral(rate: Rate, power: int, start: Fraction) -> Real:
    """The integral of xi^power exp(rate xi) from a position to the right end."""
    primitive = BeamFunction({(rate, power): ARITHMETIC.mpc(1)}).antiderivative()
    return sum(primitive._parts_at(RIGHT)) - sum(primitive._parts_at(start))
