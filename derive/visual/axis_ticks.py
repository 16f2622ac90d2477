"""Ticks of an axis: round numbers, or multiples of pi, and their labels."""

from __future__ import annotations

import math
from dataclasses import dataclass

STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
"""Distances of ticks, times a power of ten."""

PI_STEPS = (0.25, 0.5, 1, 2, 4, 10, 20, 100)
"""Distances of ticks of an angle, times pi."""

MAX_STEPS = 10
"""The largest number of distances of an axis in multiples of pi."""

LONGEST = 8
"""Characters of a label, beyond which all labels leave out what they have in common."""

MINUS = "\N{MINUS SIGN}"
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Ticks:
    """The positions of ticks and their labels, to which `common` applies: a power of ten, or a number to be added."""

    positions: tuple[float, ...]
    labels: tuple[str, ...]
    common: str = ""


def ticks(low: float, high: float, most: int, unit: str = "") -> Ticks:
    """Ticks from low to high, low < high, with at most `most` distances between them.

    An angle in rad over more than half a revolution has ticks at multiples of pi.
    """
    if unit == "rad" and high - low >= math.pi:
        step = next((s for s in PI_STEPS if (high - low) / math.pi / s <= MAX_STEPS), None)
        if step is not None:
            multiples = _multiples(low, high, step * math.pi)
            return Ticks(
                tuple(n * step * math.pi for n in multiples), tuple(_multiple_of_pi(n * step) for n in multiples)
            )
    return _decimal_ticks(low, high, most)


def _decimal_ticks(low: float, high: float, most: int) -> Ticks:
    least = (high - low) / most * (1 - 1e-9)
    exponent = math.floor(math.log10(least))
    factor = next(s for s in STEPS if s * 10.0**exponent >= least)
    step = factor * 10.0**exponent
    decimals = -exponent + (factor == 2.5) - (factor == 10.0)
    base, power = 0.0, _power(max(abs(low), abs(high)))
    if len(_decimal(high / 10.0**power, decimals + power)) > LONGEST:  # 100.0000012
        span = 10.0 ** math.ceil(math.log10(high - low))
        base = math.floor(low / span) * span
        power = _power(high - base)
    multiples = _multiples(low, high, step)
    labels = tuple(_decimal((n * step - base) / 10.0**power, decimals + power) for n in multiples)
    common = [f"\N{MULTIPLICATION SIGN}10{str(power).translate(SUPERSCRIPTS)}"] if power else []
    if base:
        common.append(f"{MINUS if base < 0 else '+'} {abs(base):.15g}")
    return Ticks(tuple(n * step for n in multiples), labels, " ".join(common))


def _power(size: float) -> int:
    """The power of ten that labels leave out: that of very small and very large numbers."""
    power = math.floor(math.log10(size)) if size else 0
    return 0 if -5 < power < 6 else power


def _multiples(low: float, high: float, step: float) -> range:
    """The whole numbers n with low <= n step <= high, up to rounding."""
    return range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)


def _decimal(value: float, decimals: int) -> str:
    text = f"{value:.{max(0, decimals)}f}"
    return text.lstrip("-") if float(text) == 0 else text.replace("-", MINUS)


def _multiple_of_pi(value: float) -> str:
    text = f"{abs(value):.2f}".rstrip("0").rstrip(".")
    sign = MINUS if value < 0 else ""
    return "0" if text == "0" else f"{sign}π" if text == "1" else f"{sign}{text}π"
