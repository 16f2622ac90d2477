"""`tisserand check`: what lies in the output folder is what the specifications give."""

from __future__ import annotations

import argparse
import shlex
import sys
from difflib import unified_diff
from pathlib import Path

from derive.artifacts import MARK, File
from derive.cli.build import build_all

MOST_LINES = 60


def run(options: argparse.Namespace) -> int:
    """Regenerate in memory, compare, print a diff of what differs; 1 if anything does."""
    specs = sorted(options.scenes.glob("*.toml")) if options.scenes.is_dir() else [options.scenes]
    if not specs:
        print(f"{options.scenes}: there is no specification (*.toml) here", file=sys.stderr)
        return 2
    files = [file for built in build_all(specs) for file in built.files]
    reports = [report for file in files if (report := _difference(file, options.out))]
    if options.scenes.is_dir():
        reports += _strays(files, options.out)
    if reports:
        print("\n".join(reports))
        accept = shlex.join(["tisserand", "build", *map(str, specs), "--out", str(options.out)])
        print(f"\nto accept: {accept}")
        return 1
    print(f"{len(files)} generated files are up to date")
    return 0


def _difference(file: File, out: Path) -> str:
    path = out / file.path
    if not path.exists():
        return f"{path}: missing"
    if path.read_bytes() == file.text.encode():
        return ""
    found = path.read_text(encoding="utf-8", errors="replace")
    diff = unified_diff(found.splitlines(), file.text.splitlines(), str(path), f"{path} (regenerated)", lineterm="")
    lines = list(diff)
    cut = [f"... {len(lines) - MOST_LINES} more lines"] if len(lines) > MOST_LINES else []
    return "\n".join([*lines[:MOST_LINES], *cut])


def _strays(files: list[File], out: Path) -> list[str]:
    """Generated files that no specification makes any more."""
    expected = {out / file.path for file in files}
    present = sorted(path for path in out.rglob("*") if path.is_file() and path not in expected)
    marked = (path for path in present if MARK.encode() in path.read_bytes()[:1000])
    return [f"{path}: no specification makes this file; remove it by hand" for path in marked]
