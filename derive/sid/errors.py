"""Errors of a SID text: all faults together, each with its line."""

from __future__ import annotations

from dataclasses import dataclass

from derive.errors import TisserandError


@dataclass(frozen=True)
class SidProblem:
    """One fault, and the line that it is on (from 1), or the block that lacks something begins on."""

    line: int
    message: str


class SidError(TisserandError, ValueError):
    """A SID text that cannot be used; `problems` holds all that is wrong with it, in the order of the lines."""

    def __init__(self, problems: list[SidProblem]) -> None:
        self.problems = tuple(sorted(problems, key=lambda problem: problem.line))
        super().__init__("\n".join(f"{problem.line}: {problem.message}" for problem in self.problems))
