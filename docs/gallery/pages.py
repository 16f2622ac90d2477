"""The pages of the gallery in Markdown: one for each example, and the index with a card for each."""

from __future__ import annotations

import re
from pathlib import Path

from derive.report.sections.beam_shapes import UNIT
from docs.gallery.entries import GROUPS, PAGES, ROOT
from docs.gallery.runs import Run
from docs.gallery.sources import described

LANGUAGES = {".py": "python", ".toml": "toml", ".c": "c"}
CARD_LINES, CARD_COLUMNS = 9, 44
"""The part of a text that a card shows."""
INTRODUCTION = """\
# Gallery

Each example has a page with its picture or its motion, the number that it computes, and its source. These pages are
made by running the examples.
"""


def literal(text: str) -> str:
    """A text in Markdown in which no character has a meaning, apart from code between backticks."""
    parts = re.split(r"(`[^`]+`)", text)
    return "".join(part if part.startswith("`") else re.sub(r"([\\*_\[\]<>$|#^~])", r"\\\1", part) for part in parts)


def code(text: str, language: str = "text") -> str:
    """A block of code."""
    return f"`````{language}\n{text.rstrip()}\n`````"


def example_page(run: Run) -> str:
    """The page of an example."""
    entry, description = run.entry, described(run.entry)
    blocks = [f"# {literal(description.title)}"]
    blocks += [part if part.startswith("    ") else literal(part) for part in description.paragraphs]
    if run.data is None:
        blocks.append(f"The example needs the package `{entry.needs}`, which was missing when this page was made.")
    if run.numbers:
        blocks += _number_block(run, description.number)
    pictures = [f"![{literal(_alt(run, path))}]({file_name(run, path)})" for path in run.pictures]
    motion = _motion(run)
    if entry.kind == "toml":  # a scene is there for its motion, a script for its picture
        blocks += [*motion, *(["## Curves"] if motion and pictures else []), *pictures]
    else:
        blocks += [*pictures, *motion]
    if run.shapes:
        blocks += ["## Shape functions", literal(UNIT)]
        blocks += [f"![{literal(alt)}]({file_name(run, path)})" for path, alt in run.shapes]
    if report := run.file("report"):
        text = "The report: every equation, term and zero, and the line of C that computes it"
        blocks += ["## Report", _html(_link(file_name(run, report), text))]
    if run.output:
        blocks += ["## Output", code(run.output)]
    blocks += ["## Source", *(block for path in (entry.path, *entry.shown) for block in _source(path))]
    blocks += ["## Run it", code("\n".join(map(" ".join, entry.commands_in_sh(bool(run.pictures)))), "sh")]
    if run.data:
        blocks.append(f"It takes {run.seconds:.1f} s of processor time.")
    return "\n\n".join(blocks) + "\n"


def index_page(runs: list[Run]) -> str:
    """The page with a card for each example, in groups."""
    by_entry = {run.entry: run for run in runs}
    blocks = [INTRODUCTION, *_own_pages(runs)]
    for group in GROUPS:
        shown = [by_entry[entry] for entry in group.entries if entry in by_entry]
        if shown:
            cards = "\n".join(map(_card, shown))
            blocks += [f"## {group.title}", group.text, f"````````{{container}} gallery-cards\n{cards}\n````````"]
    names = "\n".join(run.entry.name for run in runs)
    return "\n\n".join([*blocks, f"```{{toctree}}\n:hidden:\n\n{names}\n```"]) + "\n"


def _own_pages(runs: list[Run]) -> list[str]:
    """Cards of the reports and the players that are pages of their own."""
    by_name = {run.entry.name: run for run in runs}
    cards = []
    for name, kind, title in PAGES:
        run = by_name.get(name)
        path, drawing = (run.file(kind), run.file("drawing")) if run else (None, None)
        if run and path and drawing:
            image = f'<img alt="Drawing:" src="{file_name(run, drawing)}">'
            link = f'<a class="reference" href="{file_name(run, path)}">{image} {title}</a>'
            cards.append(f'<div class="gallery-card"><p>{link}</p></div>')
    text = "`tisserand report` and `tisserand simulate` write pages that need nothing but a browser."
    html = "\n".join(['<div class="gallery-cards">', *cards, "</div>"])
    return ["## Reports and players", text, _html(html)] if cards else []


def _card(run: Run) -> str:
    """The card of an example: a link with a picture, or with its number or its text."""
    description, target = described(run.entry), f"{run.entry.name}.md"
    shows = run.entry.card or _card_kind(run)
    title, front = literal(description.title), ""
    if shows == "picture":
        front = f"![Picture:]({file_name(run, run.pictures[0])}) "
    elif shows == "drawing":
        drawing = run.file("drawing")
        assert drawing is not None, run.entry.path
        front = f"![Drawing:]({file_name(run, drawing)}) "
    elif shows == "number" and run.numbers:
        front = f"**{', '.join(text for _, text in run.numbers)}** "
    body = f"[{front}{title}]({target})"
    if shows == "output":
        lines = (run.output or (ROOT / run.entry.path).read_text()).splitlines()[:CARD_LINES]
        body = code("\n".join(line[:CARD_COLUMNS] for line in lines)) + "\n\n" + body
    return f"```````{{container}} gallery-card\n{body}\n```````"


def _card_kind(run: Run) -> str:
    kinds = {"picture": run.pictures, "drawing": run.file("drawing"), "number": run.numbers}
    return next((kind for kind, there in kinds.items() if there), "output")


def _number_block(run: Run, meaning: str) -> list[str]:
    """The numbers in large letters, and what they are."""
    lines = [f"{literal(label)}: **{text}**" if label else f"**{text}**" for label, text in run.numbers]
    text = "\n\n".join([*lines, literal(meaning[:1].upper() + meaning[1:]) + "."])
    return [f"```{{container}} gallery-number\n{text}\n```"]


FITTING = """<script>
addEventListener("message", ({ source, data }) => {
  for (const frame of document.querySelectorAll(".gallery-motion"))
    if (frame.contentWindow === source && data.height > 0) frame.style.height = `${data.height + 2}px`;
});
</script>"""
"""Gives a player the height of its content and two borders; it sends the height, also from a file on a disk."""


def _motion(run: Run) -> list[str]:
    """The player inside the page, and a link to it."""
    motion = run.file("motion")
    if motion is None:
        return []
    address = file_name(run, motion)
    frame = f'<iframe class="gallery-motion" src="{address}" title="Player of the motion" loading="lazy"></iframe>'
    return ["## Motion", _html(FITTING), _html(frame), _html(_link(address, "The player on a page of its own"))]


def _source(path: str) -> list[str]:
    name = Path(path).name
    text = (ROOT / path).read_text(encoding="utf-8")
    return [f"{{download}}`{name} <{name}>`", code(text, LANGUAGES[Path(path).suffix])]


def _alt(run: Run, path: Path) -> str:
    title = described(run.entry).title
    return title if path.stem == run.entry.name else f"{title}: {path.stem.replace('_', ' ')}"


def file_name(run: Run, path: Path) -> str:
    """The name of a file of a run in the gallery, which has the files of all runs."""
    return path.name if path.stem == run.entry.name else f"{run.entry.name}.{path.name}"


def _html(text: str) -> str:
    return f"```{{raw}} html\n{text}\n```"


def _link(address: str, text: str) -> str:
    return f'<p><a class="reference" href="{address}">{text}</a></p>'
