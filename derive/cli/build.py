"""`tisserand build`: generate the files of specifications and print a table of the stages."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from derive.artifacts import write
from derive.cli.specifications import build_all
from derive.pipeline import Built, Stage
from derive.terminal import table


def run(options: argparse.Namespace) -> int:
    """Build all specifications, then write all files; an error in any specification prevents all writing."""
    built = build_all(options.specs, options.sensitivities)
    files = [file for b in built for file in b.files]
    write(files, options.out)
    if options.json:
        print(json.dumps([_plain(b, options.out) for b in built], indent=2))
    else:
        print("\n\n".join(_table(b, options.out) for b in built))
    return 0


def _table(built: Built, out: Path) -> str:
    mass = built.model.pattern("mass", "M")
    rows = [["stage", "seconds", "terms", "operations", "non-zeros"], *map(_row, built.stages)]
    setup = built.model.kernel("setup").operations
    return "\n".join(
        [
            f"{built.model.name}: {built.model.doc}",
            *(f"  {note}" for note in built.notes),
            *table(rows),
            f"  non-zeros: of the {mass.rows * mass.cols} entries of the mass matrix; operations: of one evaluation of",
            f"  mass matrix and forces together, after {setup} operations in setup, which depend on parameters alone",
            *(f"  wrote {out / file.path}" for file in built.files),
        ]
    )


def _row(stage: Stage) -> list[str]:
    counts = (stage.terms, stage.operations, stage.nonzeros)
    return [stage.name, f"{stage.seconds:.3f}", *("" if n is None else str(n) for n in counts)]


def _plain(built: Built, out: Path) -> dict[str, object]:
    return {
        "name": built.model.name,
        "doc": built.model.doc,
        "lowering": built.model.lowering,
        "notes": list(built.notes),
        "stages": [asdict(stage) for stage in built.stages],
        "operations": {kernel.name: kernel.operations for kernel in built.model.kernels},
        "nonzeros": built.model.pattern("mass", "M").full_nnz,
        "files": [str(out / file.path) for file in built.files],
    }
