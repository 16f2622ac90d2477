"""The frequencies (JOB.dat) and the modes (JOB.frd) that CalculiX computes; either file may be missing."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from derive.errors import Problem
from derive.fem.keyword_file import read_text
from derive.fem.model import Array, Indices

TABLE = "E I G E N V A L U E   O U T P U T"


def read_frequencies(job: Path) -> Array | None:
    """The frequencies of the last table of eigenvalues, cycles per time; zero for those that are imaginary."""
    path = job.with_suffix(".dat")
    if not path.exists():
        return None
    lines = read_text(path).splitlines()
    starts = [number for number, line in enumerate(lines) if TABLE in line]
    if not starts:
        return None
    rows = (line.split() for line in lines[starts[-1] + 1 :])
    result: list[float] = []
    for parts in rows:
        if len(parts) == 5 and parts[0].isdecimal():
            result.append(float(parts[3]))
        elif result:
            break
    return np.array(result) if result else None


def read_modes(job: Path, numbers: Indices, problems: list[Problem]) -> Array | None:
    """The displacements (modes, nodes, 3) of the modes at the nodes with these numbers.

    A block of displacements begins with ` -4  DISP`; its lines ` -1` hold a node in ten columns and numbers in twelve.
    """
    path = job.with_suffix(".frd")
    if not path.exists():
        return None
    try:
        blocks = [_displacements(block, numbers) for block in _blocks(read_text(path).splitlines())]
    except ValueError:
        problems.append(Problem(path.name, "the displacements of the modes are no numbers in columns; run ccx again"))
        return None
    whole = [block for block in blocks if block is not None]
    return np.array(whole) if whole else None


def _blocks(lines: list[str]) -> Iterator[list[str]]:
    """The lines of the displacements of each mode."""
    of_mode = False
    block: list[str] | None = None
    for line in lines:
        if block is not None and line.startswith(" -1"):
            block.append(line)
        elif line.startswith("  100C"):
            of_mode = "MODAL" in line
        elif line.startswith(" -4"):
            block = [] if of_mode and line.split()[1:2] == ["DISP"] else None
        elif line.startswith(" -3") and block is not None:
            yield block
            block = None


def _displacements(lines: list[str], numbers: Indices) -> Array | None:
    """The displacements at the nodes; None if one of them is not there."""
    node = np.array([line[3:13] for line in lines], dtype=np.int64)
    values = np.array([[line[13:25], line[25:37], line[37:49]] for line in lines], dtype=np.float64)
    order = np.argsort(node)
    at = np.searchsorted(node[order], numbers)
    if not len(node) or (at >= len(node)).any() or (node[order][at] != numbers).any():
        return None
    return values[order[at]]
