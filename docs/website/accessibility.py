"""What Sphinx and its theme leave out of pages that are read aloud or used by keyboard."""

from __future__ import annotations

from typing import Any

from sphinx.application import Sphinx


def _headings_with_levels(app: Sphinx, page: str, template: str, context: dict[str, Any], document: Any) -> None:
    """Captions of the navigation are headings, which have a level."""
    if tree := context.get("furo_navigation_tree"):
        context["furo_navigation_tree"] = tree.replace('role="heading"', 'role="heading" aria-level="2"')


def setup(app: Sphinx) -> dict[str, Any]:
    """Change the pages after the theme has."""
    app.connect("html-page-context", _headings_with_levels, priority=900)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
