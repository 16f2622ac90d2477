"""Listings of code: gaps between their lines, their comments, and as HTML with anchors and links."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from derive.report.document.anchors import address
from derive.report.document.page import CodeLine, Hyperlink, Listing

COMMENTS = {"c": "//", "python": "#", "toml": "#", "sh": "#"}


def gaps(lines: Sequence[CodeLine]) -> list[bool]:
    """Whether lines were left out before each line of code."""
    return [k > 0 and line.number != lines[k - 1].number + 1 for k, line in enumerate(lines)]


def comments(listing: Listing) -> list[tuple[int, int]]:
    """The start and the end of the comment of each line."""
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


def listing_html(listing: Listing) -> str:
    """A listing with its caption. Numbers are no text, so that copied code is code alone."""
    comment = comments(listing)
    lines = "".join(
        _line(line, start, last) for line, start, last in zip(listing.lines, comment, gaps(listing.lines), strict=True)
    )
    caption = f"<figcaption>{escape(listing.caption)}</figcaption>" if listing.caption else ""
    label = escape(listing.caption or listing.language)
    return (
        f'<figure class="code">{caption}<pre tabindex="0" role="region" aria-label="{label}">'
        f"<code>{lines}</code></pre></figure>"
    )


def _line(line: CodeLine, comment: tuple[int, int], gap: bool) -> str:
    anchor = f' id="{escape(line.anchor)}"' if line.anchor else ""
    kind = ' class="gap"' if gap else ""
    start, stop = comment
    before, inner, after = line.text[:start], line.text[start:stop], line.text[stop:]
    shown = f"{escape(before)}<i>{escape(inner)}</i>{escape(after)}" if inner.strip() else escape(line.text)
    links = "".join(_link(item) for item in line.links)
    return f'<span{anchor}{kind} data-n="{line.number}">{shown}{links}\n</span>'


def _link(link: Hyperlink) -> str:
    return f' <a href="{escape(address(link.to))}">{escape(link.text)}</a>'


def _c_comment(text: str, within: bool) -> tuple[int, int, bool]:
    """The start and the end of the first comment of a line of C, and whether it goes on in the next line."""
    start = 0 if within else min((k for k in (text.find("/*"), text.find("//")) if k >= 0), default=len(text))
    if not within and text[start : start + 2] == "//":
        return start, len(text), False
    end = text.find("*/", start if within else start + 2)
    open_ = (within or text[start : start + 2] == "/*") and end < 0
    return start, len(text) if end < 0 else end + 2, open_


def _hash(text: str) -> int:
    """The start of a comment: the first # outside of quotation marks."""
    quote = ""
    for k, c in enumerate(text):
        if quote:
            quote = "" if c == quote else quote
        elif c in "\"'":
            quote = c
        elif c == "#":
            return k
    return len(text)
