"""Lines of generated files, broken at their width: comments with paragraphs and lists, and statements."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

WIDTH = 100
"""Characters of a line of a generated file."""


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


def prefixed(lines: Iterable[Prose], prefix: str) -> list[str]:
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


class BreakableText(NamedTuple):
    """A text that may be broken into lines before each of its pieces but the first; made for each part of a formula."""

    pieces: tuple[str, ...]

    def __str__(self) -> str:
        return "".join(self.pieces)


PLUS = BreakableText(("", " + "))
"""A plus before which a line may be broken."""


def join(*parts: str | BreakableText) -> BreakableText:
    """Texts one after the other; they can be broken where their parts can."""
    pieces = [""]
    for part in parts:
        if isinstance(part, str):
            pieces[-1] += part
        else:
            pieces[-1] += part.pieces[0]
            pieces += part.pieces[1:]
    return BreakableText(tuple(pieces))


def statement(indent: str, head: str, expression: BreakableText, end: str) -> list[str]:
    """`head expression end` on as many lines as it needs, broken before a plus or a minus."""
    lines, current = [], f"{indent}{head}"
    for piece in join(expression, end).pieces:
        if len(current) + len(piece) > WIDTH and current.strip():
            lines.append(current.rstrip())
            current = f"{indent}    {piece.lstrip()}"
        else:
            current += piece
    return [*lines, current]
