"""Jinja templates: they lay text out and take no decisions."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import jinja2


def templates_folder() -> Path:
    """The folder of all templates: in the package, or beside it in a checkout."""
    package = Path(__file__).parent
    installed, checkout = package / "templates", package.parent / "templates"
    return installed if installed.is_dir() else checkout


@cache
def _environment() -> jinja2.Environment:
    import jinja2  # only where a text is written

    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(templates_folder()),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
    )


def render(name: str, values: Mapping[str, object]) -> str:
    """The text of a template."""
    return _environment().get_template(name).render(values)
