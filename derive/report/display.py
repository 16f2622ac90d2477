"""Formulas and equations as HTML by themselves, as notebooks show them."""

from __future__ import annotations

from collections.abc import Sequence

from derive.emit.template import render
from derive.report.equation_html import equations_html
from derive.report.formula import Equation, Formula
from derive.report.mathml import math


def formula_html(formula: Formula) -> str:
    """A formula, within a line."""
    return math(formula)


def equation_html(equation: Equation) -> str:
    """An equation with its own style."""
    return equations_shown((equation,))


def equations_shown(equations: Sequence[Equation]) -> str:
    """Equations below each other, with their own style."""
    style = render("report/display.css", {})
    return f"<style>\n{style}</style>\n{equations_html(equations)}"
