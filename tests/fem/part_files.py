"""The files of the bracket that CalculiX 2.20 wrote: three quadratic bricks, `scenes/make_bracket.py` with 1 1 1."""

from __future__ import annotations

import zipfile
from pathlib import Path


def bracket_files(folder: Path, **changed: str) -> Path:
    """Write the files of the job, some of them with another content by their suffixes, and return its input."""
    with zipfile.ZipFile(Path(__file__).parent / "bracket.zip") as archive:
        archive.extractall(folder)
    for suffix, text in changed.items():
        (folder / f"bracket.{suffix}").write_text(text)
    return folder / "bracket.inp"


def text_of(suffix: str) -> str:
    """The content of one of the files."""
    with zipfile.ZipFile(Path(__file__).parent / "bracket.zip") as archive:
        return archive.read(f"bracket.{suffix}").decode()


def job(folder: Path, text: str, entries: tuple[list[str], list[str], list[str]]) -> Path:
    """Write a job by its input and the lines of its .dof, .sti and .mas, and return its input."""
    for suffix, of_file in zip(("dof", "sti", "mas"), entries, strict=True):
        (folder / f"part.{suffix}").write_text("\n".join(of_file) + "\n")
    (folder / "part.inp").write_text(text)
    return folder / "part.inp"
