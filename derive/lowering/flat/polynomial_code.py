"""Straight-line code of polynomials in the state: linear forms are shared, and what they multiply is factored out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import casadi as ca

from derive.algebra import sp
from derive.lowering.flat.casadi_symbols import added, multiplied, subtracted
from derive.lowering.flat.polynomials import Coefficient, Polynomial, StatePolynomials, rational

SHARED = frozenset(Fraction(sign * n, d) for sign in (1, -1) for n, d in ((1, 1), (2, 1), (1, 2)))
"""The ratios of two linear forms of which one is computed from the other."""

Powers = tuple[int, ...]
Signed = tuple[int, ca.SX]
"""A sign and a value, so that a minus becomes a subtraction."""


@dataclass(frozen=True)
class Label:
    """The name and the description of a polynomial or, with a `monomial`, of the coefficient of these generators."""

    stem: str
    of: str
    monomial: tuple[str, ...] = ()

    def per(self, *generators: str) -> Label:
        """The label of the coefficient of a further product of generators."""
        return Label(self.stem, self.of, (*self.monomial, *generators))

    @property
    def name(self) -> str:
        """The name of the coefficient."""
        return "_".join([self.stem, *self.monomial])

    @property
    def doc(self) -> str:
        """The description of the coefficient."""
        return " per ".join([self.of, *([" ".join(self.monomial)] if self.monomial else [])])


Leaf = Callable[[Coefficient, Label], Signed]
"""The value of a coefficient, as a number or as a constant of setup, which gets the name of the label."""


class PolynomialCode:
    """CasADi values of polynomials of degree 2 or less in the amplitudes; all polynomials share their linear forms.

    leaf: the value of a coefficient. running: the partial totals of each sum of products with linear forms; a compiler
    keeps the forms in registers if the sums that share them advance together.
    """

    def __init__(self, polynomials: StatePolynomials, values: Mapping[sp.Symbol, ca.SX], leaf: Leaf) -> None:
        self.ring, self.leaf = polynomials.ring, leaf
        self.names = [symbol.name for symbol in self.ring.symbols]
        self.amplitudes = frozenset(self.ring.symbols.index(s) for s in polynomials.amplitudes)
        self.values = [values[symbol] for symbol in self.ring.symbols]
        self.running: list[list[ca.SX]] = []
        self._forms: dict[tuple[tuple[Powers, Any], ...], tuple[Coefficient, ca.SX]] = {}

    def __call__(self, polynomial: Polynomial, label: Label) -> ca.SX:
        """The value of a polynomial."""
        return _value(self._signed(polynomial, label))

    def _signed(self, polynomial: Polynomial, label: Label) -> list[Signed]:
        parts = self._split(polynomial)
        shared: dict[Fraction, dict[Powers, Signed]] = {}
        constant: dict[Powers, Coefficient] = {}
        of_amplitudes: dict[int, dict[Powers, Coefficient]] = {}
        result: list[Signed] = []
        linear = [form for (_, degree), form in parts.items() if degree == 1]
        for (velocities, degree), form in parts.items():
            inner = label.per(*self._named(velocities))
            if degree == 0:
                constant |= {} if (velocities, 2) in parts else {velocities: form.LC}
            elif degree == 2:
                first = [self.leaf(parts[velocities, 0].LC, inner)] if (velocities, 0) in parts else []
                result.append((1, self._times(velocities, self._quadratic(form, inner, first))))
            elif len(linear) == 1 or self._is_known(form):
                ratio, value = self._linear(form, inner)
                shared.setdefault(abs(ratio), {})[velocities] = (1 if ratio > 0 else -1, value)
            else:
                for powers, coefficient in form.terms():
                    of_amplitudes.setdefault(powers.index(1), {})[velocities] = coefficient
        for ratio, forms in shared.items():
            result += self._with_common_factor(forms, ratio)
        for amplitude, coefficients in sorted(of_amplitudes.items()):
            sign, factor = _sum(self._of_velocities(coefficients, label.per(self.names[amplitude])))
            result.append((sign, _times(factor, self.values[amplitude])))
        return [*result, *self._of_velocities(constant, label)]

    def _split(self, polynomial: Polynomial) -> dict[tuple[Powers, int], Polynomial]:
        """The polynomials in the amplitudes that the products of the other generators multiply, by degree."""
        result: dict[tuple[Powers, int], Polynomial] = {}
        for powers, coefficient in polynomial.terms():
            outer = tuple(0 if k in self.amplitudes else p for k, p in enumerate(powers))
            inner = tuple(p if k in self.amplitudes else 0 for k, p in enumerate(powers))
            key = outer, sum(inner)
            result[key] = result.get(key, self.ring.zero) + self.ring({inner: coefficient})
        return result

    def _quadratic(self, form: Polynomial, label: Label, first: list[Signed]) -> ca.SX:
        """A quadratic form as the sum of each amplitude times half of the derivative with respect to it.

        `first` are values that are added to it: the sum begins with them, so that its products can be fused with it.
        """
        terms = [*first]
        for k in sorted(self.amplitudes):
            half = form.diff(self.ring.gens[k]) / 2
            if half:
                ratio, value = self._linear(half, label.per(self.names[k]))
                terms.append((1 if ratio > 0 else -1, self._scaled(abs(ratio), self.values[k]) * value))
        sign, total = self._running(terms, len(first))
        return total if sign > 0 else -total

    def _is_known(self, form: Polynomial) -> bool:
        return self._known(form) is not None

    def _known(self, form: Polynomial) -> tuple[Fraction, ca.SX] | None:
        """An earlier linear form, and the ratio of the form to it."""
        earlier = self._forms.get(_normalised(form))
        if earlier is None:
            return None
        lead, value = earlier
        ratio = rational(self.ring.domain, form.LC / lead)
        return None if ratio is None or ratio not in SHARED else (ratio, value)

    def _linear(self, form: Polynomial, label: Label) -> tuple[Fraction, ca.SX]:
        """A linear form in the amplitudes as a ratio times a value, that of an earlier form if there is one."""
        if known := self._known(form):
            return known
        terms = []
        for powers, coefficient in form.terms():
            k = powers.index(1)
            sign, value = self.leaf(coefficient, label.per(self.names[k]))
            terms.append((sign, _times(value, self.values[k])))
        first = terms[0][0]
        value = _value([(sign * first, term) for sign, term in terms])
        self._forms[_normalised(form)] = (form.LC * first, value)
        return Fraction(first), value

    def _of_velocities(self, coefficients: Mapping[Powers, Coefficient], label: Label) -> list[Signed]:
        """A polynomial in the velocities, by Horner's rule for the velocity that occurs in most of its terms."""
        if len(coefficients) == 1:
            ((powers, coefficient),) = coefficients.items()
            sign, value = self.leaf(coefficient, label.per(*self._named(powers)))
            return [(sign, self._times(powers, value))]
        counts = {k: sum(powers[k] > 0 for powers in coefficients) for k in range(len(self.names))}
        common = max(counts, key=counts.__getitem__)
        if counts[common] < 2:
            return [term for p, c in coefficients.items() for term in self._of_velocities({p: c}, label)]
        inside = {_lowered(p, common): c for p, c in coefficients.items() if p[common]}
        outside = {p: c for p, c in coefficients.items() if not p[common]}
        sign, factor = _sum(self._of_velocities(inside, label.per(self.names[common])))
        product = _times(self.values[common], factor)
        return [(sign, product), *(self._of_velocities(outside, label) if outside else [])]

    def _with_common_factor(self, forms: Mapping[Powers, Signed], ratio: Fraction) -> list[Signed]:
        """The sum of products of velocities and forms, from which the factors that all of them have are taken out."""
        common = tuple(map(min, zip(*forms, strict=True)))
        terms = []
        for powers, (sign, value) in forms.items():
            rest = tuple(p - c for p, c in zip(powers, common, strict=True))
            terms.append((sign, self._times(rest, value)))
        if not any(common) and ratio == 1:
            return terms
        sign, total = self._running(terms)
        factor = self._times(common, ca.SX(1))
        if ratio == 2 and sign < 0:
            return [(1, _times(-2 * factor, total))]  # no operation for the sign
        return [(sign, _times(self._scaled(ratio, factor), total))]

    def _running(self, terms: list[Signed], before: int = 0) -> Signed:
        """A sum whose partial totals are kept: those with at least two terms besides the first `before` ones."""
        sign, totals = _totals(terms)
        self.running.append(totals[before + 1 :])
        return sign, totals[-1]

    def _scaled(self, ratio: Fraction, value: ca.SX) -> ca.SX:
        return value if ratio == 1 else 2 * value if ratio == 2 else value / 2

    def _times(self, powers: Powers, value: ca.SX) -> ca.SX:
        """A product of generators times a value."""
        product = ca.SX(1)
        for generator, power in zip(self.values, powers, strict=True):
            for _ in range(power):
                product = _times(product, generator)
        return _times(product, value)

    def _named(self, powers: Powers) -> Iterable[str]:
        """The generators of a monomial by name."""
        return (name if p == 1 else f"{name}{p}" for name, p in zip(self.names, powers, strict=True) if p)


def _normalised(form: Polynomial) -> tuple[tuple[Powers, Any], ...]:
    """The terms of a form divided by its leading coefficient."""
    return tuple((powers, coefficient / form.LC) for powers, coefficient in form.terms())


def _lowered(powers: Powers, k: int) -> Powers:
    return tuple(p - (n == k) for n, p in enumerate(powers))


def _times(a: ca.SX, b: ca.SX) -> ca.SX:
    """A product, without factors of one."""
    return b if a.is_one() else a if b.is_one() else multiplied(a, b)


def _totals(terms: list[Signed]) -> tuple[int, list[ca.SX]]:
    """The sign and the partial totals of a sum whose first term is positive; without one, those of the negated sum."""
    flipped = 1 if any(sign > 0 for sign, _ in terms) else -1
    (_, first), *others = sorted(terms, key=lambda term: -flipped * term[0])
    totals = [first]
    for sign, term in others:
        totals.append((added if flipped * sign > 0 else subtracted)(totals[-1], term))
    return flipped, totals


def _sum(terms: list[Signed]) -> Signed:
    """The sign and the value of a sum."""
    sign, totals = _totals(terms)
    return sign, totals[-1]


def _value(terms: list[Signed]) -> ca.SX:
    """A sum as a value; 0 if there are no terms."""
    if not terms:
        return ca.SX(0)
    sign, total = _sum(terms)
    return total if sign > 0 else -total
