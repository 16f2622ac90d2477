"""What is wrong with a specification: every fault at once, each with its place and its line."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """One fault: its key (`beam.ansatz[2]`, or "" for the file itself), what to do, and the line if known."""

    path: str
    message: str
    line: int | None = None


class SpecError(Exception):
    """A specification that cannot be used; `problems` holds all its faults, `source` the file."""

    def __init__(self, problems: tuple[Problem, ...], source: str | None = None) -> None:
        self.problems = problems
        self.source = source
        super().__init__(problems, source)

    def __str__(self) -> str:
        return "\n".join(self._line(problem) for problem in self.problems)

    def _line(self, problem: Problem) -> str:
        where = printable(self.source) if self.source is not None else ""
        if where and problem.line is not None:
            where += f":{problem.line}"
        return ": ".join(part for part in (where, problem.path, problem.message) if part)


def quoted(text: str, limit: int = 60) -> str:
    """Text of a user as a message shows it: in quotation marks, on one line, not too long."""
    return f'"{printable(text if len(text) <= limit else text[:limit] + "…")}"'


def printable(text: str) -> str:
    """Text in which nothing can break the line, hide, or fail to be encoded."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)
