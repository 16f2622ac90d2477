"""Charts: same input, same bytes; nothing in them of this machine, of today, or of others' settings."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from derive.artifacts import MARK
from derive.simulation.observables.axis_ticks import plain_numbers, ticks
from derive.visual.chart_style import DARK
from derive.visual.line_chart import Chart, Curve, Panel, svg
from svg_text import outside, text_boxes

DRAW = """
import sys
sys.path[:0] = {here!r}
import test_chart
sys.stdout.write(test_chart.svg(test_chart.drawn()))
"""


def drawn() -> Chart:
    x = np.linspace(0, 15, 1001)
    labels = {n: f"{n} beam{'s' * (n > 1)}" for n in (1, 2, 3)}
    curves = tuple(Curve(labels[n], x, np.sin(x) / n, (x, 100 * (1 / n - 1) * np.sin(x))) for n in labels)
    panel = Panel("deflection", "", curves, Curve("known", x, np.sin(x)))
    return Chart("A <title> & more", "angle of motor", "rad", (panel,))


def test_bytes_do_not_depend_on_hash_seed_or_settings(tmp_path: Path) -> None:
    (tmp_path / "matplotlibrc").write_text("lines.linewidth: 7\nsvg.fonttype: path\naxes.grid: False\n")
    code = DRAW.format(here=[str(folder) for folder in Path(__file__).parents[:2]])
    settings = {"MATPLOTLIBRC": str(tmp_path), "SOURCE_DATE_EPOCH": "1", "PYTHONHASHSEED": "2026"}
    environment = {**os.environ, **settings, "PYTHONIOENCODING": "utf-8"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, env=environment, check=True)
    assert done.stdout == svg(drawn()).encode()


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
    assert svg(Chart("t", "time", "s", (Panel("y", "", (one,)),))).endswith("</svg>\n")
    x = np.linspace(0, 1, 5)
    curves = tuple(Curve(f"{n} beams", x, n * x) for n in range(1, 8))
    assert "7 beams" in svg(Chart("t", "time", "s", (Panel("y", "", curves),)))


def test_names_are_text_and_no_mathematics() -> None:
    """A reference file may be called a$\\x$.csv, whose name is an unknown command of mathtext."""
    one = Curve("reference: a$\\x$.csv", np.zeros(1), np.zeros(1))
    assert ">reference: a$\\x$.csv</text>" in svg(Chart("a$\\x$", "$t$", "s", (Panel("y", "", (one, one)),)))


def a_chart(*labels: str, unit: str = "", y_label: str = "", title: str = "t", scale: float = 1.0) -> Chart:
    x = np.linspace(0, 1, 5)
    curves = tuple(Curve(label, x, scale * (n + x**2)) for n, label in enumerate(labels))
    return Chart(title, "time", "s", (Panel(y_label, unit, curves),))


LONG = "rotation_of_the_second_connecting_rod_against_the_first"


@pytest.mark.parametrize(
    "chart",
    [
        a_chart("a", y_label="deflection / 0.4 m", scale=1e-4),
        a_chart("a", y_label="d", unit="N m", scale=1.23e-5),
        a_chart("a", y_label="d", unit="N m", scale=-1e12),
        a_chart("a", y_label="d", unit="m", scale=1e5),
        a_chart(*(f"{n}: {LONG}" for n in range(12)), y_label=", ".join([LONG] * 12), unit="rad", title=LONG * 3),
        a_chart(f"{LONG} " * 4, "b", y_label=LONG, unit="rad"),
        drawn(),
    ],
    ids=["decimals", "small", "large", "wide", "many", "lines", "deviations"],
)
def test_all_texts_are_within_the_picture(chart: Chart) -> None:
    text = svg(chart)
    assert outside(text) == []
    labels = [box for box in text_boxes(text) if box.text in [line for c in chart.curves for line in c.label.split()]]
    assert all(a.bottom <= b.top or b.bottom <= a.top for a, b in pairwise(labels))


def test_a_long_label_of_an_axis_gives_way_to_the_unit() -> None:
    """The legend names the curves."""
    texts = [box.text for box in text_boxes(svg(a_chart("a", "b", y_label=f"{LONG}, " * 3, unit="N m")))]
    assert "N m" in texts
    texts = [box.text for box in text_boxes(svg(a_chart("a", "b", y_label="first, second", unit="N m")))]
    assert "first, second, N m" in texts


def strokes(chart: Chart) -> list[tuple[str, str]]:
    """The colours and the dashes of the curves; those of the legend are left out."""
    styles = re.findall(r'clip-path="[^"]*" style="([^"]*stroke-width: 1.6[^"]*)"', svg(chart))
    dashes = [re.findall(r"stroke-dasharray: ([^;]*)", style) for style in styles]
    return [(re.findall(r"stroke: (#\w+)", s)[0], *(d or [""])) for s, d in zip(styles, dashes, strict=True)]


def test_the_first_curve_of_an_axis_is_solid_and_no_two_curves_look_alike() -> None:
    assert [dashes for _, dashes in strokes(a_chart("a"))] == [""]
    assert [bool(dashes) for _, dashes in strokes(a_chart("a", "b", "c"))] == [False, True, True]
    (panel,) = a_chart("a", "b").panels
    looks = strokes(Chart("t", "time", "s", (panel, panel)))
    assert [bool(dashes) for _, dashes in looks] == [False, True] * 2 and len(set(looks)) == 4


def test_numbers_at_the_ticks_are_round_and_differ() -> None:
    assert plain_numbers(ticks(-455.4, 0, 3)) == ["\N{MINUS SIGN}400", "\N{MINUS SIGN}200", "0"]
    assert plain_numbers(ticks(0, 0.3, 3)) == ["0", "0.1", "0.2", "0.3"]
    assert plain_numbers(ticks(0, 3e-6, 3)) == ["0", *(f"{n}e\N{MINUS SIGN}6" for n in (1, 2, 3))]
    assert ticks(1e5, 1e5, 3) == [1e5] and ticks(-1e308, 1e308, 3) == [-1e308, 1e308]
    random = np.random.default_rng(1)
    for _ in range(300):
        low, span = random.normal() * 10.0 ** random.uniform(-12, 12), 10.0 ** random.uniform(-6, 3)
        high = low + span * abs(low)
        values = ticks(low, high, 3)
        texts = plain_numbers(values)
        assert 3 <= len(values) <= 10 and len(set(texts)) == len(values)
        assert low - 1e-8 * (high - low) <= values[0] < values[-1] <= high + 1e-8 * (high - low)
        numbers = [float(text.replace("\N{MINUS SIGN}", "-")) for text in texts]
        np.testing.assert_allclose(numbers, values, rtol=0, atol=1e-4 * (values[1] - values[0]))
