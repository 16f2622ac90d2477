"""The lines of the audit that hold, as trees, and the helpers by which tests evaluate them.

The text shown, the correction and the equation tested are one: every line of every row is taken as the tree that the
page shows, and evaluated. The lines of the beam are what tests compare with the derivation (`printed`); the others are
compared with the transcriptions that tests compare with it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import sympy as sp

from derive.report.document.formula import Formula
from derive.report.notation.expressions import join
from derive.report.notation.formula_reader import equation
from derive.report.paper_audit import SECTIONS

from .formula_value import Meaning, Value

ROWS = {row.number: row for section in SECTIONS for row in section.rows}
ARGUMENTS = ("(X, t)", "(xi, t)", "(xi)", "(t)", "(X)", "(P_c)")


def lines(number: str) -> tuple[str, ...]:
    """The true lines of a row, without arguments: v for v(xi, t), w for u at the other point of (2)."""
    text = "\n".join(ROWS[number].lines)
    for argument in ARGUMENTS:
        text = text.replace(argument, "")
    return tuple(text.replace("u(X + dX, t)", "w").split("\n"))


def sides(number: str, line: str) -> tuple[Formula, Formula]:
    found = equation(line, ROWS[number].scalars)
    return found.left, join(found.parts)


def left(number: str, meaning: Meaning) -> Value:
    return meaning.value(sides(number, lines(number)[0])[0])


def right(number: str, meaning: Meaning) -> Value:
    (line,) = lines(number)
    return meaning.value(sides(number, line)[1])


def zero(difference: Any) -> bool:
    return all(sp.expand(x) == 0 for x in np.ravel(np.asarray(difference, dtype=object)))
