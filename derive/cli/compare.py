"""`tisserand compare`: compile models and print their mass matrices and forces in one state."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Sequence
from typing import assert_never

import numpy as np

from derive.artifacts import File, write
from derive.cli.specifications import build_all
from derive.progress_line import show_progress
from derive.remaining_time import RemainingTime
from derive.roles import Role
from derive.runtime.compiled_model import Native
from derive.runtime.compiler import UNOPTIMISED
from derive.runtime.loading import load
from derive.runtime.native_call import ModelError, Vector
from derive.visual.sparsity import mass_patterns

APART = 0.1
"""The distance of bodies where a force has no value if all are at the origin, m."""
MAX_ROWS, WIDTH = 14, 12
"""Rows and columns that are printed, and the characters of a number."""


def run(options: argparse.Namespace) -> int:
    """Print mass matrix and forces of each model from the compiled C; every model gets the same kind of state."""
    built = build_all(options.specs)
    natives = []
    remaining = RemainingTime(len(built))
    for b in built:
        show_progress(f"{remaining.named(b.model.name)}: compiling the C ...")
        natives.append(load(b.files, UNOPTIMISED))
    show_progress()
    results = [_evaluate(native) for native in natives]
    if options.picture:
        picture = File(options.picture.name, mass_patterns([b.model for b in built]))
        write([picture], options.picture.parent)
    if options.json:
        print(json.dumps(results, indent=2))
    else:
        print("\n\n".join(_show(native, result) for native, result in zip(natives, results, strict=True)))
    return 0


def state(native: Native, apart: float = 0.0) -> tuple[Vector, Vector]:
    """Return q and v of bent bodies at an angle of 0.5 rad about e3 that rotate at 3 rad/s.

    The amplitudes of each body are alpha_i = 0.02/i m and their velocities 0.1 m/s; the positions are 0, or the
    distance `apart` (m), twice that, and so on.
    """
    q: list[float] = []
    v: list[float] = []
    amplitudes = quaternions = 0
    for role in native.roles:
        amplitudes = amplitudes + 1 if role is Role.AMPLITUDE else 0
        match role:
            case Role.AMPLITUDE:
                q.append(0.02 / amplitudes)
                v.append(0.1)
            case Role.ROTATION:
                q.append(0.5)
                v.append(3.0)
            case Role.QUATERNION:
                q.append((math.cos(0.25), 0.0, 0.0, math.sin(0.25))[quaternions % 4])
                if quaternions % 4:  # three angular velocities belong to four elements of the quaternion
                    v.append((0.0, 0.0, 3.0)[quaternions % 4 - 1])
                quaternions += 1
            case Role.TRANSLATION | Role.DISPLACEMENT:
                q.append(apart * (len(q) + 1))
                v.append(0.0)
            case _:
                assert_never(role)
    return np.array(q), np.array(v)


def _evaluate(native: Native) -> dict[str, object]:
    """Evaluate a model in the state of `state`. Raises ModelError if setup refuses the default parameters."""
    q, v = state(native)
    k = native.setup()
    try:
        values, h = native.mass_force(0.0, q, v, k)
    except ModelError:  # a spring has no direction where its ends coincide
        q, v = state(native, APART)
        values, h = native.mass_force(0.0, q, v, k)
    pattern = native.mass_pattern
    matrix: list[list[float | None]] = [[None] * pattern.cols for _ in range(pattern.rows)]
    for (i, j), value in zip(pattern.entries, values, strict=True):
        matrix[i][j] = matrix[j][i] = float(value) + 0.0  # no -0
    return {
        "name": native.name,
        "coordinates": list(native.coordinates),
        "rates": list(native.velocities),
        "q": q.tolist(),
        "v": v.tolist(),
        "mass": matrix,
        "force": (h + 0.0).tolist(),
    }


def _show(native: Native, result: dict[str, object]) -> str:
    q, v, matrix, force = (result[key] for key in ("q", "v", "mass", "force"))
    assert isinstance(q, list) and isinstance(v, list) and isinstance(matrix, list) and isinstance(force, list)
    names = native.coordinates if native.nq == native.nv else native.velocities
    width = max(len(n) for n in names)
    pattern = native.mass_pattern
    lines = [
        f"{native.name}: compiled C with the default parameters, in the state",
        f"  q = {_numbers(q)}",
        f"  v = {_numbers(v)}",
        f"  mass matrix M ({pattern.full_nnz} of {pattern.rows * pattern.cols} structural non-zeros) and forces h",
    ]
    for name, row, h in zip(names[:MAX_ROWS], matrix, force, strict=False):
        cells = " ".join(f"{'.':>{WIDTH}}" if x is None else f"{x:{WIDTH}.6g}" for x in row[:MAX_ROWS])
        lines.append(f"  {name:<{width}} {cells}   {h:{WIDTH}.6g}")
    if len(names) > MAX_ROWS:
        lines.append(f"  ... the first {MAX_ROWS} of {len(names)} rows and columns; --json prints all")
    return "\n".join(lines)


def _numbers(values: Sequence[float]) -> str:
    texts = [f"{x:g}" for x in values[: MAX_ROWS + 1]] + (["..."] if len(values) > MAX_ROWS + 1 else [])
    return "[" + ", ".join(texts) + "]"
