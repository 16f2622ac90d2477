"""Jinja templates: they lay text out and take no decisions."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping
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


def wrapped(lines: Iterable[str], prefix: str) -> list[str]:
    """Lines of prose, broken at the width of the generated files, each behind a prefix."""
    found = []
    for line in lines:
        indent = " " * (len(line) - len(line.lstrip()))
        parts = (
            textwrap.wrap(
                line.strip(),
                WIDTH - len(prefix),
                initial_indent=indent,
                subsequent_indent=f"{indent}    ",
                break_long_words=False,
                break_on_hyphens=False,
            )
            if len(line) > WIDTH - len(prefix)
            else [line]
        )
        found += [f"{prefix}{part}".rstrip() for part in parts]
    return found


def comment(lines: str | Iterable[str], indent: str = "") -> list[str]:
    """A C comment block."""
    if isinstance(lines, str):
        lines = (lines,)
    body = wrapped((line.replace("*/", "* /") for line in lines), f"{indent} * ")
    if len(body) == 1:
        return [f"{indent}/* {body[0].removeprefix(f'{indent} * ')} */"]
    return [f"{indent}/*", *body, f"{indent} */"]
