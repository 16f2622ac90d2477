"""The specification as it was written, the tools that made the model, and the hashes of its files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass

from derive.artifacts import File
from derive.report.document.page import Block, CodeSpan, Details, Heading, Paragraph
from derive.report.document.tables import Content, table
from derive.report.sections.calling import listing

LONG = 60
"""Lines of a specification that are shown at once."""


@dataclass(frozen=True)
class SpecificationText:
    """The specification as it was written: the name of its file, and its lines."""

    name: str
    text: str


def specification_blocks(given: SpecificationText) -> tuple[Block, ...]:
    """The specification, folded if it is long."""
    shown = listing("toml", given.name, given.text.strip("\n"))
    count = len(shown.lines)
    block: Block = shown if count <= LONG else Details(f"{given.name}, {count} lines", (shown,))
    return (Heading("Specification", "specification"), block)


def manifest_blocks(files: Sequence[File]) -> tuple[Block, ...]:
    """The manifest as a table."""
    given = json.loads(next(file.text for file in files if file.path.endswith("manifest.json")))
    tools = ", ".join(f"{name} {version}" for name, version in given["tools"].items())
    hashes: list[list[Content]] = [["specification", CodeSpan(given["specification_sha256"])]]
    hashes += [[path.rpartition("/")[2], CodeSpan(digest)] for path, digest in given["files"].items()]
    return (
        Heading("Manifest", "manifest"),
        Paragraph((f"Made by {tools}; interface number {given['abi']}. The same specification gives the same bytes.",)),
        table("SHA-256", ("what", "hash"), hashes, wide=True),
    )
