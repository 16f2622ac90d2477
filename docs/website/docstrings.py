"""Docstrings as Markdown.

A docstring is plain text with `code` in backticks, indented blocks, examples that begin with >>>, and sections with an
entry for each argument, attribute or error:

    Arguments:
        duration: the time that is simulated, s.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from textwrap import dedent

ENTRIES = ("Arguments", "Attributes", "Raises")
"""Sections of entries, each with one name or several and a text."""

SECTION = re.compile(r"^(Arguments|Attributes|Returns|Raises|Yields|Examples?|Notes?):$", re.MULTILINE)
ENTRY = re.compile(r"^(?P<names>\**[A-Za-z_][\w.]*(?:, \**[A-Za-z_][\w.]*)*): ", re.MULTILINE)
CODE = re.compile(r"`[^`\n]+`")
SPECIAL = re.compile(r"[\\*_<\[\]$|]")

Link = Callable[[str], str]
"""The Markdown of a name in code, such as a link to its place in the reference."""


def sections(docstring: str) -> Iterator[tuple[str, str]]:
    """The parts of a docstring: the heading of each, "" for the text before the first one, and its text."""
    starts = list(SECTION.finditer(docstring))
    yield "", docstring[: starts[0].start() if starts else None].strip()
    for start, after in zip(starts, [*starts, None][1:], strict=True):
        yield start[1], dedent(docstring[start.end() : after.start() if after else None].strip("\n")).rstrip()


def entries(text: str) -> Iterator[tuple[str, str]]:
    """The entries of a section: the names of each, and its text."""
    starts = [match for match in ENTRY.finditer(text) if match.start() == 0 or text[match.start() - 1] == "\n"]
    for start, after in zip(starts, [*starts, None][1:], strict=True):
        yield start["names"], " ".join(text[start.end() : after.start() if after else None].split())


def prose(text: str, link: Link) -> str:
    """A text whose code may be links, and whose other signs mean nothing in Markdown."""
    result, end = [], 0
    for code in CODE.finditer(text):
        result += [SPECIAL.sub(r"\\\g<0>", text[end : code.start()]), link(code[0].strip("`"))]
        end = code.end()
    return "".join([*result, SPECIAL.sub(r"\\\g<0>", text[end:])])


def paragraphs(text: str, link: Link) -> str:
    """Paragraphs, in which indented blocks and examples are code."""
    result = []
    for block in re.split(r"\n[ \t]*\n", text):
        if block.lstrip().startswith(">>>"):
            result.append(f"```pycon\n{dedent(block).strip()}\n```")
        elif block.startswith("    "):
            result.append(f"```text\n{dedent(block).strip()}\n```")
        elif block.strip():
            result.append(prose(block.strip(), link))
    return "\n\n".join(result)


def summary(docstring: str, link: Link) -> str:
    """The first sentence."""
    first = " ".join(docstring.split("\n\n", maxsplit=1)[0].split())
    return prose(re.split(r"(?<=[.:;]) (?=[A-Z`])", first)[0].rstrip(":;"), link)


def definitions(items: list[tuple[str, str, str]], link: Link) -> str:
    """A list of names, each with its type ("" if it is not known) and its text."""
    result = []
    for name, kind, text in items:
        term = ", ".join(f"`{one}`" for one in name.split(", "))
        result.append(f"{term}{f' : *{prose(kind, link)}*' if kind else ''}\n: {prose(text, link)}")
    return "\n\n".join(result)


def markdown(docstring: str, link: Link, types: dict[str, str]) -> str:
    """The Markdown of a docstring; types: of attributes, by their names."""
    result = []
    for heading, text in sections(docstring):
        if heading:
            result.append(f"**{heading}**")
        if heading in ENTRIES:
            items = [(name, types.get(name, ""), words) for name, words in entries(text)]
            result.append(definitions(items, link) if items else paragraphs(text, link))
        else:
            result.append(paragraphs(text, link))
    return "\n\n".join(part for part in result if part)
