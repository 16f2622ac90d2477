"""Equations as HTML: small pieces of MathML that a line may end between, aligned at their relations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from html import escape
from itertools import groupby

from derive.rendering import render
from derive.report.document.anchors import address
from derive.report.document.formula import Equation, Formula, Part
from derive.report.notation.spacing import has_matrix
from derive.report.notation.spoken_math import equation_words, words
from derive.report.writers.mathml import math, relation_math, summand_math

LONG = 6
"""Equations of more parts tell their groups, each on lines of its own."""


def equations_html(equations: Sequence[Equation]) -> str:
    """Equations below each other, aligned at their relations."""
    kind = "eqs wide" if any(has_matrix(item) for item in equations) else "eqs"
    return f'<div class="{kind}">{"".join(_equation(item) for item in equations)}</div>'


def _equation(equation: Equation) -> str:
    aria_label = escape(f"{f'({equation.number}): ' if equation.number else ''}{equation_words(equation)}")
    anchor = f' id="{escape(equation.anchor)}"' if equation.anchor else ""
    return (
        f'<div class="eq"{anchor} role="group" aria-label="{aria_label}">'
        f'<span class="l">{_piece(equation.left)}</span>'
        f'<span class="q"><span class="r">{relation_math(equation.relation) if equation.relation else ""}</span>'
        f"{_groups(equation.parts)}</span>{_number(equation)}</div>"
    )


def _piece(formula: Formula) -> str:
    return math(formula).replace(f' alttext="{escape(words(formula))}"', "", 1)


def _number(equation: Equation) -> str:
    if not equation.number:
        return ""
    text = f"({escape(equation.number)})"
    kind = "n w" if len(equation.number) > 3 else "n"
    return (
        f'<a class="{kind}" href="#{escape(equation.anchor)}">{text}</a>'
        if equation.anchor
        else f'<span class="{kind}">{text}</span>'
    )


def _groups(parts: Sequence[Part]) -> str:
    numbered = list(enumerate(parts))
    groups = [(name, list(some)) for name, some in groupby(numbered, lambda item: item[1].group)]
    listed = len(parts) > LONG and len(groups) > 1
    if len(groups) == 1:
        return f'<span class="b g">{"".join(_part(part, k == 0) for k, part in numbered)}</span>'
    inner = (_group(name if listed else "", [_part(part, k == 0) for k, part in some]) for name, some in groups)
    return f'<span class="b">{"".join(inner)}</span>'


def _group(name: str, pieces: Sequence[str]) -> str:
    label = f"<small>{escape(name)}</small>" if name else ""
    return f'<span class="{"g t" if name else "g"}">{"".join(pieces)}{label}</span>'


def _part(part: Part, first: bool) -> str:
    shown = summand_math(part, first)
    title = f' title="{escape(part.title)}"' if part.title else ""
    to = part.to or (f"#{part.anchor}" if part.anchor else "")
    anchor = f' id="{escape(part.anchor)}"' if part.anchor else ""
    if to:
        return f'<a{anchor} href="{escape(address(to))}"{title}>{shown}</a>'
    return f'<span{title} tabindex="0">{shown}</span>' if title else f"<span>{shown}</span>"


def equations_shown(equations: Sequence[Equation]) -> str:
    """Equations below each other, with their own style, and without the anchors and links that a page gives them."""
    style = render("report/display.css", {})
    return f"<style>\n{style}</style>\n{equations_html([_loose(item) for item in equations])}"


def _loose(equation: Equation) -> Equation:
    parts = tuple(replace(part, anchor="", to="") for part in equation.parts)
    return replace(equation, anchor="", parts=parts)
