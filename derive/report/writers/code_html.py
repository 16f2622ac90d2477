"""Code as HTML: numbered lines with anchors, comments in a quiet colour, and links to what they compute."""

from __future__ import annotations

from html import escape

from derive.report.document.anchors import address
from derive.report.document.code_comments import comments, gaps
from derive.report.document.page import CodeLine, Hyperlink, Listing


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
