"""Where the comments of code are, and where lines of it were left out."""

from __future__ import annotations

from collections.abc import Sequence

from derive.report.document.page import CodeLine, Listing

COMMENTS = {"c": "//", "python": "#", "toml": "#", "sh": "#"}


def gaps(lines: Sequence[CodeLine]) -> list[bool]:
    """Whether lines were left out before each line."""
    return [k > 0 and line.number != lines[k - 1].number + 1 for k, line in enumerate(lines)]


def comments(listing: Listing) -> list[tuple[int, int]]:
    """Where the comment of each line starts and stops."""
    mark = COMMENTS.get(listing.language)
    result, within = [], False
    for line in listing.lines:
        if mark == "//":
            start, stop, within = _c_comment(line.text, within)
        else:
            start = _hash(line.text) if mark else len(line.text)
            stop = len(line.text)
        result.append((start, stop))
    return result


def _c_comment(text: str, within: bool) -> tuple[int, int, bool]:
    """Where the first comment of a line of C starts and stops, and whether it goes on in the next line."""
    start = 0 if within else min((k for k in (text.find("/*"), text.find("//")) if k >= 0), default=len(text))
    if not within and text[start : start + 2] == "//":
        return start, len(text), False
    end = text.find("*/", start if within else start + 2)
    open_ = (within or text[start : start + 2] == "/*") and end < 0
    return start, len(text) if end < 0 else end + 2, open_


def _hash(text: str) -> int:
    """Where a comment behind # starts: at the first one outside of quotation marks."""
    quote = ""
    for k, c in enumerate(text):
        if quote:
            quote = "" if c == quote else quote
        elif c in "\"'":
            quote = c
        elif c == "#":
            return k
    return len(text)
