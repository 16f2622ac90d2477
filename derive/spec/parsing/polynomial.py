"""Polynomials in xi, and exact numbers, read from text by a parser that accepts nothing else.

Coefficients are exact: 0.1 is 1/10, and pi is the double next to it. Only a number may stand after a /.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import lru_cache
from typing import ClassVar, NoReturn

from derive.errors import quoted
from derive.spec.model.beam_parts import Polynomial
from derive.spec.parsing.parser import MAX_DIGITS, MAX_LENGTH, MAX_POWER, ExpressionError, Parser, Token, fits

__all__ = ["MAX_DEGREE", "MAX_DIGITS", "MAX_LENGTH", "ExpressionError", "load_text", "parse_number", "polynomial"]

MAX_DEGREE = MAX_POWER
KEPT = 256
"""The number of polynomials that are kept, since many beams of a scene have the same ones."""

ZERO: Polynomial = ()
ONE: Polynomial = (Fraction(1),)
XI: Polynomial = (Fraction(0), Fraction(1))
PI = Fraction(math.pi)


@lru_cache(KEPT)
def polynomial(text: str) -> Polynomial:
    """The polynomial in xi that `text` denotes, such as "xi^2 - 1/3"."""
    return _Polynomials(text).parse()


def load_text(text: str) -> Polynomial:
    """The polynomial in xi of a distributed load, whose function of t is another key."""
    return _Loads(text).parse()


def parse_number(text: str) -> Fraction:
    """The exact constant that `text` denotes, such as "1/3" or "-0.5"."""
    constant = _Numbers(text).parse()
    return constant[0] if constant else Fraction(0)


class _Polynomials(Parser[Polynomial]):
    made_of = "a polynomial is made of numbers, xi, pi, + - * / ^ and parentheses"
    names: ClassVar[tuple[str, ...]] = ("xi",)

    def constant(self, value: Fraction, at: Token) -> Polynomial:
        return _trimmed([value])

    def named(self, name: str, at: Token) -> Polynomial:
        return XI

    def _name(self, token: Token) -> Polynomial:
        """A name; pi is none of `names`, which are examples of names that have powers."""
        return (PI,) if token.text == "pi" and self.names else super()._name(token)

    def added(self, a: Polynomial, b: Polynomial, at: Token) -> Polynomial:
        return self._limited(_add(a, b), at)

    def negative(self, a: Polynomial, at: Token) -> Polynomial:
        return _scale(a, Fraction(-1))

    def times(self, a: Polynomial, b: Polynomial, at: Token) -> Polynomial:
        if len(a) + len(b) - 2 > MAX_DEGREE:
            self.fail(at, f"the degree is too high; the highest is {MAX_DEGREE}")
        return self._limited(_multiply(a, b), at)

    def divided(self, a: Polynomial, b: Polynomial, at: Token, divisor_at: Token) -> Polynomial:
        if b == ZERO:
            self.fail(divisor_at, "division by zero")
        if len(b) > 1:
            self.fail(divisor_at, "division by xi makes no polynomial; only a number may stand after /")
        return self._limited(_scale(a, 1 / b[0]), at)

    def raised(self, a: Polynomial, power: int, at: Token) -> Polynomial:
        result = ONE
        for _ in range(power):
            result = self.times(result, a, at)
        return result

    def whole(self, value: Polynomial) -> int | None:
        constant = value[0] if value else Fraction(0)
        return int(constant) if len(value) < 2 and constant.denominator == 1 else None

    def inverse(self, a: Polynomial, at: Token) -> Polynomial:
        return super().inverse(a, at) if len(a) > 1 else self.divided(ONE, a, at, at)

    def _limited(self, value: Polynomial, at: Token) -> Polynomial:
        if not all(map(fits, value)):
            self.too_large(at)
        return value


class _Loads(_Polynomials):
    made_of = f"{_Polynomials.made_of}; a function of t, by which the load is multiplied, belongs in `time`"

    def unknown(self, token: Token, called: bool) -> NoReturn:
        if token.text == "t":
            self.fail(token, f'"t" is unknown here: {self.made_of}')
        super().unknown(token, called)


class _Numbers(_Polynomials):
    made_of = "a number is written like 2, 0.5 or 1/3"
    names = ()

    def unknown(self, token: Token, called: bool) -> NoReturn:
        if called:
            super().unknown(token, called)
        self.fail(token, f"{quoted(token.text)} is no number; {self.made_of}")


def _trimmed(coefficients: list[Fraction]) -> Polynomial:
    while coefficients and coefficients[-1] == 0:
        coefficients.pop()
    return tuple(coefficients)


def _scale(p: Polynomial, factor: Fraction) -> Polynomial:
    return _trimmed([c * factor for c in p])


def _add(a: Polynomial, b: Polynomial) -> Polynomial:
    size = max(len(a), len(b))
    padded = [p + (Fraction(0),) * (size - len(p)) for p in (a, b)]
    return _trimmed([x + y for x, y in zip(*padded, strict=True)])


def _multiply(a: Polynomial, b: Polynomial) -> Polynomial:
    result = [Fraction(0)] * max(len(a) + len(b) - 1, 0)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            result[i + j] += x * y
    return _trimmed(result)
