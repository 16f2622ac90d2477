"""A recursive descent parser for the expressions of a specification; subclasses define their values.

    sum     = [sign] product { ("+" | "-") product }
    product = power { "*" factor | "/" factor }
    factor  = [sign] power
    power   = atom [ ("^" | "**") [sign] ( whole number | "(" sum ")" ) ]
    atom    = number | name | function "(" argument { "," argument } ")" | "(" sum ")"
    argument = sum [ "<" sum ]

Only expressions with functions have commas and comparisons.

The text may come from anywhere, so sizes are limited while they are small, and names are those of a list.
"""

from __future__ import annotations

import difflib
import re
from fractions import Fraction
from typing import ClassVar, Generic, NamedTuple, NoReturn, TypeVar

from derive.errors import TisserandError, quoted
from derive.spec.parsing.names import INDEX, NO_INDEX

MAX_LENGTH = 200
MAX_POWER = 40
MAX_DIGITS = 60
TOO_LARGE: int = 10**MAX_DIGITS
MAX_DEPTH = 20

Value = TypeVar("Value")


class ExpressionError(TisserandError, ValueError):
    """A text is not an expression of its kind; the message states where, and what to write instead."""


class Token(NamedTuple):
    """A number, name or operator; its column counts from 1."""

    kind: str
    text: str
    column: int


_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)"
    r"|(?P<name>[^\W\d]\w*(?:\[[0-9]+\]\w*)?)|(?P<operator>\*\*|[-+*/^(),<])|(?P<end>$)|(?P<other>.))",
    re.DOTALL,
)


class Parser(Generic[Value]):
    """A recursive descent parser of the tokens of a text; a subclass defines numbers, names and operators."""

    made_of: ClassVar[str]
    names: ClassVar[tuple[str, ...]] = ()
    functions: ClassVar[tuple[str, ...]] = ()
    max_power = MAX_POWER

    def __init__(self, text: str) -> None:
        self.text = text
        if not text.strip():
            raise ExpressionError(f"the text is empty: {self.made_of}")
        if len(text) > MAX_LENGTH:
            raise ExpressionError(f"the text has {len(text)} characters; at most {MAX_LENGTH} are read")
        self.tokens = self._tokens()
        self.position = 0
        self.depth = 0

    def constant(self, value: Fraction, at: Token) -> Value:
        """Return the value of a number."""
        raise NotImplementedError

    def named(self, name: str, at: Token) -> Value:
        """Return the value of one of `names`."""
        raise NotImplementedError

    def called(self, function: str, arguments: tuple[Value, ...], at: Token) -> Value:
        """Return the value of one of `functions` with its arguments."""
        raise NotImplementedError

    def compared(self, a: Value, b: Value, at: Token) -> Value:
        """Return the comparison a < b, as an argument of a function."""
        raise NotImplementedError

    def added(self, a: Value, b: Value, at: Token) -> Value:
        """Return a + b."""
        raise NotImplementedError

    def negative(self, a: Value, at: Token) -> Value:
        """Return -a."""
        raise NotImplementedError

    def subtracted(self, a: Value, b: Value, at: Token) -> Value:
        """Return a - b."""
        return self.added(a, self.negative(b, at), at)

    def times(self, a: Value, b: Value, at: Token) -> Value:
        """Return a * b."""
        raise NotImplementedError

    def divided(self, a: Value, b: Value, at: Token, divisor_at: Token) -> Value:
        """Return a / b."""
        raise NotImplementedError

    def raised(self, a: Value, power: int, at: Token) -> Value:
        """Return a ^ power."""
        raise NotImplementedError

    def whole(self, value: Value) -> int | None:
        """Return a value in the parentheses of a power as a whole number; None if it is none, as by default."""
        return None

    def inverse(self, a: Value, at: Token) -> Value:
        """Return 1 / a, of which a negative power is made; by default there is none."""
        self._no_power(at)

    def parse(self) -> Value:
        """Parse the whole text."""
        result = self._sum()
        if self._next.kind != "end":
            self._unexpected()
        return result

    def _sum(self) -> Value:
        result = self._product()
        while self._next.text in ("+", "-"):
            sign = self._take()
            term = self._product()
            result = (self.added if sign.text == "+" else self.subtracted)(result, term, sign)
        return result

    def _product(self) -> Value:
        result = self._factor()
        while self._next.text in ("*", "/"):
            operator = self._take()
            at = self._next
            factor = self._factor()
            if operator.text == "*":
                result = self.times(result, factor, operator)
            else:
                result = self.divided(result, factor, operator, at)
        return result

    def _factor(self) -> Value:
        minus: Token | None = None
        while self._next.text in ("+", "-"):
            sign = self._take()
            if sign.text == "-":
                minus = sign if minus is None else None
        value = self._power()
        return value if minus is None else self.negative(value, minus)

    def _power(self) -> Value:
        base = self._atom()
        if self._next.text not in ("^", "**"):
            return base
        operator, at = self._take(), self._next
        power = self._exponent(at)
        if self._next.text in ("^", "**"):
            name = self.names[0] if self.names else "2"
            self.fail(self._next, f"a power of a power needs parentheses, such as ({name}^2)^3")
        if abs(power) > self.max_power:
            self.fail(at, f"the power is too high; the highest is {self.max_power}")
        return self.raised(self.inverse(base, at) if power < 0 else base, abs(power), operator)

    def _exponent(self, at: Token) -> int:
        """A whole number with a sign, or an expression in parentheses that is one; `at` is its first token."""
        sign = -1 if self._next.text == "-" else 1
        if self._next.text in ("+", "-"):
            self._take()
        token = self._take()
        whole = self.whole(self._parentheses(token)) if token.text == "(" else None
        if token.kind == "number" and token.text.isdigit():
            whole = int(token.text)
        if whole is None:
            self._no_power(at)
        return sign * whole

    def _no_power(self, at: Token) -> NoReturn:
        such = f"such as {self.names[0]}^2" if self.names else "such as 2^3"
        self.fail(at, f"a power is a whole number, zero or more, {such}")

    def _atom(self) -> Value:
        token = self._take()
        if token.kind == "number":
            return self.constant(self._number(token), token)
        if token.kind == "name":
            return self._name(token)
        if token.text == "(":
            return self._parentheses(token)
        if token.kind == "end":
            self.fail(token, "something is missing at the end")
        expected = ["a number", *self.names] if len(self.names) < 2 else ["a number", "a name"]
        self.fail(token, f"{', '.join(expected)} or ( is expected before {token.text}")

    def _parentheses(self, opening: Token) -> Value:
        self._open(opening)
        result = self._sum()
        self._close(opening)
        return result

    def _arguments(self, opening: Token) -> tuple[Value, ...]:
        self._open(opening)
        result = [self._argument()]
        while self._next.text == ",":
            self._take()
            result.append(self._argument())
        self._close(opening)
        return tuple(result)

    def _argument(self) -> Value:
        left = self._sum()
        if self._next.text != "<":
            return left
        sign = self._take()
        return self.compared(left, self._sum(), sign)

    def _open(self, opening: Token) -> None:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            self.fail(opening, f"more than {MAX_DEPTH} parentheses are open")

    def _close(self, opening: Token) -> None:
        if self._next.text != ")":
            if self._next.kind == "end":
                self.fail(opening, "this parenthesis is never closed")
            self._unexpected()
        self._take()
        self.depth -= 1

    def _number(self, token: Token) -> Fraction:
        _, _, exponent = token.text.lower().partition("e")
        # The exponent is looked at before 10 is raised to it.
        if exponent and abs(int(exponent)) >= MAX_DIGITS:
            self.too_large(token)
        value = Fraction(token.text)
        if not fits(value):
            self.too_large(token)
        return value

    def _name(self, token: Token) -> Value:
        called = self._next.text == "("
        if called and token.text in self.functions:
            return self.called(token.text, self._arguments(self._take()), token)
        if called and token.text in self.names:
            self.fail(self._next, f"an operator is missing: for a product write {token.text}*(")
        if token.text in self.functions:
            self.fail(token, f"{token.text} is a function; write {token.text}({(*self.names, '2')[0]})")
        if token.text not in self.names:
            self.unknown(token, called)
        return self.named(token.text, token)

    def unknown(self, token: Token, called: bool) -> NoReturn:
        """Fail at a name, or at a function if it is `called`, that is unknown."""
        if called and not self.functions:
            self.fail(token, f"{quoted(token.text)} is called here, and there are no functions: {self.made_of}")
        known = self.functions if called else self.names
        near = difflib.get_close_matches(token.text[:40].lower(), known, n=1, cutoff=0.5)
        if not near and len(known) == 1 and len(token.text) == 1:
            near = [*known]
        hint = f"; did you mean {quoted(near[0])}?" if near else f": {self.made_of}"
        if token.text == INDEX:
            hint = f"; {NO_INDEX}"
        self.fail(token, f"the {'function' if called else 'name'} {quoted(token.text)} is unknown{hint}")

    def too_large(self, at: Token) -> NoReturn:
        """Fail at a number with more digits than are kept."""
        self.fail(
            at,
            f"a number is too large, too small or too long: exact numbers have at most {MAX_DIGITS} digits above "
            "and below the fraction bar",
        )

    def no_meaning(self, token: Token) -> NoReturn:
        """Fail at a character that has no meaning in expressions of this kind, or not there."""
        self.fail(token, f"{quoted(token.text)} has no meaning here: {self.made_of}")

    def fail(self, at: Token, why: str) -> NoReturn:
        """Raise ExpressionError for a fault at a token."""
        raise ExpressionError(f"column {at.column} of {quoted(self.text, MAX_LENGTH)}: {why}")

    @property
    def _next(self) -> Token:
        return self.tokens[self.position]

    def _take(self) -> Token:
        token = self._next
        # The last token is the end, which is never passed.
        self.position = min(self.position + 1, len(self.tokens) - 1)
        return token

    def _unexpected(self) -> NoReturn:
        token = self._next
        if token.text == ")":
            self.fail(token, "this parenthesis was never opened")
        if token.text in (",", "<"):
            self.no_meaning(token)
        self.fail(token, f"an operator is missing before {quoted(token.text)}; for a product write *")

    def _tokens(self) -> list[Token]:
        tokens = []
        for match in _TOKEN.finditer(self.text):
            kind = str(match.lastgroup)
            token = Token(kind, match[kind], match.start(kind) + 1)
            if kind == "other" or (token.text in (",", "<") and not self.functions):
                self.no_meaning(token)
            tokens.append(token)
            if kind == "end":
                break
        return tokens


def names_of(text: str) -> tuple[str, ...]:
    """The names of variables and functions in an expression; none in a text that is no expression."""
    tokens = [(str(match.lastgroup), match) for match in _TOKEN.finditer(text[: MAX_LENGTH + 1])]
    if any(kind == "other" for kind, _ in tokens):
        return ()
    return tuple(match[kind] for kind, match in tokens if kind == "name")


def fits(value: Fraction) -> bool:
    """Whether an exact number has few enough digits to be kept."""
    return max(abs(value.numerator), value.denominator) < TOO_LARGE
