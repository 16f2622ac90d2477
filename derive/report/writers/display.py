"""Formulas and equations as HTML by themselves, as notebooks show them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from derive.rendering import render
from derive.report.document.formula import Equation, Formula
from derive.report.writers.equation_html import equations_html
from derive.report.writers.mathml import math


def formula_html(formula: Formula) -> str:
    """A formula, within a line."""
    return math(formula)


def equation_html(equation: Equation) -> str:
    """An equation with its own style."""
    return equations_shown((equation,))


def equations_shown(equations: Sequence[Equation]) -> str:
    """Equations below each other, with their own style, and without the anchors and links that a page gives them."""
    style = render("report/display.css", {})
    return f"<style>\n{style}</style>\n{equations_html([_loose(one) for one in equations])}"


def _loose(equation: Equation) -> Equation:
    parts = tuple(replace(part, anchor="", to="") for part in equation.parts)
    return replace(equation, anchor="", parts=parts)
