"""The site as `make docs` has built it, which these tests look at."""

from __future__ import annotations

import os
from functools import cache

import pytest
from bs4 import BeautifulSoup

from conftest import ROOT

SITE = ROOT / "site"
PAGES = sorted(file.relative_to(SITE).as_posix() for file in SITE.rglob("*.html") if "_static" not in file.parts)


def missing(what: str) -> None:
    """Skip a test, or fail in CI, because of what is missing."""
    if os.environ.get("CI"):
        pytest.fail(what, pytrace=False)
    pytest.skip(what)


@cache
def document(page: str) -> BeautifulSoup:
    """A page as it is on disk."""
    return BeautifulSoup((SITE / page).read_text(encoding="utf-8"), "html.parser")


@cache
def anchors(page: str) -> frozenset[str]:
    """The places of a page that a link may lead to."""
    return frozenset(str(element["id"]) for element in document(page).find_all(id=True))
