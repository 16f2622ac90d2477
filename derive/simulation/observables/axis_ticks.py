"""The ticks of the axes of curves: round values, and their texts with as many digits as distinguish them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

SMALLEST, LARGEST = 1e-4, 1e6
"""Values are written without a power of ten if the largest one is in this range."""
SMALLEST_SPAN, RESOLVED = 1e-290, 1e-12
"""Ranges that are smaller than this, or than this part of their ends, have no ticks between their ends."""
MAX_DECIMALS = 16
"""The largest number of decimals, as many as double precision has."""
SIGNIFICANT, ROUNDING = 15, 1e-9
"""The digits that a tick is rounded to, and the part of a step by which a tick may be beyond the ends."""
MINUS = "\N{MINUS SIGN}"


def ticks(low: float, high: float, least: int) -> list[float]:
    """At least `least` round values between low and high: the fewest multiples of 1, 2 or 5 times a power of ten.

    It is low and high themselves where there is no such number between them.
    """
    span = high - low
    if not (math.isfinite(span) and span > max(SMALLEST_SPAN, RESOLVED * max(abs(low), abs(high)))):
        return [low, high] if low < high else [low]
    exponent = math.floor(math.log10(span / least)) + 1
    for step in (float(f"{factor}e{exponent - k}") for k in range(3) for factor in (5, 2, 1)):
        first, last = math.ceil(low / step - ROUNDING), math.floor(high / step + ROUNDING)
        if last - first + 1 >= least:
            return [float(f"{number * step:.{SIGNIFICANT}g}") for number in range(first, last + 1)]
    return [low, high]


def plain_numbers(values: Sequence[float]) -> list[str]:
    """The texts of values, all with the same number of decimals, such as 0.05, 1000 or 2.5e6."""
    largest = max(map(abs, values), default=0.0)
    spacing = min((abs(b - a) for a, b in pairwise(values) if b != a), default=largest)
    exponent = 0 if not largest or SMALLEST <= largest < LARGEST else math.floor(math.log10(largest))
    scaled, tolerance = [value / 10.0**exponent for value in values], 1e-4 * spacing / 10.0**exponent
    decimals = next(
        (n for n in range(MAX_DECIMALS) if all(abs(round(value, n) - value) <= tolerance for value in scaled)),
        MAX_DECIMALS,
    )
    return [_text(round(value, decimals), decimals, exponent) for value in scaled]


def _text(value: float, decimals: int, exponent: int) -> str:
    power = f"e{exponent}" if exponent and value else ""
    return f"{value or 0.0:.{decimals if value else 0}f}{power}".replace("-", MINUS)
