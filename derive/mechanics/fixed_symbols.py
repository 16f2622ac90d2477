"""The symbols of the time and of the mass, which have no index."""

from __future__ import annotations

from derive.mechanics.symbols import Family, quantity, time

t = time()
"""The time."""

MASS = quantity(Family.MASS)
"""The mass of the body."""
