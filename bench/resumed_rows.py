"""Rows of long studies, which are kept in a file as lines of JSON: a study goes on where it has stopped."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from derive.errors import TisserandError, first_line

Row = dict[str, Any]


def resumed(path: Path, scenes: Iterable[tuple[str, Callable[[], Iterable[Row]]]]) -> list[Row]:
    """All rows of a file, with those of the scenes that it does not have yet, which are added.

    scenes: the name of each, and what computes its rows.
    """
    rows = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    finished = {row["scene"] for row in rows}
    for name, compute in scenes:
        if name in finished:
            continue
        try:
            new = list(compute())
        except TisserandError as stopped:
            new = [{"scene": name, "stopped": first_line(stopped)}]
        rows += new
        with path.open("a") as file:
            file.writelines(json.dumps(row) + "\n" for row in new)
        print(name, file=sys.stderr, flush=True)
    return rows
