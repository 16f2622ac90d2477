"""The lines of keys in a TOML text, which errors show and tomllib does not give.

The scanner follows the grammar of TOML as far as keys and nesting go. It runs on text that tomllib has
accepted; on anything else it stops, and lines it has not found are those of the nearest enclosing key.
"""

from __future__ import annotations

import contextlib
import re
import tomllib
from dataclasses import dataclass

from derive.errors import TisserandError
from derive.spec.parsing.faults import KeyPath

# What the specifications of this package never reach, so that hostile nesting cannot exhaust the stack.
MAX_DEPTH = 20

_BLANK = re.compile(r"[ \t\r]+|#[^\n]*")
_BLANK_LINES = re.compile(r"[ \t\r\n]+|#[^\n]*")
_KEY = re.compile(r"""[A-Za-z0-9_-]+|"(?:\\.|[^"\\\n])*"|'[^'\n]*'""")
_STRING = re.compile(
    r'''"""(?:\\.|[^\\])*?"""(?:"{0,2})|\'\'\'.*?\'\'\'(?:'{0,2})|"(?:\\.|[^"\\\n])*"|'[^'\n]*\'''', re.DOTALL
)
_WORD = re.compile(r"[^,\]}#\n]+")


def lines(text: str) -> dict[KeyPath, int]:
    """The line, from 1, of each key and each element of an array in a TOML text."""
    scanner = _Scanner(text)
    with contextlib.suppress(_UnexpectedError):
        scanner.document()
    return scanner.lines


@dataclass(frozen=True)
class RepeatedKey:
    """A key or a table that a text has twice, and both lines."""

    path: KeyPath
    first: int
    second: int


def repeated_key(text: str) -> RepeatedKey | None:
    """The first key that a TOML text repeats; None if there is none."""
    scanner = _Scanner(text)
    with contextlib.suppress(_UnexpectedError):
        scanner.document()
    return scanner.repeated


class _UnexpectedError(TisserandError):
    """The text is not what the scanner can follow."""


class _Scanner:
    def __init__(self, text: str) -> None:
        self.text = text
        self.position = 0
        self.line = 1
        self.lines: dict[KeyPath, int] = {}
        self.repeated: RepeatedKey | None = None
        self._defined: dict[KeyPath, int] = {}  # keys with values, tables with headers or with dotted keys

    def document(self) -> None:
        table: KeyPath = ()
        while True:
            self.skip(_BLANK_LINES)
            if self.position == len(self.text):
                return
            if self.take("["):
                array = self.take("[")
                table = self.key()
                if array:
                    # Only the first table of an array is distinguished: no specification has one.
                    self.lines.setdefault(table, self.line)
                else:
                    self._define(table)
                    self.lines[table] = self.line
                self.expect("]]" if array else "]")
            else:
                self.pair(table)

    def pair(self, table: KeyPath, depth: int = 0) -> None:
        path = table + self.key(table)
        self._define(path)
        for parts in range(len(table) + 1, len(path)):
            self._defined.setdefault(path[:parts], self.line)
        self.lines[path] = self.line
        self.expect("=")
        self.value(path, depth)

    def _define(self, path: KeyPath) -> None:
        """Record that a key or a table is defined at the current position."""
        if path in self._defined and self.repeated is None:
            self.repeated = RepeatedKey(path, self._defined[path], self.line)
        self._defined.setdefault(path, self.line)

    def key(self, table: KeyPath = ()) -> KeyPath:
        """Read a dotted key; a key that encloses its last part gets its line unless it already has one."""
        parts: KeyPath = ()
        while True:
            if parts:
                self.lines.setdefault(table + parts, self.line)
            self.skip(_BLANK)
            part = self.match(_KEY)
            parts += (tomllib.loads(f"key = {part}")["key"] if part[0] in "\"'" else part,)
            self.skip(_BLANK)
            if not self.take("."):
                return parts

    def value(self, path: KeyPath, depth: int) -> None:
        if depth > MAX_DEPTH:
            raise _UnexpectedError
        self.skip(_BLANK)
        if self.take("["):
            self.elements(path, depth)
        elif self.take("{"):
            self.inline_table(path, depth)
        elif self.text[self.position : self.position + 1] in ('"', "'"):
            self.match(_STRING)
        else:
            self.match(_WORD)

    def elements(self, path: KeyPath, depth: int) -> None:
        index = 0
        while True:
            self.skip(_BLANK_LINES)
            if self.take("]"):
                return
            self.lines[(*path, index)] = self.line
            self.value((*path, index), depth + 1)
            index += 1
            self.skip(_BLANK_LINES)
            if not self.take(","):
                self.expect("]")
                return

    def inline_table(self, path: KeyPath, depth: int) -> None:
        while True:
            self.skip(_BLANK_LINES)
            if self.take("}"):
                return
            self.pair(path, depth + 1)
            self.skip(_BLANK_LINES)
            if not self.take(","):
                self.expect("}")
                return

    def skip(self, blank: re.Pattern[str]) -> None:
        while match := blank.match(self.text, self.position):
            self.advance(match)

    def match(self, pattern: re.Pattern[str]) -> str:
        match = pattern.match(self.text, self.position)
        if match is None:
            raise _UnexpectedError
        self.advance(match)
        return match[0]

    def advance(self, match: re.Match[str]) -> None:
        self.line += match[0].count("\n")
        self.position = match.end()

    def take(self, mark: str) -> bool:
        if self.text.startswith(mark, self.position):
            self.position += len(mark)
            return True
        return False

    def expect(self, mark: str) -> None:
        self.skip(_BLANK)
        if not self.take(mark):
            raise _UnexpectedError
