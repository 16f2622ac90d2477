"""The syntax of a SID: nested blocks of entries with their line numbers, and the errors of such a text."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from derive.errors import TisserandError, quoted

_END = re.compile(r"end\s+(\w+)\s*$", re.IGNORECASE)
_NEW = re.compile(r"new\s+(\w+)\s*(?:=\s*(.*?))?\s*$", re.IGNORECASE)
_ENTRY = re.compile(r"(\w+)\s*(?:\(([^()]*)\))?\s*=\s*(.*?)\s*$")
_OPEN = re.compile(r"(\w+)\s*$")


@dataclass(frozen=True)
class SidProblem:
    """A fault and its line, from 1; for an entry that is missing, the line on which its block begins."""

    line: int
    message: str


class SidError(TisserandError, ValueError):
    """A SID text is not valid; `problems` are all of its faults, in the order of their lines."""

    def __init__(self, problems: list[SidProblem]) -> None:
        self.problems = tuple(sorted(problems, key=lambda problem: problem.line))
        super().__init__("\n".join(f"{problem.line}: {problem.message}" for problem in self.problems))


@dataclass(frozen=True)
class BlockEntry:
    """An entry of a block, `key( indices) = value`, with its line number."""

    key: str
    indices: str | None
    value: str
    line: int


@dataclass
class Block:
    """A named block: the entries and blocks between its first line and its `end`; `label` is that of a `new` block."""

    name: str
    line: int
    label: str = ""
    entries: list[BlockEntry] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)

    def find(self, name: str) -> Block | None:
        """The first inner block of that name, or None."""
        return next((block for block in self.blocks if block.name == name), None)

    def entry(self, key: str) -> BlockEntry | None:
        """The first entry with that key, or None."""
        return next((entry for entry in self.entries if entry.key == key), None)


def parse_blocks(text: str, problems: list[SidProblem]) -> tuple[str, Block]:
    """The first line of a text, and a root block with the blocks that follow.

    The first line is empty if the text begins with `part`. Faults of syntax are appended to `problems`.
    """
    lines = text.splitlines()
    first = lines[0] if lines and lines[0].strip() != "part" else ""
    root = Block("", 1)
    stack = [root]
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
            message = f"{quoted(line)} is neither a name, nor an `end`, nor `key = value`"
            problems.append(SidProblem(number, message))
    for block in stack[1:]:
        problems.append(SidProblem(block.line, f"{block.name} has no `end {block.name}`"))
    return first, root


def _open(stack: list[Block], block: Block) -> None:
    """Begin a block inside the innermost open block."""
    stack[-1].blocks.append(block)
    stack.append(block)


def _close(stack: list[Block], name: str, line: int, problems: list[SidProblem]) -> None:
    """Close the innermost open block of that name; a block inside it that is still open is a fault."""
    if not any(block.name == name for block in stack[1:]):
        problems.append(SidProblem(line, f"`end {name}` where no {name} has begun"))
        return
    while (block := stack.pop()).name != name:
        problems.append(SidProblem(block.line, f"{block.name} has no `end {block.name}` before line {line}"))
