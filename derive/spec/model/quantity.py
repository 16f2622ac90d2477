"""Physical constants of a specification: numbers and run-time parameters."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from derive.spec.model.keys import KeyType, key

UNIT = key(KeyType.UNIT, "Unit in comments and in the report; by default the SI unit.", optional=True)


@dataclass(frozen=True)
class Parameter:
    """A run-time parameter of the generated code.

    Attributes:
        symbol: its symbol, which is its name in the generated code.
        unit: its unit.
        default: its default value.

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam", mass=derive.Parameter("rho", "kg", 2.5), length=1, bending_stiffness=1)
        >>> derive.lower(derive.derive(beam)).defaults
        (2.5,)
    """

    symbol: str
    unit: str
    default: float

    def __str__(self) -> str:
        return f"{self.symbol} = {self.default:g} {self.unit}".rstrip()


Quantity = Parameter | Fraction
"""A physical constant of the body: a run-time parameter, or a number folded into the code."""
