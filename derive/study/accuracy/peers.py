"""Runs of other programs in the chart of a ladder, from a table that they or their users have written."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from pathlib import Path

from derive.errors import TisserandError, quoted

COLUMNS = ("model", "cpu_s", "rms_error", "largest_error")
"""The columns that the table must have; `accuracy.csv` of another study has them."""


class WrongPeers(TisserandError):
    """A table of peers cannot be used; the message lists all its faults."""

    def __init__(self, path: Path, problems: list[tuple[int, str]]) -> None:
        super().__init__("\n".join(f"{path}: {f'line {line}: ' if line else ''}{text}" for line, text in problems))


@dataclass(frozen=True)
class Peer:
    """A model of another program with its runs: CPU seconds, and rms and largest error over the peak."""

    name: str
    runs: tuple[tuple[float, float, float], ...]

    @property
    def best(self) -> float:
        """The smallest rms error."""
        return min(rms for _, rms, _ in self.runs)


def read_peers(path: Path) -> tuple[Peer, ...]:
    """The models of a CSV file with the columns of `COLUMNS`. Raises WrongPeers."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no text in UTF-8"
        raise WrongPeers(path, [(0, f"the table of peers cannot be read: {reason}")]) from None
    table = csv.DictReader(io.StringIO(text))
    missing = [name for name in COLUMNS if name not in (table.fieldnames or ())]
    if missing:
        message = f"the table of peers has no column {', '.join(missing)}; its header is {','.join(COLUMNS)}"
        raise WrongPeers(path, [(1, message)])
    runs: dict[str, list[tuple[float, float, float]]] = {}
    problems = []
    for row in table:
        try:
            seconds, rms, largest = (_positive(row[name]) for name in COLUMNS[1:])
        except ValueError as error:
            problems.append((table.line_num, f"{error} is no positive number"))
            continue
        runs.setdefault(row["model"], []).append((seconds, rms, largest))
    if not runs and not problems:
        problems.append((1, "the table of peers has no rows"))
    if problems:
        raise WrongPeers(path, problems)
    return tuple(Peer(name, tuple(of)) for name, of in runs.items())


def _positive(text: str | None) -> float:
    """The number above 0 in a text. Raises ValueError with the text."""
    try:
        number = float(text or "")
    except ValueError:
        number = 0.0
    if not 0 < number < math.inf:
        raise ValueError(quoted(text or ""))
    return number
