"""The specification as it was written."""

from __future__ import annotations

from dataclasses import dataclass

from derive.report.document.page import Block, Details, Heading
from derive.report.sections.calling import listing

LONG = 60
"""Lines of a specification that are shown at once."""


@dataclass(frozen=True)
class Text:
    """The specification as it was written: the name of its file, and its lines."""

    name: str
    text: str


def specification_blocks(given: Text) -> tuple[Block, ...]:
    """The specification, folded if it is long."""
    shown = listing("toml", given.name, given.text.strip("\n"))
    count = len(shown.lines)
    block: Block = shown if count <= LONG else Details(f"{given.name}, {count} lines", (shown,))
    return (Heading("Specification", "specification"), block)
