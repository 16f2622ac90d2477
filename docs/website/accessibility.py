"""What Sphinx and its theme leave out of pages that are read aloud or used by keyboard."""

from __future__ import annotations

import re
from typing import Any

from sphinx.application import Sphinx

_SIGNATURE = re.compile(r'<dl>\n(?P<lines>(?:<dd><em class="sig-param">.*?</dd>\n)+)</dl>\n', re.DOTALL)


def _lines_of_signature(match: re.Match[str]) -> str:
    """The arguments of a signature, each on a line: they are no definitions of terms, as which Sphinx writes them."""
    lines = match["lines"].replace("<dd>", '<span class="sig-line">').replace("</dd>", "</span>")
    return f'<span class="sig-lines">{lines}</span>'


def _change(app: Sphinx, page: str, template: str, context: dict[str, Any], document: Any) -> None:
    """Captions of the navigation are headings, which have a level; signatures are text."""
    if tree := context.get("furo_navigation_tree"):
        context["furo_navigation_tree"] = tree.replace('role="heading"', 'role="heading" aria-level="2"')
    if body := context.get("body"):
        context["body"] = _SIGNATURE.sub(_lines_of_signature, body)


def setup(app: Sphinx) -> dict[str, Any]:
    """Change the pages after the theme has."""
    app.connect("html-page-context", _change, priority=900)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
