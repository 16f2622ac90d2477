"""Charts: same input, same bytes; nothing in them of this machine, of today, or of others' settings."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np

from derive.artifacts import MARK
from derive.visual.axis_ticks import MINUS, ticks
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


def test_bytes_do_not_depend_on_hash_seed_or_settings() -> None:
    code = DRAW.format(here=str(Path(__file__).parent))
    texts = [svg(drawn()).encode()]
    for seed, more in (("0", {}), ("2026", {"SOURCE_DATE_EPOCH": "1"})):
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


def test_ticks_are_round_numbers_whose_labels_are_short() -> None:
    for low, high, labels, common in (
        (0.0, 1.0, "0.00 0.25 0.50 0.75 1.00", ""),
        (-0.017, 0.0169, "-0.01 0.00 0.01", ""),
        (1e-9, 8e-9, "2 4 6 8", "x10⁻⁹"),
        (100.0000012, 100.0000019, "2 4 6 8", "x10⁻⁷ + 100.000001"),
        (-3e7, 5e7, "-2 0 2 4", "x10⁷"),
    ):
        result = ticks(low, high, 4)
        assert " ".join(result.labels).replace(MINUS, "-") == labels
        assert result.common.replace("\N{MULTIPLICATION SIGN}", "x") == common
        assert all(low <= x <= high for x in result.positions)


def test_values_that_are_no_numbers_interrupt_a_curve() -> None:
    x = np.arange(5.0)
    text = svg(Chart("t", "time", "s", "y", (Curve("a", x, np.array([0, 1, np.nan, 1, 0])),)))
    (path,) = re.findall(r'd="([^"]*)" style="[^"]*stroke-linejoin', text)
    assert re.findall("[ML]", path) == ["M", "L", "M", "L"] and "nan" not in text


def test_long_labels_are_below_each_other() -> None:
    x = np.arange(3.0)
    for letters, columns in ((10, 2), (60, 1)):
        labels = [name * letters for name in "abcd"]
        text = svg(Chart("t", "time", "s", "y", tuple(Curve(label, x, x) for label in labels)))
        places = [re.search(rf'<text x="([\d.]+)" y="([\d.]+)">{label}<', text) for label in labels]
        assert len({place[1] for place in places if place}) == columns
        assert len({place[0] for place in places if place}) == 4
