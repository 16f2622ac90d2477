"""`tisserand compare`: compile models, evaluate them at a state, and show what they give side by side."""

from __future__ import annotations

import argparse
import json

import numpy as np

from derive.commands.build import build_all
from derive.emit.files import File, write
from derive.emit.picture import mass_patterns
from derive.native import Native, Vector, load


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
    """A bent beam that turns: phi = 0.5 rad, alpha_i = 0.02/i m, phidot = 3 rad/s, alphadot_i = 0.1 m/s."""
    shapes = np.arange(1, native.nq - 2)
    q = np.concatenate([[0, 0, 0.5], 0.02 / shapes])
    v = np.concatenate([[0, 0, 3.0], np.full(len(shapes), 0.1)])
    return q, v


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
    names = native.coordinates
    width = max(len(n) for n in names)
    pattern = native.mass_pattern
    lines = [
        f"{native.name}, compiled C, parameters at their defaults, at",
        f"  q = {_numbers(q)}",
        f"  v = {_numbers(v)}",
        f"  mass matrix M ({pattern.full_nnz} of {pattern.rows * pattern.cols} structural non-zeros) and forces h",
    ]
    for name, row, h in zip(names, matrix, force, strict=True):
        cells = " ".join(f"{'.':>12}" if x is None else f"{x:12.6g}" for x in row)
        lines.append(f"  {name:<{width}} {cells}   {h:12.6g}")
    return "\n".join(lines)


def _numbers(values: Vector) -> str:
    return "[" + ", ".join(f"{x:g}" for x in values) + "]"
