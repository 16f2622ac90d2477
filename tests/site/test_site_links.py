"""All links of the site lead somewhere, and nothing is loaded from elsewhere."""

from __future__ import annotations

from copy import copy
from pathlib import PurePosixPath
from posixpath import join, normpath
from urllib.parse import unquote, urlsplit

import pytest
from bs4 import Tag
from built_site import PAGES, SITE, anchors, document, missing

import derive
from conftest import ROOT
from derive.cli.arguments.command_line import parser
from website.command_page import commands
from website.pages import pages

pytestmark = pytest.mark.docs

LOADED = {
    "img": "src",
    "script": "src",
    "link": "href",
    "iframe": "src",
    "video": "src",
    "source": "src",
    "use": "href",
}
"""The elements that load a file, with the attribute that has its address."""


def target(page: str, address: str) -> tuple[str, str]:
    """The file below the site and the anchor that an address on a page means."""
    parts = urlsplit(address)
    assert not parts.scheme and not parts.netloc, address
    path = normpath(join(PurePosixPath(page).parent, unquote(parts.path))) if parts.path else page
    return path, unquote(parts.fragment)


def test_there_is_a_site() -> None:
    if not PAGES:
        missing("there is no site: make docs")
    assert {"index.html", "search.html", "theory.html", "benchmarks.html"} <= set(PAGES)


def test_every_page_of_the_repository_is_in_the_site() -> None:
    for page in pages().values():
        if page != "README.md":
            assert str(PurePosixPath(page).with_suffix(".html")) in PAGES


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_to_files_and_anchors(page: str) -> None:
    links = [str(link["href"]) for link in document(page).find_all("a", href=True) if isinstance(link, Tag)]
    for link in links:
        if link.startswith(("https:", "http:", "mailto:")):
            assert urlsplit(link).netloc or link.startswith("mailto:"), link
            continue
        path, anchor = target(page, link)
        assert (SITE / path).is_file(), link
        if anchor and path.endswith(".html"):
            assert anchor in anchors(path), link


@pytest.mark.parametrize("page", PAGES)
def test_nothing_is_loaded_from_elsewhere(page: str) -> None:
    for name, attribute in LOADED.items():
        for element in document(page).find_all(name):
            address = str(element.get(attribute) or "")
            if address and not address.startswith(("data:", "#")):
                path, _ = target(page, address)
                assert (SITE / path).is_file(), address


@pytest.mark.parametrize("page", PAGES)
def test_pictures_have_words(page: str) -> None:
    """A picture has a description, or it is part of a link whose text says more."""
    for picture in document(page).find_all("img"):
        link = picture.find_parent("a")
        assert picture.get("alt") or (picture.has_attr("alt") and link and link.get_text(strip=True)), picture


def test_every_page_is_reached_from_the_start() -> None:
    reached, waiting = {"index.html"}, ["index.html"]
    while waiting:
        page = waiting.pop()
        for link in document(page).find_all("a", href=True):
            if not str(link["href"]).startswith(("https:", "http:", "mailto:")):
                path, _ = target(page, str(link["href"]))
                if path.endswith(".html") and path not in reached:
                    reached.add(path)
                    waiting.append(path)
    assert set(PAGES) - reached <= {"search.html", "genindex.html", "py-modindex.html"}


@pytest.mark.parametrize("page", PAGES)
def test_formulas_are_formulas(page: str) -> None:
    """No command of LaTeX is left in the text, and none in a formula."""
    text = copy(document(page))
    assert not text.select(".formula merror, math merror")
    assert not [part for part in text.find_all(["mi", "mo", "mtext"]) if "\\" in part.get_text()]
    for code in text.find_all(["pre", "code", "script", "annotation"]):
        code.extract()
    assert "$$" not in text.get_text() and "\\mathbf" not in text.get_text()


def test_theory_has_its_formulas() -> None:
    formulas = (ROOT / "docs/theory.md").read_text(encoding="utf-8").count("$$") // 2
    assert formulas > 10 and len(document("theory.html").select(".formula math")) == formulas


def test_the_reference_has_every_public_name() -> None:
    pages = [page for page in PAGES if page.startswith("api/") and page != "api/index.html"]
    places = [anchor for page in pages for anchor in anchors(page) if anchor.count(".") == 1]
    assert sorted(places) == sorted(f"derive.{name}" for name in derive.__all__)
    assert {link.get_text() for link in document("api/index.html").select("table a")} == {*derive.__all__}


def test_the_reference_has_every_command_and_option() -> None:
    text = document("command_line.html")
    headings = {heading.get_text().rstrip("¶") for heading in text.find_all("h2")}
    options = {term.get_text().split()[0] for term in text.select("dt code")}
    for name, command, _ in commands(parser()):
        assert name in headings
        assert {option for action in command._actions for option in action.option_strings[:1]} - {"-h"} <= options
