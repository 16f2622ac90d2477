"""`tisserand build`: generate the files of specifications and print a table of the stages."""

from __future__ import annotations

import argparse
import json
import re
from dataclasses import asdict
from pathlib import Path

from derive.artifacts import write
from derive.errors import Problem, SpecError
from derive.pipeline import Built, Stage, build
from derive.terminal import show


def run(options: argparse.Namespace) -> int:
    """Build all specifications, then write all files; an error in any specification prevents all writing."""
    built = build_all(options.specs)
    files = [file for b in built for file in b.files]
    write(files, options.out)
    if options.json:
        print(json.dumps([_plain(b, options.out) for b in built], indent=2))
    else:
        print("\n\n".join(_table(b, options.out) for b in built))
    return 0


def build_all(paths: list[Path]) -> list[Built]:
    """Build every specification.

    Raises SpecError with the problems of all files, also when two models would have the same name in C.
    """
    built: list[Built] = []
    errors: list[SpecError] = []
    paths_by_name: dict[str, Path] = {}
    for path in dict.fromkeys(paths):
        show(f"building {path} ...")
        try:
            result = build(path)
        except SpecError as error:
            errors.append(error)
            continue
        if conflict := _name_conflict(result.model.name, paths_by_name):
            errors.append(SpecError((Problem("name", conflict),), str(path)))
        paths_by_name[result.model.name] = path
        built.append(result)
    show()
    if errors:
        raise errors[0] if len(errors) == 1 else ManyErrors(errors)
    return built


def _name_conflict(name: str, paths_by_name: dict[str, Path]) -> str:
    """Return why a model cannot have this name beside the other models; empty if it can."""
    for other, path in paths_by_name.items():
        if name.lower() == other.lower():
            return f"the name {name!r} is taken by {path}; choose a name that differs in more than case"
        short, long = sorted((name.lower(), other.lower()), key=len)
        if re.match(rf"{short}_(marker|pattern|table|colptr|rowidx|sparsity|p|k|nnz)(_|$)", long):
            return f"the names {name!r} and {other!r} of {path} make the same names in C; choose another name"
    return ""


class ManyErrors(SpecError):
    """The errors of several specifications."""

    def __init__(self, errors: list[SpecError]) -> None:
        super().__init__(tuple(p for e in errors for p in e.problems), None)
        self.errors = errors

    def __str__(self) -> str:
        return "\n".join(map(str, self.errors))


def _table(built: Built, out: Path) -> str:
    mass = built.model.pattern("mass", "M")
    rows = [["stage", "seconds", "terms", "operations", "non-zeros"], *map(_row, built.stages)]
    widths = [max(len(row[column]) for row in rows) for column in range(5)]
    lines = [
        "  ".join(
            cell.ljust(width) if column == 0 else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]
    setup = built.model.kernel("setup").operations
    return "\n".join(
        [
            f"{built.model.name}: {built.model.doc}",
            *(f"  {note}" for note in built.notes),
            *(f"  {line}" for line in lines),
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
