"""`tisserand check`: compare the generated files with the ones that the specifications give now.

Of a model whose folder holds its manifest alone, the texts are compared by the hashes that are in the manifest.
"""

from __future__ import annotations

import argparse
import shlex
import sys
from collections.abc import Sequence
from difflib import unified_diff
from pathlib import Path, PurePosixPath

from derive.artifacts import MARK, File, settle
from derive.cli.specifications import build_all

MAX_LINES = 60
"""The largest number of lines of a difference that are printed."""


def run(options: argparse.Namespace) -> int:
    """Regenerate all files in memory and print the differences; return 1 if there are any."""
    if not options.scenes.exists():
        print(
            f"{options.scenes}: there is no such folder or file here; change to the folder that holds it, or name the "
            "specifications and the generated files: tisserand check SCENES --out GENERATED",
            file=sys.stderr,
        )
        return 2
    specs = sorted(options.scenes.glob("*.toml")) if options.scenes.is_dir() else [options.scenes]
    if not specs:
        print(f"{options.scenes}: this folder holds no specification (*.toml); name another one", file=sys.stderr)
        return 2
    built = build_all(specs)
    files = [file for model in built for file in model.files]
    settle(options.out)
    hashed = [file for model in built for file in _by_hash(model.files, options.out)]
    reports = [report for file in files if file not in hashed and (report := _difference(file, options.out))]
    if options.scenes.is_dir():
        reports += _obsolete(files, options.out)
    if reports:
        print("\n".join(reports))
        accept = shlex.join(["tisserand", "build", *map(str, specs), "--out", str(options.out)])
        print(f"\nto accept these differences: {accept}")
        return 1
    hashes = f", {len(hashed)} of them by the hashes in their manifests" if hashed else ""
    print(f"{len(files)} generated files are up to date{hashes}")
    return 0


def _by_hash(files: Sequence[File], out: Path) -> list[File]:
    """The files of a model that the comparison of its manifest covers, since the folder holds nothing else of it."""
    texts = [file for file in files if PurePosixPath(file.path).name != "manifest.json"]
    present = {file.path for file in files if (out / file.path).exists()}
    return texts if present and present.isdisjoint(file.path for file in texts) else []


def _difference(file: File, out: Path) -> str:
    path = out / file.path
    if not path.exists():
        return f"{path}: missing"
    if path.read_bytes() == file.text.encode():
        return ""
    present = path.read_text(encoding="utf-8", errors="replace")
    diff = unified_diff(present.splitlines(), file.text.splitlines(), str(path), f"{path} (regenerated)", lineterm="")
    lines = list(diff)
    rest = [f"... {len(lines) - MAX_LINES} more lines"] if len(lines) > MAX_LINES else []
    return "\n".join([*lines[:MAX_LINES], *rest])


def _obsolete(files: list[File], out: Path) -> list[str]:
    """Report generated files that no specification gives any more."""
    expected = {out / file.path for file in files}
    present = sorted(path for path in out.rglob("*") if path.is_file() and path not in expected)
    marked = (path for path in present if MARK.encode() in path.read_bytes()[:1000])
    return [f"{path}: no specification gives this file; remove it by hand" for path in marked]
