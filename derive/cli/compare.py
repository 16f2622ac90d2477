"""`tisserand compare`: compile models, evaluate them at a state, and show what they give side by side."""

from __future__ import annotations

import argparse
import json
import math

import numpy as np

from derive.artifacts import File, write
from derive.cli.build import build_all
from derive.runtime.native import Native, Vector, load
from derive.visual.sparsity import mass_patterns

MOST, DIGITS = 14, 12
"""Rows and columns that are shown, and the width of a number."""


def run(options: argparse.Namespace) -> int:
    """Mass matrix and forces of each model, by the compiled C, at a state of the same numbers."""
    built = build_all(options.specs)
    natives = [load(b.files) for b in built]
    results = [_evaluate(native) for native in natives]
    if options.picture:
        picture = File(options.picture.name, mass_patterns([b.model for b in built]))
        write([picture], options.picture.parent)
    if options.json:
        print(json.dumps(results, indent=2))
    else:
        print("\n\n".join(_show(native, result) for native, result in zip(natives, results, strict=True)))
    return 0


def state(native: Native) -> tuple[Vector, Vector]:
    """Bent bodies that turn by 0.5 rad about e3, at 3 rad/s: alpha_i = 0.02/i m, alphadot_i = 0.1 m/s."""
    if "e0" in native.coordinates:  # in space the last rate of the rigid motion is the spin about e3
        shapes = np.arange(1, native.nq - 6)
        turn = [0.0, 0.0, 0.0, math.cos(0.25), 0.0, 0.0, math.sin(0.25)]
        return np.array([*turn, *0.02 / shapes]), np.array([*[0.0] * 5, 3.0, *np.full(len(shapes), 0.1)])
    names = [name.rsplit("_", 1)[-1] for name in native.coordinates]  # in a scene the body stands before
    found = [_bent(name) for name in names]
    return np.array([q for q, _ in found]), np.array([v for _, v in found])


def _bent(name: str) -> tuple[float, float]:
    """A coordinate and its rate in that state."""
    if name.startswith("alpha"):
        return 0.02 / int(name[len("alpha") :]), 0.1
    return (0.5, 3.0) if name == "phi" else (0.0, 0.0)


def _evaluate(native: Native) -> dict[str, object]:
    """Raises ModelError when the defaults of the parameters make no body."""
    q, v = state(native)
    values, h = native.mass_force(0.0, q, v, native.setup())
    pattern = native.mass_pattern
    matrix: list[list[float | None]] = [[None] * pattern.cols for _ in range(pattern.rows)]
    for (i, j), value in zip(pattern.entries, values, strict=True):
        matrix[i][j] = matrix[j][i] = float(value)
    return {
        "name": native.name,
        "coordinates": list(native.coordinates),
        "rates": list(native.velocities),
        "q": q.tolist(),
        "v": v.tolist(),
        "mass": matrix,
        "force": h.tolist(),
    }


def _show(native: Native, result: dict[str, object]) -> str:
    q, v = state(native)
    matrix = result["mass"]
    force = result["force"]
    assert isinstance(matrix, list) and isinstance(force, list)
    names = native.coordinates if native.nq == native.nv else native.velocities
    width = max(len(n) for n in names)
    pattern = native.mass_pattern
    lines = [
        f"{native.name}, compiled C, parameters at their defaults, at",
        f"  q = {_numbers(q)}",
        f"  v = {_numbers(v)}",
        f"  mass matrix M ({pattern.full_nnz} of {pattern.rows * pattern.cols} structural non-zeros) and forces h",
    ]
    for name, row, h in zip(names[:MOST], matrix, force, strict=False):
        cells = " ".join(f"{'.':>{DIGITS}}" if x is None else f"{x:{DIGITS}.6g}" for x in row[:MOST])
        lines.append(f"  {name:<{width}} {cells}   {h:{DIGITS}.6g}")
    if len(names) > MOST:
        lines.append(f"  ... of {len(names)} rows and columns the first {MOST}; --json has them all")
    return "\n".join(lines)


def _numbers(values: Vector) -> str:
    shown = [f"{x:g}" for x in values[: MOST + 1]] + (["..."] if len(values) > MOST + 1 else [])
    return "[" + ", ".join(shown) + "]"
