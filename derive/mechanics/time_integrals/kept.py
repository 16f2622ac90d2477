"""Integrals of functions of time, which are kept in the cache between runs, since SymPy finds them."""

from __future__ import annotations

from dataclasses import astuple
from functools import lru_cache

from derive.kept_objects import kept_object
from derive.spec.model.time_function import TimeFunction


@lru_cache(maxsize=256)
def kept_integral(of: TimeFunction) -> TimeFunction:
    """The integral of a function from 0 to t, as a function of t. Raises NoClosedForm."""

    def made() -> TimeFunction:
        from derive.mechanics.time_integrals.closed_form import time_integral

        return time_integral(of)

    return kept_object("time integral", repr(astuple(of)), made)
