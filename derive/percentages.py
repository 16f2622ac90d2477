"""Ratios as text, in percent: in messages, tables and pictures."""

from __future__ import annotations

NONE = 5e-9
"""Ratios below this are printed as 0."""
HUGE = 1e5
"""Percentages from here on have an exponent, as errors of a motion that grows without bounds."""


def percent(ratio: float, signed: bool = False) -> str:
    """A ratio in percent with two significant digits, from 10 % on without decimals: 0.31 %, 4.2 %, 100 %, 1e+14 %.

    signed: whether a positive one has its sign, as the difference from another value.
    """
    value, sign = 100 * ratio, "+" if signed else "-"
    if abs(ratio) < NONE:
        return "0 %"
    if abs(value) >= HUGE:
        return f"{value:{sign}.0e} %"
    return f"{value:{sign}.0f} %" if abs(value) >= 9.95 else f"{value:{sign}.2g} %"


def implied_percent(ratio: float) -> str:
    """An error that a monitor estimates, in percent, as estimates assume small ones: all from 100 % on are one."""
    return percent(ratio) if ratio < 1 else "100 % or more"
