"""The files of the gallery: pages with their pictures and sources, and complete pages, which Sphinx does not read."""

from __future__ import annotations

from pathlib import Path

from docs.gallery.entries import ROOT
from docs.gallery.pages import example_page, file_name, index_page
from docs.gallery.runs import Run

Files = dict[str, bytes]


def gallery_files(runs: list[Run]) -> tuple[Files, Files]:
    """The sources of the pages with all that they show, and the players and reports, by their names."""
    sources: Files = {"index.md": index_page(runs).encode()}
    extra: Files = {}
    for run in runs:
        sources[f"{run.entry.name}.md"] = example_page(run).encode()
        for path in (run.entry.path, *run.entry.shown):
            sources[Path(path).name] = (ROOT / path).read_bytes()
        drawing = run.file("drawing")
        shapes = [path for path, _ in run.shapes]
        for path in [*run.pictures, *shapes, *([drawing] if drawing else [])]:
            sources[file_name(run, path)] = path.read_bytes()
        for kind in ("motion", "report", "drawing"):
            if path := run.file(kind):
                extra[file_name(run, path)] = path.read_bytes()
    return sources, extra


def write(files: Files, folder: Path) -> None:
    """Make a folder hold these files and no others; those that are equal already stay as they are."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.iterdir():
        if old.name not in files:
            old.unlink()
    for name, content in files.items():
        file = folder / name
        if not file.exists() or file.read_bytes() != content:
            file.write_bytes(content)
