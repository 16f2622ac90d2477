"""Units as texts such as "N m^2" or "kg/(m s)": their size in SI units and their dimension.

product = factor { ["*" | "." | " "] factor | "/" factor }
factor  = ( name | "1" | "(" product ")" ) [ ("^" | "**") [ "-" ] whole number ]
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from derive.errors import TisserandError

Dimension = tuple[int, int, int]
"""A dimension: the powers of length, mass and time."""

PREFIXABLE: dict[str, tuple[float, Dimension]] = {
    "m": (1.0, (1, 0, 0)),
    "g": (1e-3, (0, 1, 0)),
    "s": (1.0, (0, 0, 1)),
    "N": (1.0, (1, 1, -2)),
    "Pa": (1.0, (-1, 1, -2)),
    "J": (1.0, (2, 1, -2)),
    "W": (1.0, (2, 1, -3)),
    "Hz": (1.0, (0, 0, -1)),
    "rad": (1.0, (0, 0, 0)),
}
PREFIXES = {"G": 1e9, "M": 1e6, "k": 1e3, "c": 1e-2, "m": 1e-3, "u": 1e-6, "n": 1e-9}
OTHERS: dict[str, tuple[float, Dimension]] = {
    "1": (1.0, (0, 0, 0)),
    "deg": (math.pi / 180, (0, 0, 0)),
    "rev": (2 * math.pi, (0, 0, 0)),
    "rpm": (2 * math.pi / 60, (0, 0, -1)),
    "t": (1e3, (0, 1, 0)),
    "min": (60.0, (0, 0, 1)),
    "h": (3600.0, (0, 0, 1)),
    "in": (0.0254, (1, 0, 0)),
    "ft": (0.3048, (1, 0, 0)),
    "lb": (0.45359237, (0, 1, 0)),
    "lbf": (0.45359237 * 9.80665, (1, 1, -2)),
    "slug": (0.45359237 * 9.80665 / 0.3048, (0, 1, 0)),
}
_TOKEN = re.compile(r"\s*([A-Za-z]+|[0-9]+|\*\*|[\^*./()-])")
_NO_OPERATOR = ("*", ".", "/", ")", "^", "**", "-", None)


class UnknownUnit(TisserandError):
    """A text is not a unit that this module knows."""


@dataclass(frozen=True)
class UnitSize:
    """The size of a unit in SI units, and its dimension."""

    scale: float
    dimension: Dimension

    def times(self, other: UnitSize, power: int) -> UnitSize:
        """The product with a power of another unit. Raises OverflowError."""
        a, b = self.dimension, other.dimension
        dimension = (a[0] + power * b[0], a[1] + power * b[1], a[2] + power * b[2])
        return UnitSize(self.scale * other.scale**power, dimension)


ONE = UnitSize(1.0, (0, 0, 0))


def unit_size(text: str) -> UnitSize:
    """The size of a unit. Raises UnknownUnit."""
    try:
        return _Reader(text).whole()
    except OverflowError:
        raise UnknownUnit(text) from None


class _Reader:
    """A recursive descent parser of the tokens of a unit."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens: list[str | None] = [*_TOKEN.findall(text), None]
        if "".join(_TOKEN.findall(text)) != re.sub(r"\s", "", text):
            raise UnknownUnit(text)

    def whole(self) -> UnitSize:
        result = self.product()
        if self.tokens != [None]:
            raise UnknownUnit(self.text)
        return result

    def product(self) -> UnitSize:
        result = self.factor(ONE, 1)
        while self.tokens[0] not in (None, ")"):
            power = -1 if self.tokens[0] == "/" else 1
            if self.tokens[0] in ("/", "*", "."):
                self.tokens.pop(0)
            result = self.factor(result, power)
        return result

    def factor(self, result: UnitSize, power: int) -> UnitSize:
        token = self.tokens.pop(0)
        if token == "(":
            unit = self.product()
            if self.tokens.pop(0) != ")":
                raise UnknownUnit(self.text)
        elif token is None or token in _NO_OPERATOR:
            raise UnknownUnit(self.text)
        else:
            unit = _named(token)
        if self.tokens[0] in ("^", "**"):
            self.tokens.pop(0)
            sign = -1 if self.tokens[0] == "-" else 1
            digits = self.tokens.pop(0) if sign > 0 else self.tokens.pop(1)
            if sign < 0:
                self.tokens.pop(0)
            if digits is None or not digits.isdecimal() or len(digits) > 2:
                raise UnknownUnit(self.text)
            power *= sign * int(digits)
        return result.times(unit, power)


def _named(name: str) -> UnitSize:
    if name in OTHERS:
        return UnitSize(*OTHERS[name])
    if name in PREFIXABLE:
        return UnitSize(*PREFIXABLE[name])
    if name[:1] in PREFIXES and name[1:] in PREFIXABLE:
        scale, dimension = PREFIXABLE[name[1:]]
        return UnitSize(PREFIXES[name[0]] * scale, dimension)
    raise UnknownUnit(name)
