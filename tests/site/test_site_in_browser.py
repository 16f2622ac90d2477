"""Every page of the site in a browser, opened from disk: wide and narrow, light and dark."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from built_site import PAGES, SITE, missing

from browser import CHROMIUM

pytestmark = pytest.mark.docs

WIDE, NARROW = {"width": 1200, "height": 900}, {"width": 400, "height": 800}
LEVELS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
"""Rules of axe-core for levels A and AA of the Web Content Accessibility Guidelines."""


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    if CHROMIUM is None:
        missing("chromium is missing: apt-get install chromium")
    if find_spec("playwright") is None:
        missing("playwright is missing: make docs installs it")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as tool:
        yield tool.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])


@pytest.fixture(scope="session")
def axe() -> str:
    """The script of axe-core."""
    import axe_playwright_python

    return (Path(str(axe_playwright_python.__file__)).parent / "axe.min.js").read_text(encoding="utf-8")


@pytest.fixture
def tab(browser: Any) -> Iterator[Any]:
    """A tab of its own, which keeps nothing of other pages; `tab.faults` is what the console says."""
    context = browser.new_context(viewport=WIDE, color_scheme="light", reduced_motion="reduce")
    tab = context.new_page()
    tab.faults = []
    tab.on("console", lambda message: message.type in ("error", "warning") and tab.faults.append(message.text))
    tab.on("pageerror", lambda fault: tab.faults.append(str(fault)))
    tab.on("requestfailed", lambda request: tab.faults.append(request.url))
    yield tab
    context.close()


WIDTHS = "[document.scrollingElement, ...document.querySelectorAll('.content')].map(box => box.scrollWidth)"
"""The widths of the page, and of its text, which the theme would scroll on its own."""

STOP = """
    (element => {
        const style = getComputedStyle(element), box = element.getBoundingClientRect();
        return {
            tag: element.tagName, name: element.classList[0] ?? element.id,
            outline: style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 1,
            inside: box.left > -1 && box.left < innerWidth,
        };
    })(document.activeElement)
"""
"""Where the keyboard is: the element, whether an outline shows it, and whether it is in the window."""


def violations(tab: Any, rules: str) -> list[str]:
    """The findings of axe-core with these options, without frames, which are pages of their own: rule and element."""
    found = tab.evaluate(f"axe.run(document, {{resultTypes: ['violations'], preload: false, iframes: false, {rules}}})")
    return [f"{rule['id']}: {node['html'][:200]}" for rule in found["violations"] for node in rule["nodes"]]


NEXT_FRAMES = "new Promise(shown => requestAnimationFrame(() => requestAnimationFrame(() => shown(1))))"
"""Waits until the page has been drawn, and knows which of its boxes are wider than the window."""


@pytest.mark.parametrize("page", PAGES)
def test_page(page: str, tab: Any, axe: str) -> None:
    tab.goto((SITE / page).as_uri())
    assert tab.evaluate("[...document.images].filter(i => !(i.complete && i.naturalWidth)).map(i => i.src)") == []
    tab.evaluate(axe)
    tab.evaluate(NEXT_FRAMES)
    assert violations(tab, f"runOnly: {LEVELS}") == []
    tab.emulate_media(color_scheme="dark")
    assert violations(tab, "runOnly: ['color-contrast']") == []
    tab.set_viewport_size(NARROW)
    tab.evaluate(NEXT_FRAMES)
    assert tab.evaluate(WIDTHS) and max(tab.evaluate(WIDTHS)) <= 400
    assert violations(tab, f"runOnly: {LEVELS}, rules: {{'color-contrast': {{enabled: false}}}}") == []
    assert tab.faults == []


def test_search_from_disk(tab: Any) -> None:
    tab.goto((SITE / "index.html").as_uri())
    tab.fill("input[name=q]", "squeezing mechanism")
    tab.press("input[name=q]", "Enter")
    tab.wait_for_selector("#search-results li a")
    results = tab.evaluate("[...document.querySelectorAll('#search-results li a')].map(a => a.href)")
    assert any("examples" in result or "gallery" in result for result in results)
    tab.click("#search-results li a")
    tab.wait_for_load_state()
    assert "queez" in tab.inner_text("article")
    assert tab.faults == []


def test_the_first_stop_skips_the_navigation(tab: Any) -> None:
    tab.goto((SITE / "theory.html").as_uri())
    tab.keyboard.press("Tab")
    assert tab.evaluate("document.activeElement.getAttribute('href')") == "#furo-main-content"
    tab.wait_for_function("document.activeElement.getBoundingClientRect().top >= 0")  # it slides into the page
    tab.keyboard.press("Enter")
    tab.keyboard.press("Tab")
    assert tab.evaluate("document.activeElement.closest('#furo-main-content, .content') !== null")


def test_the_keyboard_opens_menus_and_reaches_wide_boxes(tab: Any) -> None:
    """In a narrow window: each stop is seen, and no stop is in a menu that is closed."""
    tab.set_viewport_size(NARROW)
    tab.goto((SITE / "theory.html").as_uri())
    tab.keyboard.press("Tab")
    tab.keyboard.press("Tab")
    assert tab.evaluate("document.activeElement.id") == "__navigation"
    opened = "getComputedStyle(document.querySelector('.sidebar-drawer')).visibility"
    assert tab.evaluate(opened) == "hidden"
    tab.keyboard.press("Space")
    assert tab.evaluate(opened) == "visible"
    tab.keyboard.press("Space")
    names = set()
    while (stop := tab.evaluate(STOP))["tag"] != "BODY":
        assert stop["outline"] and stop["inside"], stop
        names.add(stop["name"])
        tab.keyboard.press("Tab")
    assert {"formula", "table-wrapper"} <= names
