"""The base class of all errors of the package, and the error of a specification.

Every exception class of the package derives from TisserandError; its text says what failed, where, and what to do, so
that the command line prints it and ends with exit code 2.
"""

from __future__ import annotations

from dataclasses import dataclass


class TisserandError(Exception):
    """An error that its text explains: the base class of all exceptions of this package.

    Examples:
        >>> import derive
        >>> try:
        ...     derive.planar_beam("beam", frame="meen")
        ... except derive.TisserandError as error:
        ...     print(error)
        beam.frame: the frame is one of "mean", "point", "chord", "tangent", "given", not "meen"; did you mean "mean"?
    """


@dataclass(frozen=True)
class Problem:
    """One fault of a specification.

    path: its key, such as `beam.ansatz[2]`; "" for the file itself. message: what is wrong, and what to write instead.
    line: the line of the TOML file, from 1; None if it is not known, or if there is no file.
    """

    path: str
    message: str
    line: int | None = None


class SpecError(TisserandError):
    """A specification that cannot be used.

    Attributes:
        problems: all its faults, each with `path` (its key), `message` and `line` (of the TOML file, or None).
        source: the file, or None.

    Examples:
        >>> import derive
        >>> try:
        ...     derive.planar_beam("beam", mass=-1, length=0)
        ... except derive.SpecError as error:
        ...     print(error)
        beam.mass: a positive number is needed, not -1
        beam.length: a positive number is needed, not 0
    """

    def __init__(self, problems: tuple[Problem, ...], source: str | None = None) -> None:
        self.problems = problems
        self.source = source
        super().__init__(problems, source)

    def __str__(self) -> str:
        return "\n".join(problem_text(problem, self.source) for problem in self.problems)


def problem_text(problem: Problem, source: str | None) -> str:
    """A fault, or a warning, with its file, its line and its key, on one line."""
    where = source if source is not None else ""
    if where and problem.line is not None:
        where += f":{problem.line}"
    return ": ".join(printable(part) for part in (where, problem.path, problem.message) if part)


def first_line(error: Exception) -> str:
    """An error in a line."""
    return str(error).splitlines()[0]


def quoted(text: str, limit: int = 60) -> str:
    """Text of a user as a message shows it: in quotation marks, on one line, not too long."""
    return f'"{printable(text if len(text) <= limit else text[:limit] + "…")}"'


def printable(text: str) -> str:
    """Text in which nothing can break the line, hide, or fail to be encoded."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)
