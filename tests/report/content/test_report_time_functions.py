"""Functions of time in formulas: every one has all its arguments, as a user writes them."""

from __future__ import annotations

import pytest
import sympy as sp

from derive.mechanics import time_functions
from derive.mechanics.fixed_symbols import t
from derive.mechanics.time_functions import (
    Absolute,
    Atan2,
    Exp,
    Log,
    Lookup,
    Maximum,
    Minimum,
    Select,
    Sign,
    SmoothStep,
    Str,
    Tanh,
    TimeOperation,
    Wrapped,
)
from derive.report.notation.expressions import Notation
from derive.report.notation.spoken_math import words

WORDS = {
    Exp(t): "exp of t",
    Log(t): "log of t",
    Tanh(t): "tanh of t",
    Sign(t): "sign of t",
    Absolute(t): "open bar t close bar",
    Minimum(t, 3): "min of open bracket t , 3 close bracket",
    Maximum(t, 3): "max of open bracket t , 3 close bracket",
    Atan2(t, 3): "atan2 of open bracket t , 3 close bracket",
    Select(t, 3, 0, t): "piecewise of open bracket t less than 3 , 0 , t close bracket",
    SmoothStep(t, 1, 3, 0): "step of open bracket t , 1 , 3 close bracket",
    SmoothStep(t, 1, 3, 1): "step\u2032 of open bracket t , 1 , 3 close bracket",
    Wrapped(t, 3): "mod of open bracket t , 6 pi close bracket",
    Lookup(Str("lift"), sp.S.Zero, t): "lift of t",
    Lookup(Str("lift"), sp.S(2), t): "lift\u2032\u2032 of t",
}


@pytest.mark.parametrize("expr", WORDS, ids=str)
def test_they_are_written_with_all_arguments(expr: sp.Expr) -> None:
    assert words(Notation((), None, {}, frozenset()).formula(expr)) == WORDS[expr]


def test_all_functions_of_time_are_here() -> None:
    known = vars(time_functions).values()
    operations = {v for v in known if isinstance(v, type) and issubclass(v, TimeOperation) and v is not TimeOperation}
    assert {type(expr) for expr in WORDS} == operations
