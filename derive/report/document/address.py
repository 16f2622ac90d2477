"""Where a link may lead."""

from __future__ import annotations


def address(to: str) -> str:
    """An address that a link may lead to: within the page, beside it, or on the web. Raises ValueError of others."""
    kind, colon, _ = to.partition(":")
    if colon and not to.startswith("#") and kind.lower() not in ("http", "https", "mailto"):
        raise ValueError(f"a link leads to {to!r}")
    return to
