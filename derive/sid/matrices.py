"""The matrices of a SID from its blocks. Each fault is reported with its line."""

from __future__ import annotations

import math
import re
from itertools import permutations

import numpy as np

from derive.errors import quoted
from derive.sid.blocks import Block, BlockEntry, SidProblem
from derive.sid.mapping import DIAGONAL, SYMMETRIC, UNIT, ZERO, Array, Taylor

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eEdD][-+]?\d+)?$")
HEADER = ("order", "nrow", "ncol", "nq", "structure")
"""The entries that every matrix has."""
LARGEST = 10_000
"""The largest number of rows, columns or modes; a larger number is a fault."""


def real_number(entry: BlockEntry, problems: list[SidProblem]) -> float:
    """The real number of an entry, with an exponent E or D; if it is none, 0 and a fault."""
    text = entry.value.split()[0] if entry.value.split() else ""
    value = float(re.sub("[dD]", "e", text)) if _NUMBER.match(text) else math.nan
    if not math.isfinite(value):
        problems.append(SidProblem(entry.line, f"{entry.key}: {quoted(entry.value)} is not a number"))
        return 0.0
    return value


def whole_number(entry: BlockEntry, problems: list[SidProblem]) -> int | None:
    """The non-negative integer of an entry; if it is none, None and a fault."""
    text = entry.value.split()[0] if entry.value.split() else ""
    if not text.isascii() or not text.isdigit() or int(text[:20]) > LARGEST:
        problems.append(
            SidProblem(entry.line, f"{entry.key}: {quoted(entry.value)} is not a number from 0 to {LARGEST}")
        )
        return None
    return int(text)


def read_matrix(block: Block, shapes: tuple[tuple[int, int], ...], n: int, problems: list[SidProblem]) -> Taylor | None:
    """The matrix of a block; None, and faults, if the block is not valid.

    shapes: the admissible (rows, columns). n: the number of modes.
    """
    header: dict[str, int] = {}
    for key in HEADER:
        entry = block.entry(key)
        if entry is None:
            problems.append(SidProblem(block.line, f"{block.name} has no {key}"))
        elif (value := whole_number(entry, problems)) is not None:
            header[key] = value
    if len(header) < len(HEADER):
        return None
    shape = header["nrow"], header["ncol"]
    if shape not in shapes:
        expected = " or ".join(f"{rows} x {columns}" for rows, columns in shapes)
        problems.append(SidProblem(block.line, f"{block.name} is {shape[0]} x {shape[1]}; {expected} is expected"))
        return None
    if header["order"] > 1:
        problems.append(
            SidProblem(block.line, f"{block.name} has order {header['order']}; orders 0 and 1 are supported")
        )
        return None
    if header["structure"] > UNIT:
        problems.append(SidProblem(block.line, f"{block.name}: structures are 0 to 4, not {header['structure']}"))
        return None
    if header["order"] == 1 and header["nq"] != n:
        problems.append(SidProblem(block.line, f"{block.name} has nq = {header['nq']}, but there are {n} modes"))
        return None
    m0 = _coefficients(block, "m0", shape, header["structure"], problems)
    m1 = _coefficients(block, "m1", (shape[0], n, shape[1]), header["structure"], problems) if header["order"] else None
    for entry in block.entries:
        known = (*HEADER, "nqn", "m0", *(("m1",) if header["order"] else ()))
        if entry.key not in known:
            problems.append(SidProblem(entry.line, f"{entry.key} in {block.name} of order {header['order']}"))
    if header["structure"] == UNIT:
        m0 = np.eye(*shape)
    return Taylor(m0, m1, header["structure"])


def _coefficients(block: Block, key: str, shape: tuple[int, ...], structure: int, problems: list[SidProblem]) -> Array:
    """The array m0 or m1 of a block; both triangles of a symmetric matrix are set."""
    result = np.zeros(shape)
    lines: dict[tuple[int, ...], int] = {}
    for entry in block.entries:
        if entry.key != key:
            continue
        index = _index(entry, shape, problems)
        if index is None:
            continue
        if index in lines:
            problems.append(SidProblem(entry.line, f"{_name(entry)} is already on line {lines[index]}"))
            continue
        lines[index] = entry.line
        value = real_number(entry, problems)
        outside = structure in (ZERO, UNIT) or (structure == DIAGONAL and index[0] != index[-1])
        if outside and value:
            problems.append(SidProblem(entry.line, f"{_name(entry)} is not zero, in a matrix of structure {structure}"))
        result[index] = value
        if structure == SYMMETRIC and shape[0] == shape[-1]:
            other = (index[-1], *index[1:-1], index[0])
            if other in lines and result[other] != value:
                message = f"{_name(entry)} differs from line {lines[other]}, in a symmetric matrix"
                problems.append(SidProblem(entry.line, message))
            result[other] = value
    return result


def _index(entry: BlockEntry, shape: tuple[int, ...], problems: list[SidProblem]) -> tuple[int, ...] | None:
    """The index of an entry of an array, from 0; None, and a fault, if it is not valid."""
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
    """An entry in a message: its key and its indices."""
    return f"{entry.key}({entry.indices or ''})"
