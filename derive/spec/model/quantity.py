"""Physical constants of a specification: numbers and run-time parameters."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True)
class Parameter:
    """A run-time parameter of the generated code: its symbol, unit and default value."""

    symbol: str
    unit: str
    default: float


Quantity = Parameter | Fraction
"""A physical constant of the body: a run-time parameter, or a number folded into the code."""
