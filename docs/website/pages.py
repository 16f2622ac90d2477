"""Where a file of the repository is in the site."""

from __future__ import annotations

from pathlib import Path, PurePosixPath

ROOT = Path(__file__).parent.parent.parent

NAMES = {
    "README.md": "README.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
    "CODE_OF_CONDUCT.md": "code_of_conduct.md",
    "SECURITY.md": "security.md",
    "bench/README.md": "benchmarks.md",
    "examples/README.md": "examples.md",
}
"""The pages outside docs/, by their paths in the repository; those that do not exist are left out."""

SHOWN = {".py": "python", ".toml": "toml", ".c": "c", ".h": "c", ".cff": "yaml", ".json": "json", ".csv": "text"}
"""The languages of files that have a page of their own, by their endings; other files are downloads."""

LONGEST_SHOWN = 30_000
"""Bytes of the longest file that has a page of its own."""


def pages(root: Path = ROOT) -> dict[str, str]:
    """The pages of the repository: the path of each in the site, by its path in the repository."""
    result = {source: page for source, page in NAMES.items() if (root / source).exists()}
    docs = root / "docs"
    for file in sorted([*docs.rglob("*.md"), *docs.rglob("*.ipynb")]):
        result[file.relative_to(root).as_posix()] = file.relative_to(docs).as_posix()
    return result


def is_shown(file: Path) -> bool:
    """Whether a file that pages link to has a page of its own."""
    return file.suffix in SHOWN and file.stat().st_size <= LONGEST_SHOWN


def place(path: str, root: Path = ROOT) -> str:
    """The path in the site of a file or folder of the repository; FileNotFoundError if there is none.

    A folder is represented by the page made of its README. A file that is no page is below `files/`, and has a page
    of its own there if it `is_shown`.
    """
    file = root / path
    if not file.exists():
        raise FileNotFoundError(path)
    if file.is_dir():
        return place(str(PurePosixPath(path) / "README.md"), root)
    if path == "README.md":
        return "index.md"
    if path in (known := pages(root)):
        return known[path]
    inside = PurePosixPath(path)
    if inside.parts[0] == "docs" and inside.suffix == ".svg":
        return str(inside.relative_to("docs"))
    return f"files/{path}.md" if is_shown(file) else f"files/{path}"
