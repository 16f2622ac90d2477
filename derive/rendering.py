"""Jinja templates: they lay text out and take no decisions."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import jinja2

WIDTH = 100


@cache
def _environment() -> jinja2.Environment:
    package = Path(__file__).parent
    installed, checkout = package / "templates", package.parent / "templates"
    folder = installed if installed.is_dir() else checkout
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(folder),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
    )


def render(name: str, values: Mapping[str, object]) -> str:
    """The text of a template."""
    return _environment().get_template(name).render(values)


@dataclass(frozen=True)
class Item:
    """An entry of a list: a line of prose that is indented."""

    text: str


Prose = str | Item
"""A paragraph, or an entry of a list."""


def broken(lines: Iterable[Prose], width: int) -> list[str]:
    """Paragraphs and entries of lists on lines of `width` characters; words are not broken."""
    return [part for line in lines for part in _broken(line, width)]


def _broken(line: Prose, width: int) -> list[str]:
    text, indent = (line.text, "  ") if isinstance(line, Item) else (line, "")
    if len(indent) + len(text) <= width:
        return [f"{indent}{text}".rstrip()]
    return textwrap.wrap(
        text,
        width,
        initial_indent=indent,
        subsequent_indent=f"{indent}    ",
        break_long_words=False,
        break_on_hyphens=False,
    )


def wrapped(lines: Iterable[Prose], prefix: str) -> list[str]:
    """Lines of prose, broken at the width of the generated files, each behind a prefix."""
    return [f"{prefix}{part}".rstrip() for part in broken(lines, WIDTH - len(prefix))]


def comment(lines: Iterable[Prose], indent: str = "") -> list[str]:
    """A C comment block."""
    prefix = f"{indent} * "
    body = broken(map(_harmless, lines), WIDTH - len(prefix))
    if len(body) == 1:
        return [f"{indent}/* {body[0]} */"]
    return [f"{indent}/*", *(f"{prefix}{line}".rstrip() for line in body), f"{indent} */"]


def _harmless(line: Prose) -> Prose:
    """A line that does not end the comment."""
    text = (line.text if isinstance(line, Item) else line).replace("*/", "* /")
    return Item(text) if isinstance(line, Item) else text
