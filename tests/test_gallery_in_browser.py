"""Players and the report of the gallery by the keyboard, in a browser, as `make docs` has made them."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.util import find_spec
from typing import Any

import pytest

from browser import CHROMIUM
from conftest import ROOT

pytestmark = pytest.mark.docs

PAGES = ROOT / "build/docs/extra/gallery"


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    if CHROMIUM is None or find_spec("playwright") is None or not PAGES.exists():
        pytest.skip("chromium, playwright or the gallery is missing: make docs")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as tool:
        yield tool.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])


def opened(browser: Any, page: str) -> Any:
    """A page of the gallery in a narrow window, with the motion at rest."""
    tab = browser.new_context(viewport={"width": 400, "height": 800}, reduced_motion="reduce").new_page()
    tab.goto((PAGES / page).as_uri())
    return tab


@pytest.mark.parametrize("name", ["crank_slider_3", "spatial_crank_slider"])
def test_a_player_is_controlled_by_keys(browser: Any, name: str) -> None:
    tab = opened(browser, f"{name}.motion.html")
    time = "+document.getElementById('time').value"
    tab.keyboard.press("ArrowRight")
    assert tab.evaluate(time) == 1
    tab.keyboard.press("End")
    assert tab.evaluate(time) > 100
    tab.keyboard.press("Home")
    tab.keyboard.press("Space")
    assert tab.inner_text("#play") == "Pause"


def test_the_view_in_space_rotates_by_keys_when_it_has_the_focus(browser: Any) -> None:
    tab = opened(browser, "spatial_crank_slider.motion.html")
    corner = "document.getElementById('stage').dataset.corner"
    seen = [tab.evaluate(corner)]
    tab.focus("#stage")
    for key in ("ArrowRight", "ArrowUp", "+"):
        tab.keyboard.press(key)
        seen.append(tab.evaluate(corner))
    assert len(set(seen)) == 4
    assert tab.evaluate("+document.getElementById('time').value") == 0
    tab.focus("#loop")
    tab.keyboard.press("ArrowRight")
    assert tab.evaluate("+document.getElementById('time').value") == 1


def test_wide_tables_of_the_report_scroll_by_keys(browser: Any) -> None:
    tab = opened(browser, "crank_slider_3.report.html")
    boxes = "[...document.querySelectorAll('.table')].filter(box => box.scrollWidth > box.clientWidth)"
    assert tab.evaluate(f"{boxes}.length") > 0
    assert tab.evaluate(f"{boxes}.every(box => box.tabIndex === 0)")
