"""The layout of the descriptor has a number; hosts that were compiled for another layout would call wrong functions."""

from __future__ import annotations

import hashlib
import re

from derive.backends.c.source import ABI
from derive.rendering import render
from derive.roles import Role

LAYOUT = (10, "37e8c59cefe3dfd3e728e64df2f603c17a3e6c8c9e71a3958b4f86d05c3ac967")
"""The number of the interface, and the SHA-256 of the descriptor's declarations without comments."""


def layout_digest() -> str:
    """The digest of the declarations with single spaces, and without the number itself."""
    text = render("c/descriptor.h.jinja", {"abi": "N", "roles": Role})
    words = " ".join(re.sub(r"/\*.*?\*/", " ", text, flags=re.DOTALL).split())
    return hashlib.sha256(words.encode()).hexdigest()


def test_another_layout_has_another_number() -> None:
    """If this fails: raise ABI in derive/backends/c/source.py, and write the new pair here."""
    number, digest = LAYOUT
    now = layout_digest()
    if now != digest:
        assert number != ABI, f"the layout of the descriptor has changed, and its number has not: raise ABI from {ABI}"
    assert (ABI, now) == LAYOUT, "write the new number and digest here"
