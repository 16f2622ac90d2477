"""Sums of named linear forms with factors that are numbers: the modes at a marker times a coupling of each mode.

Such a sum is a linear form itself, and could be a row of a table by itself. With few markers and many modes these rows
are more numbers than the modes at the markers, which all couplings share, and no less work: Phi (C alpha) in place of
(Phi C) alpha.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Generic, TypeVar

from derive.ir.expressions import Expr, Number, Operation, ScalarRef
from derive.ir.linear_forms import FEWEST_FACTORS
from derive.ir.window_forms import ONE, ZERO, Window, WindowForm, combined_forms

FEWEST_SUMS = 6
"""The number of sums of the same forms from which on they have a loop."""
FORMS: Window = ("", ())
"""The window of the named forms, whose places are the numbers of these."""

Forms = tuple[str, ...]
"""The names of the forms in a sum."""
Sum = tuple[Expr, ...]
"""The factors of a sum."""
Origin = TypeVar("Origin")


class SumsOfRows(Generic[Origin]):
    """The sums in the lines of a loop over instances, by the forms in them, each with what it is by itself."""

    def __init__(self) -> None:
        self.found: dict[Forms, dict[Sum, Origin]] = {}
        self.origins: dict[str, Origin] = {}
        self._known: dict[str, WindowForm] = {}
        self._names: list[str] = []

    def number(self, name: str, value: Expr) -> None:
        """Know a name as that of a number."""
        self._known[name] = WindowForm(None, {}, value)

    def name(self, name: str, expr: Expr, origin: Origin | None) -> None:
        """Know the name of an expression; origin: what it is by itself if it is a form that has a row."""
        form = self._form(expr)
        if form is not None and (origin is None or self._is_sum(form)):
            self._known[name] = form
        elif origin is not None:
            self.origins[name] = origin
            self._known[name] = WindowForm(FORMS, {len(self._names): ONE}, ZERO)
            self._names.append(name)

    def sum(self, expr: Expr) -> tuple[Forms, Sum] | None:
        """The forms and factors of an expression that is a sum of enough forms."""
        form = self._form(expr)
        if form is None or not self._is_sum(form):
            return None
        places = sorted(form.factors)
        return tuple(self._names[k] for k in places), tuple(form.factors[k] for k in places)

    def add(self, of: tuple[Forms, Sum], origin: Origin) -> None:
        """Collect a sum that is this by itself."""
        self.found.setdefault(of[0], {})[of[1]] = origin

    def drop(self, has_row: Callable[[Origin], bool]) -> Iterator[Origin]:
        """Drop the sums that are too few or whose forms have no rows, and yield what they are by themselves."""
        for forms, sums in [*self.found.items()]:
            if len(sums) < FEWEST_SUMS or not all(has_row(self.origins[name]) for name in forms):
                del self.found[forms]
                yield from sums.values()

    def _is_sum(self, form: WindowForm) -> bool:
        return len(form.factors) >= FEWEST_FACTORS and form.offset == ZERO

    def _form(self, expr: Expr) -> WindowForm | None:
        """The form of an expression in the named forms; None if it is none."""
        match expr:
            case Number():
                return WindowForm(None, {}, expr)
            case ScalarRef():
                return self._known.get(expr.name)
            case Operation():
                forms = [form for arg in expr.args if (form := self._form(arg)) is not None]
                return combined_forms(expr.kind, forms) if len(forms) == len(expr.args) else None
        return None
