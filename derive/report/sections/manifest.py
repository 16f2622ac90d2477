"""From what the model was made, by which tools, and the hashes of its files."""

from __future__ import annotations

import json
from collections.abc import Sequence

from derive.artifacts import File
from derive.report.document.page import Block, Code, Heading, Paragraph
from derive.report.document.tables import Said, table


def manifest_blocks(files: Sequence[File]) -> tuple[Block, ...]:
    """The manifest as a table."""
    given = json.loads(next(file.text for file in files if file.path.endswith("manifest.json")))
    tools = ", ".join(f"{name} {version}" for name, version in given["tools"].items())
    hashes: list[list[Said]] = [["specification", Code(given["specification_sha256"])]]
    hashes += [[path.rpartition("/")[2], Code(digest)] for path, digest in given["files"].items()]
    return (
        Heading("Manifest", "manifest"),
        Paragraph((f"Made by {tools}; interface number {given['abi']}. The same specification gives the same bytes.",)),
        table("SHA-256", ("what", "hash"), hashes, wide=True),
    )
