"""Puts the sources of the site together: pages of the repository, files that they link to, and generated pages.

`python docs/website/assemble.py FOLDER` fills a folder, build/docs/source, from which Sphinx makes the site. Paths
there are those of the site: docs/X.md is X.md, and other pages have the names in `pages.py`. Files that are equal
already stay as they are, so that Sphinx builds again what has changed only.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path, PurePosixPath

if __name__ == "__main__":
    sys.path[:0] = [str(Path(__file__).parent.parent), str(Path(__file__).parent.parent.parent)]

from website.api_pages import pages as api_pages
from website.command_page import page as command_page
from website.first_example import with_output
from website.links import with_links
from website.navigation import toctrees
from website.pages import ROOT, SHOWN, is_shown, pages, place

GENERATED = ROOT / "build/docs/generated"
"""Pages that programs write before the site is assembled, such as gallery/; they are copied as they are."""


def source_page(path: str) -> str:
    """The Markdown of the page that shows a file of the repository."""
    file = ROOT / path
    text = file.read_text(encoding="utf-8")
    code = f"````{SHOWN[file.suffix]}\n{text}````"
    return f"---\norphan: true\n---\n\n# {file.name}\n\n[Download {path}](<{file.name}>)\n\n{code}\n"


def notebook(text: str, source: str, page: str) -> tuple[str, set[str]]:
    """A notebook whose Markdown has the links of the site, and the files that it links to."""
    cells = json.loads(text)
    linked: set[str] = set()
    for cell in cells["cells"]:
        if cell["cell_type"] == "markdown":
            markdown, files = with_links("".join(cell["source"]), source, page, place)
            cell["source"] = markdown.splitlines(keepends=True)
            linked |= files
    return json.dumps(cells, indent=1, ensure_ascii=False), linked


def site_files() -> dict[str, bytes]:
    """All files of the sources of the site by their paths."""
    result: dict[str, bytes] = {}
    linked: set[str] = set()
    known = pages()
    for source, page in known.items():
        convert = notebook if page.endswith(".ipynb") else lambda *arguments: with_links(*arguments, place)
        text, files = convert((ROOT / source).read_text(encoding="utf-8"), source, page)
        result[page] = text.encode()
        linked |= files
    for path in linked - set(known):
        if (ROOT / path).is_dir():
            continue
        content = (ROOT / path).read_bytes()
        target = place(path)
        if is_shown(ROOT / path):
            result[target] = source_page(path).encode()
        result[target.removesuffix(".md")] = content
    result |= {page: text.encode() for page, text in api_pages().items()}
    result["command_line.md"] = command_page().encode()
    if GENERATED.exists():
        for file in GENERATED.rglob("*"):
            if file.is_file():
                result[file.relative_to(GENERATED).as_posix()] = file.read_bytes()
    documents = [str(PurePosixPath(name).with_suffix("")) for name in result if name.endswith((".md", ".ipynb"))]
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    start = with_output(result["index.md"].decode(), readme, ROOT)
    result["index.md"] = (start + toctrees(documents)).encode()
    return result


def write(files: dict[str, bytes], folder: Path) -> None:
    """Make a folder hold these files and no others."""
    for old in [file for file in folder.rglob("*") if file.is_file()]:
        if old.relative_to(folder).as_posix() not in files:
            old.unlink()
    for name, content in files.items():
        file = folder / name
        if not file.exists() or file.read_bytes() != content:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)


if __name__ == "__main__":
    write(site_files(), Path(sys.argv[1]))
