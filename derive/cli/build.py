"""`tisserand build`: generate the files of specifications and print a table of the stages."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path

from derive.artifacts import write
from derive.cli.build_notes import build_notes
from derive.cli.specifications import build_all
from derive.pipeline import Built
from derive.terminal import table

SIZES = ("terms", "operations", "nonzeros")
"""The sizes of a stage, each of which is None where it does not apply."""


def run(options: argparse.Namespace) -> int:
    """Build all specifications, then write all files; an error in any specification prevents all writing."""
    paths = tuple(dict.fromkeys(options.specs))
    built = dict(zip(paths, build_all(paths, options.sensitivities, options.functions), strict=True))
    write([file for b in built.values() for file in b.files], options.out)
    if options.json:
        print(json.dumps([_plain(b, path, options.out) for path, b in built.items()], indent=2))
    else:
        print("\n\n".join(_table(b, path, options.out) for path, b in built.items()))
    return 0


def _table(built: Built, path: Path, out: Path) -> str:
    mass = built.model.pattern("mass", "M")
    rows = [["stage", "seconds", "terms", "operations", "non-zeros"], *map(_row, _stages(built))]
    setup = built.model.kernel("setup").operations
    return "\n".join(
        [
            f"{built.model.name}: {built.model.doc}",
            *(f"  {note}" for note in build_notes(built, path)),
            *table(rows),
            "  operations: one evaluation of mass matrix and forces together; setup takes "
            f"{setup} more, once for each set of parameters",
            f"  non-zeros: structural ones among the {mass.rows * mass.cols} entries of the mass matrix",
            *(f"  wrote {out / file.path}" for file in built.files),
        ]
    )


def _row(stage: dict[str, object]) -> list[str]:
    counts = (stage[size] for size in SIZES)
    return [str(stage["name"]), f"{stage['seconds']:.3f}", *("" if n is None else str(n) for n in counts)]


def _stages(built: Built) -> Iterator[dict[str, object]]:
    """Yield the name, the wall-clock time (s) and the sizes of each stage."""
    model = built.model
    terms = nonzeros = None
    if model.lowering != "instances":  # those are derived once for each kind of body, and never written out
        terms = len(built.equations.terms)
        nonzeros = None if model.lowering == "loops" else sum(entry != 0 for entry in built.equations.mass)
    sizes: dict[str, tuple[int | None, ...]] = {
        "derive": (terms, None, nonzeros),
        "lower": (None, model.kernel("mass_force").operations, model.pattern("mass", "M").full_nnz),
    }
    for name, seconds in built.seconds.items():
        yield {"name": name, "seconds": seconds, **dict(zip(SIZES, sizes.get(name, (None,) * 3), strict=True))}


def _plain(built: Built, path: Path, out: Path) -> dict[str, object]:
    return {
        "name": built.model.name,
        "doc": built.model.doc,
        "lowering": built.model.lowering,
        "notes": list(build_notes(built, path)),
        "stages": list(_stages(built)),
        "operations": {kernel.name: kernel.operations for kernel in built.model.kernels},
        "nonzeros": built.model.pattern("mass", "M").full_nnz,
        "files": [str(out / file.path) for file in built.files],
    }
