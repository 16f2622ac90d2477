"""The page of a study of methods: its picture, the failures, and all tables; it loads no other files."""

from __future__ import annotations

from derive.rendering import render
from derive.study.methods.failures import failures
from derive.study.methods.method_study import MethodStudy
from derive.study.methods.methods_chart import methods_svg
from derive.study.methods.methods_table import tables


def methods_html(study: MethodStudy) -> str:
    """The text of the page."""
    values = {
        "name": study.name,
        "picture": methods_svg(study),
        "failures": failures(study),
        "tables": tables(study),
        "notes": study.notes,
    }
    return render("study/methods.html.jinja", values)
