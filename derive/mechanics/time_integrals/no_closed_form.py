"""The error for a function of time whose integral is not known."""

from __future__ import annotations

from derive.errors import TisserandError
from derive.spec.model.time_function import TimeFunction


class NoClosedForm(TisserandError):
    """A function of time whose integral no rule knows; `part` is the product without a rule."""

    def __init__(self, part: TimeFunction | None) -> None:
        super().__init__("the integral has no closed form")
        self.part = part
