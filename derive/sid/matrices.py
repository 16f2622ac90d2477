"""Blocks of a SID as matrices: every number in its place, or a fault with its line."""

from __future__ import annotations

import math
import re
from itertools import permutations

import numpy as np

from derive.errors import quoted
from derive.sid.blocks import Block, BlockEntry
from derive.sid.errors import SidProblem
from derive.sid.taylor import DIAGONAL, SYMMETRIC, UNIT, ZERO, Array, Taylor

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eEdD][-+]?\d+)?$")
HEAD = ("order", "nrow", "ncol", "nq", "structure")
LARGEST = 10_000
"""Rows, columns or modes beyond this are a mistake rather than a body."""


def number(entry: BlockEntry, problems: list[SidProblem]) -> float:
    """A real number, with an exponent of E or D."""
    text = entry.value.split()[0] if entry.value.split() else ""
    value = float(re.sub("[dD]", "e", text)) if _NUMBER.match(text) else math.nan
    if not math.isfinite(value):
        problems.append(SidProblem(entry.line, f"{entry.key}: {quoted(entry.value)} is not a number"))
        return 0.0
    return value


def whole(entry: BlockEntry, problems: list[SidProblem]) -> int | None:
    """A whole number that is not negative."""
    text = entry.value.split()[0] if entry.value.split() else ""
    if not text.isascii() or not text.isdigit() or int(text[:20]) > LARGEST:
        problems.append(
            SidProblem(entry.line, f"{entry.key}: {quoted(entry.value)} is not a number from 0 to {LARGEST}")
        )
        return None
    return int(text)


def matrix(block: Block, shapes: tuple[tuple[int, int], ...], n: int, problems: list[SidProblem]) -> Taylor | None:
    """The matrix of a block, in one of its admissible sizes; None, and a fault, if the block is not valid."""
    head: dict[str, int] = {}
    for key in HEAD:
        entry = block.entry(key)
        if entry is None:
            problems.append(SidProblem(block.line, f"{block.name} has no {key}"))
        elif (value := whole(entry, problems)) is not None:
            head[key] = value
    if len(head) < len(HEAD):
        return None
    shape = head["nrow"], head["ncol"]
    if shape not in shapes:
        wanted = " or ".join(f"{rows} x {columns}" for rows, columns in shapes)
        problems.append(SidProblem(block.line, f"{block.name} is {shape[0]} x {shape[1]}; {wanted} is expected"))
        return None
    if head["order"] > 1:
        problems.append(SidProblem(block.line, f"{block.name} has order {head['order']}; orders 0 and 1 are known"))
        return None
    if head["structure"] > UNIT:
        problems.append(SidProblem(block.line, f"{block.name}: structures are 0 to 4, not {head['structure']}"))
        return None
    if head["order"] == 1 and head["nq"] != n:
        problems.append(SidProblem(block.line, f"{block.name} has nq = {head['nq']}, but there are {n} modes"))
        return None
    m0 = _filled(block, "m0", shape, head["structure"], problems)
    m1 = _filled(block, "m1", (shape[0], n, shape[1]), head["structure"], problems) if head["order"] else None
    for entry in block.entries:
        known = (*HEAD, "nqn", "m0", *(("m1",) if head["order"] else ()))
        if entry.key not in known:
            problems.append(SidProblem(entry.line, f"{entry.key} in {block.name} of order {head['order']}"))
    if head["structure"] == UNIT:
        m0 = np.eye(*shape)
    return Taylor(m0, m1, head["structure"])


def _filled(block: Block, key: str, shape: tuple[int, ...], structure: int, problems: list[SidProblem]) -> Array:
    """The entries of one order, those of a symmetric matrix on both sides."""
    result = np.zeros(shape)
    seen: dict[tuple[int, ...], int] = {}
    for entry in block.entries:
        if entry.key != key:
            continue
        index = _index(entry, shape, problems)
        if index is None:
            continue
        if index in seen:
            problems.append(SidProblem(entry.line, f"{_name(entry)} stands on line {seen[index]} already"))
            continue
        seen[index] = entry.line
        value = number(entry, problems)
        outside = structure in (ZERO, UNIT) or (structure == DIAGONAL and index[0] != index[-1])
        if outside and value:
            problems.append(SidProblem(entry.line, f"{_name(entry)} is not zero, in a matrix of structure {structure}"))
        result[index] = value
        if structure == SYMMETRIC and shape[0] == shape[-1]:
            other = (index[-1], *index[1:-1], index[0])
            if other in seen and result[other] != value:
                message = f"{_name(entry)} differs from line {seen[other]}, in a symmetric matrix"
                problems.append(SidProblem(entry.line, message))
            result[other] = value
    return result


def _index(entry: BlockEntry, shape: tuple[int, ...], problems: list[SidProblem]) -> tuple[int, ...] | None:
    parts = [part.strip() for part in (entry.indices or "").split(",")]
    if len(parts) != len(shape) or not all(part.isascii() and part.isdigit() and len(part) < 9 for part in parts):
        form = "m0( row, column)" if len(shape) == 2 else "m1( row, mode, column)"
        problems.append(SidProblem(entry.line, f"{_name(entry)} is not of the form {form}"))
        return None
    index = tuple(int(part) - 1 for part in parts)
    if any(not 0 <= i < size for i, size in zip(index, shape, strict=True)):
        sizes = " x ".join(map(str, shape))
        hint = ""
        if len(shape) == 3 and any(all(0 <= i < s for i, s in zip(p, shape, strict=True)) for p in permutations(index)):
            hint = "; the mode is the second index"
        problems.append(SidProblem(entry.line, f"{_name(entry)} is outside of {sizes}{hint}"))
        return None
    return index


def _name(entry: BlockEntry) -> str:
    return f"{entry.key}({entry.indices or ''})"
