"""Charts: same input, same bytes; nothing in them of this machine, of today, or of others' settings."""

from __future__ import annotations

import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np

from derive.artifacts import MARK
from derive.visual.chart_style import DARK
from derive.visual.line_chart import Chart, Curve, svg

DRAW = """
import sys
sys.path.insert(0, {here!r})
import test_chart
sys.stdout.write(test_chart.svg(test_chart.drawn()))
"""


def drawn() -> Chart:
    x = np.linspace(0, 15, 1001)
    curves = tuple(Curve(f"{n} beam{'s' * (n > 1)}", x, np.sin(x) / n) for n in (1, 2, 3))
    off = tuple(Curve("", c.x, 100 * (c.y - np.sin(x))) for c in curves)
    return Chart("A <title> & more", "angle of motor", "rad", "deflection", curves, Curve("known", x, np.sin(x)), off)


def test_bytes_do_not_depend_on_hash_seed_or_settings(tmp_path: Path) -> None:
    (tmp_path / "matplotlibrc").write_text("lines.linewidth: 7\nsvg.fonttype: path\naxes.grid: False\n")
    code = DRAW.format(here=str(Path(__file__).parent))
    texts = [svg(drawn()).encode()]
    for seed, more in (("0", {}), ("2026", {"MATPLOTLIBRC": str(tmp_path), "SOURCE_DATE_EPOCH": "1"})):
        environment = {**os.environ, **more, "PYTHONHASHSEED": seed, "PYTHONIOENCODING": "utf-8"}
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, env=environment, check=True)
        texts.append(done.stdout)
    assert texts[0] == texts[1] == texts[2]


def test_it_is_a_picture_of_its_own() -> None:
    text = svg(drawn())
    root = ElementTree.fromstring(text)
    assert root.tag.endswith("svg") and MARK in text[:1000]
    assert "A &lt;title&gt; &amp; more; known; 1 beam; 2 beams; 3 beams</title>" in text
    assert "dc:date" not in text and "/home" not in text and "site-packages" not in text
    outside = [part for part in text.split('"') if part.startswith("http") and "www.w3.org" not in part]
    assert outside == []
    assert len(text) < 150_000


def test_angles_are_told_in_pi_and_dark_pages_are_known() -> None:
    text = svg(drawn())
    assert ">0.5π</text>" in text and ">4π</text>" in text and ">0</text>" in text
    assert "prefers-color-scheme: dark" in text
    assert all(f"{light}" in text.split("</style>", 1)[1] for light in DARK)  # the rules meet something


def test_a_curve_of_one_point_and_many_curves() -> None:
    one = Curve("a", np.zeros(1), np.zeros(1))
    assert svg(Chart("t", "time", "s", "y", (one,))).endswith("</svg>\n")
    x = np.linspace(0, 1, 5)
    assert "7 beams" in svg(Chart("t", "time", "s", "y", tuple(Curve(f"{n} beams", x, n * x) for n in range(1, 8))))


def test_names_are_text_and_no_mathematics() -> None:
    """A reference file may be called a$\\x$.csv, whose name is an unknown command of mathtext."""
    one = Curve("reference: a$\\x$.csv", np.zeros(1), np.zeros(1))
    assert ">reference: a$\\x$.csv</text>" in svg(Chart("a$\\x$", "$t$", "s", "y", (one, one)))
