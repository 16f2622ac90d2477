"""The HTML of equations and models in notebooks: `_repr_html_` of the main types comes from here."""

from __future__ import annotations

from html import escape

from derive.ir.model import Model
from derive.mechanics.equations import Equations
from derive.report.document.formula import Equation
from derive.report.notation.expressions import notation
from derive.report.sections.mass_matrix import MassPattern, picture
from derive.report.sections.term_lines import group, rank_in_row, title
from derive.report.sections.terms import row_names
from derive.report.writers.equation_html import equations_shown

MOST_ROWS = 16
"""Rows of equations that a notebook shows."""


def html(shown: object) -> str:
    """Equations of motion or a model as HTML. Raises TypeError for anything else."""
    if isinstance(shown, Equations):
        return equations_html(shown)
    if isinstance(shown, Model):
        return model_html(shown)
    raise TypeError(f"notebooks show equations and models, not {type(shown).__name__}")


def equations_html(equations: Equations) -> str:
    """The equations of motion row by row, grouped by accelerations, rates and the rest."""
    written = notation(equations)
    rows = []
    for name in list(row_names(equations))[:MOST_ROWS]:
        terms = sorted((t for t in equations.terms if t.row == name), key=rank_in_row)
        parts = tuple(part for t in terms for part in written.parts(t.expr, "", group(t), title(t)))
        rows.append(Equation(written.variation(name), parts, ":"))
    more = len(row_names(equations)) - len(rows)
    text = f"<p>and {more} more rows</p>" if more > 0 else ""
    return f"<p>{escape(equations.name)}: {escape(equations.doc)}</p>{equations_shown(rows)}{text}"


def model_html(model: Model) -> str:
    """A model as HTML: its kind, its operations, and the pattern of its mass matrix."""
    pattern = model.pattern("mass", "M")
    names = tuple(name for row in model.equations for name in row.elements)
    entries = frozenset(pattern.entries) | {(j, i) for i, j in pattern.entries}
    drawn = picture(MassPattern(names, entries, {}), reasons=False)
    functions = "".join(
        f"<tr><td><code>{escape(kernel.name)}</code></td><td>{kernel.operations}</td></tr>" for kernel in model.kernels
    )
    table = f"<table><tr><th>function</th><th>operations</th></tr>{functions}</table>"
    folded = f"<details><summary>functions</summary>{table}</details>"
    return f"<p>{escape(model.name)}: {escape(model.doc)}</p>{drawn}{folded}"
