"""Title, text and number of an example, as its source states them."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass

from docs.gallery.entries import ROOT, Entry


@dataclass(frozen=True)
class Description:
    """The title, the paragraphs below it, and the meaning of the number, "" if there is none."""

    title: str
    paragraphs: tuple[str, ...]
    number: str = ""


def described(entry: Entry) -> Description:
    """The description of an example: the docstring of a script, the first comment of a scene or a C program.

    The title is the first line of a docstring; of a comment the first sentence, up to its colon. The meaning of the
    number is the docstring of `main` without "Return". Raises ValueError where a source has no description.
    """
    text = (ROOT / entry.path).read_text(encoding="utf-8")
    if entry.kind == "py":
        return _of_script(text, entry.path)
    comment = _toml_comment(text) if entry.kind == "toml" else _c_comment(text)
    first, *others = _paragraphs(comment)
    found = re.match(r"(.+?)(?::|\.(?=\s|$))\s*(.*)", first, re.DOTALL)
    if not found:
        raise ValueError(f"{entry.path}: the first comment has no sentence that is a title")
    rest = found[2][:1].upper() + found[2][1:]
    return Description(found[1], tuple(filter(None, [rest, *others])))


def _of_script(text: str, path: str) -> Description:
    module = ast.parse(text)
    docstring = ast.get_docstring(module)
    mains = [node for node in module.body if isinstance(node, ast.FunctionDef) and node.name == "main"]
    if not docstring or not mains:
        raise ValueError(f"{path}: a docstring and a function `main` are expected")
    title, *others = _paragraphs(docstring)
    meaning = (ast.get_docstring(mains[0]) or "").split("\n\n")[0].removeprefix("Return ")
    return Description(title.removesuffix("."), tuple(others), " ".join(meaning.split()).removesuffix("."))


def _paragraphs(text: str) -> list[str]:
    """The paragraphs of a text, each on one line, in which indented lines stay as they are."""
    return [
        part if part.startswith("    ") else " ".join(part.split()) for part in re.split(r"\n\s*\n", text.strip("\n"))
    ]


def _toml_comment(text: str) -> str:
    """The comment at the beginning of a TOML file, without the line that names its schema."""
    lines = []
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        if not line.startswith("#:"):
            lines.append(line.removeprefix("#").removeprefix(" "))
    return "\n".join(lines)


def _c_comment(text: str) -> str:
    """The comment at the beginning of a C file."""
    inside = text.partition("/*")[2].partition("*/")[0]
    return "\n".join(line.removeprefix(" *").removeprefix(" ") for line in inside.splitlines())
