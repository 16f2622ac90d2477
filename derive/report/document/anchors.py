"""The anchors of a page and the links that lead to them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from derive.report.document.page import (
    Block,
    Columns,
    Details,
    EquationBlock,
    Heading,
    Hyperlink,
    Listing,
    Page,
    Paragraph,
    TableBlock,
)


def targets(page: Page) -> dict[str, str]:
    """A short name for each anchor of the page; a summand has that of its equation, to which links can lead."""
    names: dict[str, str] = {}
    for k, anchors in enumerate(_anchors(page.blocks), 1):
        names |= {anchor: f"at-{k}" for anchor in anchors if anchor and anchor not in names}
    return names


def _anchors(blocks: Sequence[Block]) -> Iterator[tuple[str, ...]]:
    """The anchors of each heading, equation and line of code."""
    for block in blocks:
        match block:
            case Heading():
                yield (block.anchor,)
            case EquationBlock(rows):
                for equation in rows:
                    yield (equation.anchor, *(part.anchor for part in equation.parts))
            case Listing():
                for line in block.lines:
                    yield (line.anchor,)
            case Details():
                yield from _anchors(block.blocks)
            case Columns(columns):
                for column in columns:
                    yield from _anchors(column)


def faults(page: Page) -> tuple[str, ...]:
    """The faults in the links of a page: duplicate anchors, and links to missing anchors."""
    result, seen = [], set()
    for anchors in _anchors(page.blocks):
        for anchor in filter(None, anchors):
            result += [f"the anchor {anchor!r} comes twice"] if anchor in seen else []
            seen.add(anchor)
    return (*result, *(f"nothing has the anchor {to[1:]!r}" for to in _links(page.blocks) if to[1:] not in seen))


def linked(page: Page) -> frozenset[str]:
    """The anchors that links of the page lead to."""
    return frozenset(to[1:] for to in _links(page.blocks))


def _links(blocks: Sequence[Block]) -> Iterator[str]:
    """The targets of the links of blocks that lead within the page."""
    return (to for to in _all_links(blocks) if to.startswith("#"))


def _all_links(blocks: Sequence[Block]) -> Iterator[str]:
    for block in blocks:
        match block:
            case Paragraph(words):
                yield from (item.to for item in words if isinstance(item, Hyperlink))
            case EquationBlock(rows):
                yield from (part.to for equation in rows for part in equation.parts)
            case TableBlock():
                texts = (*block.head, *(cell.text for row in block.rows for cell in row))
                yield from (item.to for text in texts for item in text if isinstance(item, Hyperlink))
            case Listing():
                yield from (link.to for line in block.lines for link in line.links)
            case Details():
                yield from _all_links(block.blocks)
            case Columns(columns):
                for column in columns:
                    yield from _all_links(column)


def address(to: str) -> str:
    """An address that a link may lead to: within the page, beside it, or on the web. Raises ValueError of others."""
    kind, colon, _ = to.partition(":")
    if colon and not to.startswith("#") and kind.lower() not in ("http", "https", "mailto"):
        raise ValueError(f"a link leads to {to!r}")
    return to


def anchor(*names: str) -> str:
    """An anchor made of names."""
    return "-".join(re.sub(r"[^A-Za-z0-9_.]+", "-", name) for name in names)
