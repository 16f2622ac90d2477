"""Physical constants of a specification: numbers and run-time parameters."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from derive.spec.model.keys import KeyType, key

UNIT = key(KeyType.UNIT, "Unit in comments and in the report; by default the SI unit.", optional=True)


@dataclass(frozen=True)
class Parameter:
    """A run-time parameter of the generated code: its symbol, unit and default value."""

    symbol: str
    unit: str
    default: float

    def __str__(self) -> str:
        return f"{self.symbol} = {self.default:g} {self.unit}".rstrip()


Quantity = Parameter | Fraction
"""A physical constant of the body: a run-time parameter, or a number folded into the code."""
