"""The text of a SID as nested blocks of entries with their line numbers, before its interpretation."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from derive.errors import quoted
from derive.sid.errors import SidProblem

_END = re.compile(r"end\s+(\w+)\s*$", re.IGNORECASE)
_NEW = re.compile(r"new\s+(\w+)\s*(?:=\s*(.*?))?\s*$", re.IGNORECASE)
_ENTRY = re.compile(r"(\w+)\s*(?:\(([^()]*)\))?\s*=\s*(.*?)\s*$")
_OPEN = re.compile(r"(\w+)\s*$")


@dataclass(frozen=True)
class BlockEntry:
    """An entry of a block, `key( indices) = value`, with its line number."""

    key: str
    indices: str | None
    value: str
    line: int


@dataclass
class Block:
    """A named block: the entries and blocks between its first line and its end."""

    name: str
    line: int
    label: str = ""
    entries: list[BlockEntry] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)

    def find(self, name: str) -> Block | None:
        """The first block of a name within this one."""
        return next((block for block in self.blocks if block.name == name), None)

    def entry(self, key: str) -> BlockEntry | None:
        """The first entry of a name."""
        return next((entry for entry in self.entries if entry.key == key), None)


def blocks(text: str, problems: list[SidProblem]) -> tuple[str, Block]:
    """The first line, unless it is `part` already, and the blocks after it within one block for the whole text."""
    lines = text.splitlines()
    first = lines[0] if lines and lines[0].strip() != "part" else ""
    whole = Block("", 1)
    stack = [whole]
    for number, raw in enumerate(["", *lines[1:]] if first else lines, 1):
        line = raw.strip()
        if not line:
            continue
        if end := _END.match(line):
            _close(stack, end[1], number, problems)
        elif new := _NEW.match(line):
            _open(stack, Block(new[1], number, new[2] or ""))
        elif entry := _ENTRY.match(line):
            stack[-1].entries.append(BlockEntry(entry[1], entry[2], entry[3], number))
        elif opened := _OPEN.match(line):
            _open(stack, Block(opened[1], number))
        else:
            message = f"{quoted(line)} is no name, no end and no `key = value`"
            problems.append(SidProblem(number, message))
    for block in stack[1:]:
        problems.append(SidProblem(block.line, f"{block.name} has no `end {block.name}`"))
    return first, whole


def _open(stack: list[Block], block: Block) -> None:
    stack[-1].blocks.append(block)
    stack.append(block)


def _close(stack: list[Block], name: str, line: int, problems: list[SidProblem]) -> None:
    """Close blocks up to the one of this name; those that were still open are faults."""
    if not any(block.name == name for block in stack[1:]):
        problems.append(SidProblem(line, f"`end {name}` where no {name} has begun"))
        return
    while (block := stack.pop()).name != name:
        problems.append(SidProblem(block.line, f"{block.name} has no `end {block.name}` before line {line}"))
