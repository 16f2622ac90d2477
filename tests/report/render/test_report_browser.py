"""A page in a browser, wide and narrow: every equation is to be seen, and nothing has to be scrolled sideways."""

from __future__ import annotations

import html as escaping
import json
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest
import sample_report

from browser import CHROMIUM
from derive.report.writers.equation_html import equations_shown
from derive.report.writers.html import html

PROBE = """
function probe(frame) {
  const page = frame.contentDocument, view = frame.contentWindow;
  page.querySelectorAll("main details").forEach(one => one.open = true);
  const box = one => one.getBoundingClientRect();
  const middle = one => (box(one).left + box(one).right) / 2;
  const seen = one => box(one).width > 0 && box(one).height > 0;
  const all = [...page.querySelectorAll("math")];
  const names = [...page.querySelectorAll("math mi, math mn")];
  const lines = [...page.querySelectorAll(".b")].map(b => {
    const middles = [...b.querySelectorAll("math")].map(m => (box(m).top + box(m).bottom) / 2).sort((x, y) => x - y);
    return 1 + middles.filter((y, k) => k && y - middles[k - 1] > 12).length;
  });
  const number = page.querySelector("#row-phi .n");
  return {
    width: view.innerWidth, scroll: page.documentElement.scrollWidth, math: all.length,
    unseen: all.filter(one => !seen(one)).length, letters: names.length,
    blank: names.filter(one => !seen(one)).length, lines: lines,
    over: [...page.querySelectorAll("main > *, footer")].filter(one => box(one).right > view.innerWidth + 1).length,
    broken: all.filter(one => one.closest(".b") && one.getClientRects().length > 1).length,
    dots: [...page.querySelectorAll("mover[accent] > mo")].every(one =>
      Math.abs(middle(one) - middle(one.previousSibling)) < 4),
    number: number && box(number).right <= view.innerWidth && seen(number),
    ground: view.getComputedStyle(page.body).backgroundColor, errors: view.errors || []
  };
}
addEventListener("load", () => {
  const found = [...document.querySelectorAll("iframe")].map(probe);
  document.getElementById("found").textContent = JSON.stringify(found);
});
"""


def probed(folder: Path, pages: list[tuple[int, str]], *options: str) -> list[dict[str, Any]]:
    """The measurements that a browser takes of pages, each in a frame of its width."""
    assert CHROMIUM
    listen = "<head><script>var errors = []; onerror = (...e) => errors.push(String(e))</script>"
    frames = "".join(
        f'<iframe width="{width}" height="900" srcdoc="{escaping.escape(text.replace("<head>", listen, 1))}"></iframe>'
        for width, text in pages
    )
    path = folder / "probe.html"
    path.write_text(
        '<!doctype html><meta name="color-scheme" content="light dark"><pre id="found"></pre>'
        f"<script>{PROBE}</script>{frames}"
    )
    command = [
        CHROMIUM,
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        f"--user-data-dir={folder / 'profile'}",
        *options,
    ]
    done = subprocess.run(
        [*command, "--virtual-time-budget=2000", "--window-size=1400,1000", "--dump-dom", f"file://{path}"],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    said = re.search(r'<pre id="found">(.*?)</pre>', done.stdout, re.S)
    assert said and said[1], done.stderr
    found: list[dict[str, Any]] = json.loads(escaping.unescape(said[1]))
    return found


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here")
def test_every_equation_is_to_be_seen(tmp_path: Path) -> None:
    text = html(sample_report.page(8))
    alone = f"<!doctype html><head></head><body>{equations_shown((sample_report.turning(8),))}"
    wide, narrow, phone, notebook = probed(tmp_path, [(1280, text), (390, text), (320, text), (700, alone)])
    for found in (wide, narrow, phone, notebook):
        assert found["errors"] == [] and found["unseen"] == found["blank"] == found["broken"] == 0
        assert found["scroll"] <= found["width"] and found["dots"]
    for found in (wide, narrow, phone):
        assert found["math"] == text.count("<math") and found["letters"] > 400
        assert found["over"] == 0 and found["number"]
    assert wide["width"] == 1280 and narrow["width"] == 390
    assert max(narrow["lines"]) > max(wide["lines"]) > 2, "long sums take more lines where there is less room"
    assert wide["lines"][0] == 1


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here")
def test_dark_is_dark(tmp_path: Path) -> None:
    text = html(sample_report.page(1))
    (light,) = probed(tmp_path, [(600, text)], "--blink-settings=preferredColorScheme=1")
    (dark,) = probed(tmp_path, [(600, text)], "--blink-settings=preferredColorScheme=0")
    assert light["ground"] == "rgb(255, 255, 255)" and dark["ground"] == "rgb(19, 23, 27)"
