"""Ratios as text, in percent: in messages, tables and pictures."""

from __future__ import annotations


def percent(ratio: float) -> str:
    """A ratio in percent with two significant digits, from 10 % on without decimals: 0.31 %, 4.2 %, 100 %."""
    value = 100 * ratio
    return f"{value:.0f} %" if abs(value) >= 9.95 else f"{value:.2g} %"
