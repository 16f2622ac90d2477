"""Integrals of functions of time, which are kept in the cache between runs, since SymPy finds them."""

from __future__ import annotations

from dataclasses import astuple
from functools import lru_cache

from derive.errors import TisserandError
from derive.kept_objects import kept_object
from derive.spec.model.time_function import TimeFunction


class NoClosedForm(TisserandError):
    """A function of time whose integral no rule knows; `part` is the product without a rule."""

    def __init__(self, part: TimeFunction | None) -> None:
        super().__init__("the integral has no closed form")
        self.part = part


@lru_cache(maxsize=256)
def kept_integral(of: TimeFunction) -> TimeFunction:
    """The integral of a function from 0 to t, as a function of t. Raises NoClosedForm."""

    def made() -> TimeFunction:
        from derive.mechanics.time_integrals.closed_form import time_integral

        return time_integral(of)

    return kept_object("time integral", repr(astuple(of)), made)
