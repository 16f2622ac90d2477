"""Polynomials in xi, read from text by a parser that knows nothing else.

    sum     = [sign] product { ("+" | "-") product }
    product = power { "*" factor | "/" factor }
    factor  = [sign] power
    power   = atom [ ("^" | "**") whole number ]
    atom    = number | "xi" | "(" sum ")"

Coefficients are exact: 0.1 is 1/10. The text may come from anywhere, so sizes are limited while they
are small.
"""

from __future__ import annotations

import difflib
import re
from fractions import Fraction
from typing import NamedTuple, NoReturn

from derive.spec.body import Polynomial
from derive.spec.errors import quoted

MAX_LENGTH = 200
MAX_DEGREE = 40
MAX_DIGITS = 60
MAX_DEPTH = 20

ZERO: Polynomial = ()
ONE: Polynomial = (Fraction(1),)
XI: Polynomial = (Fraction(0), Fraction(1))


class ExpressionError(ValueError):
    """Text that is no polynomial, or no number; the message says where and what to write instead."""


def polynomial(text: str) -> Polynomial:
    """The polynomial in xi that `text` says, such as "xi^2 - 1/3"."""
    return _Parser(text, "polynomial").parse()


def parse_number(text: str) -> Fraction:
    """The exact constant that `text` says, such as "1/3" or "-0.5"."""
    constant = _Parser(text, "number").parse()
    return constant[0] if constant else Fraction(0)


class _Token(NamedTuple):
    kind: str
    text: str
    column: int


_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)"
    r"|(?P<name>[^\W\d]\w*)|(?P<operator>\*\*|[-+*/^()])|(?P<end>$)|(?P<other>.))",
    re.DOTALL,
)

_MADE_OF = {
    "polynomial": "a polynomial is made of numbers, xi, + - * / ^ and parentheses",
    "number": "a number is written like 2, 0.5 or 1/3",
}


class _Parser:
    """Recursive descent over the tokens of a text; `wanted` is "polynomial", or "number" without xi."""

    def __init__(self, text: str, wanted: str) -> None:
        self.text = text
        self.wanted = wanted
        if not text.strip():
            raise ExpressionError(f"the text is empty: {_MADE_OF[wanted]}")
        if len(text) > MAX_LENGTH:
            raise ExpressionError(f"the text has {len(text)} characters; at most {MAX_LENGTH} are read")
        self.tokens = self._tokens()
        self.place = 0
        self.depth = 0

    def parse(self) -> Polynomial:
        result = self.sum()
        if self.next.kind != "end":
            self.unexpected()
        return result

    def sum(self) -> Polynomial:
        result = self.product()
        while self.next.text in ("+", "-"):
            sign = self.take()
            term = self.product()
            result = self.limited(_add(result, term if sign.text == "+" else _scale(term, Fraction(-1))), sign)
        return result

    def product(self) -> Polynomial:
        result = self.factor()
        while self.next.text in ("*", "/"):
            operator = self.take()
            divisor_at = self.next
            factor = self.factor()
            if operator.text == "*":
                result = self.times(result, factor, operator)
            else:
                result = self.limited(_scale(result, 1 / self.divisor(factor, divisor_at)), operator)
        return result

    def divisor(self, factor: Polynomial, at: _Token) -> Fraction:
        if factor == ZERO:
            self.fail(at, "division by zero")
        if len(factor) > 1:
            self.fail(at, "division by xi makes no polynomial; only a number may stand after /")
        return factor[0]

    def factor(self) -> Polynomial:
        sign = Fraction(1)
        while self.next.text in ("+", "-"):
            if self.take().text == "-":
                sign = -sign
        return _scale(self.power(), sign)

    def power(self) -> Polynomial:
        base = self.atom()
        if self.next.text not in ("^", "**"):
            return base
        operator = self.take()
        exponent = self.take()
        if exponent.kind != "number" or not exponent.text.isdigit():
            self.fail(exponent, "a power is a whole number, zero or more, such as xi^2")
        if self.next.text in ("^", "**"):
            self.fail(self.next, "a power of a power needs parentheses, such as (xi^2)^3")
        if int(exponent.text) > MAX_DEGREE:
            self.fail(exponent, f"the power is too high; the highest is {MAX_DEGREE}")
        result = ONE
        for _ in range(int(exponent.text)):
            result = self.times(result, base, operator)
        return result

    def atom(self) -> Polynomial:
        token = self.take()
        if token.kind == "number":
            return _constant(self.number(token))
        if token.kind == "name":
            self.name(token)
            return XI
        if token.text == "(":
            self.depth += 1
            if self.depth > MAX_DEPTH:
                self.fail(token, f"more than {MAX_DEPTH} parentheses are open")
            result = self.sum()
            if self.next.text != ")":
                if self.next.kind == "end":
                    self.fail(token, "this parenthesis is never closed")
                self.unexpected()
            self.take()
            self.depth -= 1
            return result
        if token.kind == "end":
            self.fail(token, "something is missing at the end")
        self.fail(
            token,
            f"a number{', xi' if self.wanted == 'polynomial' else ''} or ( is expected before {token.text}",
        )

    def number(self, token: _Token) -> Fraction:
        _, _, exponent = token.text.lower().partition("e")
        # The exponent is looked at before 10 is raised to it.
        if exponent and abs(int(exponent)) >= MAX_DIGITS:
            self.too_large(token)
        value = Fraction(token.text)
        self.limited(_constant(value), token)
        return value

    def name(self, token: _Token) -> None:
        if self.tokens[self.place].text == "(":
            if token.text == "xi":
                self.fail(self.next, "an operator is missing: for a product write xi*(")
            self.fail(
                token,
                f"{quoted(token.text)} is called here, and there are no functions: {_MADE_OF[self.wanted]}",
            )
        if self.wanted == "number":
            self.fail(token, f"{quoted(token.text)} is no number; {_MADE_OF['number']}")
        if token.text != "xi":
            near = len(token.text) == 1 or difflib.get_close_matches(token.text.lower(), ["xi"], cutoff=0.5)
            hint = '; did you mean "xi"?' if near else f": {_MADE_OF['polynomial']}"
            self.fail(token, f"the name {quoted(token.text)} is unknown{hint}")

    def times(self, a: Polynomial, b: Polynomial, at: _Token) -> Polynomial:
        if len(a) + len(b) - 2 > MAX_DEGREE:
            self.fail(at, f"the degree is too high; the highest is {MAX_DEGREE}")
        return self.limited(_multiply(a, b), at)

    def limited(self, value: Polynomial, at: _Token) -> Polynomial:
        if any(max(abs(c.numerator), c.denominator) >= 10**MAX_DIGITS for c in value):
            self.too_large(at)
        return value

    def too_large(self, at: _Token) -> NoReturn:
        self.fail(
            at,
            f"a number is too large, too small or too long: exact numbers have at most {MAX_DIGITS} digits above "
            "and below the fraction bar",
        )

    @property
    def next(self) -> _Token:
        return self.tokens[self.place]

    def take(self) -> _Token:
        token = self.next
        # The last token is the end, which is never passed.
        self.place = min(self.place + 1, len(self.tokens) - 1)
        return token

    def unexpected(self) -> NoReturn:
        token = self.next
        if token.text == ")":
            self.fail(token, "this parenthesis was never opened")
        self.fail(token, f"an operator is missing before {quoted(token.text)}; for a product write *")

    def fail(self, at: _Token, why: str) -> NoReturn:
        raise ExpressionError(f"column {at.column} of {quoted(self.text, MAX_LENGTH)}: {why}")

    def _tokens(self) -> list[_Token]:
        tokens = []
        for match in _TOKEN.finditer(self.text):
            kind = str(match.lastgroup)
            token = _Token(kind, match[kind], match.start(kind) + 1)
            if kind == "other":
                self.fail(token, f"{quoted(token.text)} has no meaning here: {_MADE_OF[self.wanted]}")
            tokens.append(token)
            if kind == "end":
                break
        return tokens


def _trimmed(coefficients: list[Fraction]) -> Polynomial:
    while coefficients and coefficients[-1] == 0:
        coefficients.pop()
    return tuple(coefficients)


def _constant(value: Fraction) -> Polynomial:
    return _trimmed([value])


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
