"""The chart of accuracy against cost: what is on the front, labels, headlines, and the table beside it."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from test_accuracy import FIRST, TRUNCATED, crank_slider

from browser import CHROMIUM, browsed
from derive.percentages import percent
from derive.simulation.validity.mode_content import ModeError
from derive.simulation.validity.monitors import Cause, Monitor
from derive.spec.model.markers import MarkerRef
from derive.spec.model.plots import ColumnCurves, Deflection, Plot
from derive.spec.model.ports import SceneOutput
from derive.study.accuracy.chart import _range, accuracy_svg
from derive.study.accuracy.chart_labels import duration, label_groups, milliseconds, spread
from derive.study.accuracy.doubts import doubt, doubt_lines
from derive.study.accuracy.headline import candidates, front, headline, headline_texts, recommended
from derive.study.accuracy.ladder_chart import LadderChart
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.measurement import Line, Point
from derive.study.accuracy.peers import Peer
from derive.study.accuracy.reference import Reference, plotted_beams
from derive.study.accuracy.table import accuracy_data, accuracy_html, accuracy_text, cheapest, run_table
from strict_html import Page
from svg_text import outside, text_boxes


def line(label: int, *runs: tuple[float, float], warning: Monitor | None = None, failure: str = "") -> Line:
    """A line of polynomials; runs: error and CPU seconds."""
    points = tuple(Point(10.0**-k, e, 2 * e, (s, s, s), int(1e6 * s), int(1e8 * s)) for k, (e, s) in enumerate(runs, 3))
    return Line(LadderModel(Shapes.POLYNOMIALS, label, TRUNCATED), 3 + label, points, warning, failure)


WARNING = Monitor("rod", 1, Cause.AXIAL_FORCE, FIRST, 0.2, 0.1, 0.3)
LINES = (
    line(1, (0.3, 1e-5), (0.29, 3e-5)),
    line(2, (0.02, 4e-5), (0.01, 1e-4)),
    line(3, (0.02, 5e-5), (0.001, 2e-4)),
    line(4, (0.0001, 2e-5), warning=WARNING),
    line(5, failure="it does not start"),
)


def test_what_no_cheaper_run_beats_is_on_the_front_and_what_is_not_valid_is_not() -> None:
    runs = candidates(LINES)
    assert len(runs) == 6
    best = front(runs, lambda p: p.seconds[0])
    assert [(r.point.rms, r.point.seconds[0]) for r in best] == [
        (0.3, 1e-5), (0.29, 3e-5), (0.02, 4e-5), (0.01, 1e-4), (0.001, 2e-4)
    ]  # fmt: skip
    assert [r.line.model.count for r in best] == [1, 1, 2, 2, 3]
    chosen = recommended(runs, 0.01)
    assert chosen is not None and (chosen.line.model.count, chosen.point.seconds[0]) == (2, 1e-4)
    assert recommended(runs, 1e-5) is None
    assert cheapest(LINES[1]).rms == 0.01 and cheapest(LINES[0]).rms == 0.3


def test_labels_stay_apart_and_as_near_as_they_can() -> None:
    assert spread([0, 1, 2], 0.5) == [0, 1, 2]
    assert spread([1, 1, 1], 0.5) == pytest.approx([0.5, 1, 1.5])
    assert spread([0, 0.1, 5], 1) == pytest.approx([-0.45, 0.55, 5])


def a_chart() -> LadderChart:
    quantity = Deflection(MarkerRef("rod", "a"), (MarkerRef("rod", "b"), MarkerRef("rod", "c")))
    known = Reference((Plot("tip", quantity),), "made.csv", 0.005)
    return LadderChart("made", LINES, known, 0.01, "a machine", shown=("rod",))


def test_a_notebook_shows_the_chart_and_the_models() -> None:
    chart = a_chart()
    head, *more = repr(chart).splitlines()
    assert head == f"LadderChart of made: {len(LINES)} models in {sum(len(line.points) for line in LINES)} runs"
    assert any(line.strip().startswith("Recommended") for line in more) and len(more) <= 4
    page = Page(chart._repr_html_())
    assert page.faults == []
    assert page.count("svg") == 1
    assert {line.model.label for line in chart.drawn} <= set(page.words["td"])


def test_the_chart_says_what_it_shows() -> None:
    chart = a_chart()
    svg = accuracy_svg(chart)
    assert svg.startswith("<svg") and svg == accuracy_svg(chart) and outside(svg) == []
    assert "<title>1 beam, P2, P3, truncated, 5 coordinates\n" in svg  # what a browser shows for the line
    assert "grey: its own error, 0.5 %" in svg and "at most 1 %" in svg and "a machine" in svg
    assert "it does not start: 1 beam, P2 to P6, truncated" in "\n".join(doubt_lines(LINES, ("rod",)))
    assert [[one.model.count for one in group] for group in label_groups(LINES[:3])] == [[3], [2], [1]]
    assert [percent(x) for x in (0.123, 0.00123, 0.0996, 0.997, 12.3)] == ["12 %", "0.12 %", "10 %", "100 %", "1230 %"]
    assert [milliseconds(x) for x in (5.93e-5, 4.51e-2, 12.3456)] == ["0.0593", "45.1", "12 346"]
    assert [duration(x) for x in (5.93e-5, 0.9994, 12.3456)] == ["0.0593 ms", "999 ms", "12.3 s"]
    assert "errors below that of the reference" in accuracy_text(chart)
    page = accuracy_html(chart)
    assert "it does not start" in page and "http" not in page.replace("http://www.w3.org", "")
    rows = list(csv.DictReader(run_table(chart).csv.splitlines()))
    assert len(rows) == 7 and rows[-1]["valid"] == "False"


def test_bodies_that_miss_stiffness_or_modes_are_hollow_and_what_they_miss_is_below_the_chart() -> None:
    """Craig-Bampton modes of a rod were 32 % off and drawn as valid: the terminal alone knew of its axial force."""
    softer = "rod: joints press it with 6.78e+03 N, which changes its bending stiffness by about 652 %"
    few = ModeError("rod", 4, 100.0, 0.48, of_loads=True)
    noted = (replace(LINES[0], spins={"rod, axial": softer}), replace(LINES[1], missed=(few,)), LINES[2])
    chart = replace(a_chart(), lines=noted)
    svg = accuracy_svg(chart)
    groups = [svg[svg.index(f'id="line_0_{n}"') :].split("<use", 2)[1] for n in range(3)]
    assert ["fill-opacity: 0;" in group for group in groups] == [True, True, False]
    assert all(line.valid for line in noted) and chart.headline.recommended is not None
    text = " ".join(box.text for box in text_boxes(svg))
    assert f"Without stiffness that loads or spin add (hollow): {softer} (1 beam, P2, truncated)" in text
    assert "With too few modes (hollow), " in text and "hollow: in doubt" in text and not outside(svg)
    assert "hollow" not in " ".join(box.text for box in text_boxes(accuracy_svg(replace(chart, lines=noted[2:]))))
    page = accuracy_html(chart)
    assert "stiffness that loads or spin add is missing" in page and "the modes of rod are too few" in page
    assert "hollow" not in accuracy_text(chart) and "With too few modes, the error" in accuracy_text(chart)
    assert [len(group) for group in label_groups([LINES[0], replace(LINES[0], missed=(few,))])] == [1, 1]


def test_errors_that_vanish_are_drawn_at_the_lower_end() -> None:
    """All models agree exactly about what a drive prescribes."""
    lines = (line(1, (0.0, 1e-5)), line(2, (0.0, 4e-5)), line(3, (0.02, 5e-5)))
    svg = accuracy_svg(replace(a_chart(), lines=lines))
    assert svg.count("<title>1 beam, P2, truncated, 4 coordinates\ntolerance 0.001: rms 0 %") == 2 and not outside(svg)
    assert [[one.model.count for one in group] for group in label_groups(lines)] == [[1, 2], [3]]


def test_errors_far_below_that_of_the_reference_are_drawn_at_the_lower_end() -> None:
    """The model that is the reference itself has rounding errors, which would take most of the axis."""
    chart = replace(a_chart(), lines=(line(1, (1e-13, 1e-5)), line(2, (1e-4, 4e-5)), line(3, (0.02, 5e-5))))
    assert _range(chart) == pytest.approx((5e-5 / 1.6, 0.032)) and not outside(accuracy_svg(chart))


def test_one_headline_names_the_recommended_model_a_cheaper_one_in_doubt_and_the_next_better_one() -> None:
    """The headline is the same in the chart, on the page, in the terminal and in the record."""
    chart = a_chart()
    sentences = {
        "Recommended": "1 beam, P2, P3, truncated, tolerance 0.0001: error 1 % (largest 2 %), 0.1 ms; "
        "the cheapest valid model with an error of at most 1 %",
        "Cheaper, if its warning does not matter": "1 beam, P2 to P5, truncated, tolerance 0.001: error 0.01 % "
        "(largest 0.02 %), 0.02 ms; 10 % implied, 0.01 % measured: the axial force of rod is in doubt; "
        "the estimate is of all of rod, the measurement of what the plot shows",
        "Next better": "1 beam, P2 to P4, truncated, tolerance 0.0001: error 0.1 % (largest 0.2 %), 0.2 ms",
    }
    assert dict(headline_texts(chart.headline, chart.shown)) == sentences
    shown = {
        "chart": " ".join(box.text for box in text_boxes(accuracy_svg(chart))),
        "page": re.sub(r"<[^>]*>", " ", accuracy_html(chart).replace("&nbsp;", " ")),
        "terminal": accuracy_text(chart),
    }
    for text in (" ".join(text.split()) for text in shown.values()):
        assert all(title in text and sentence in text for title, sentence in sentences.items())
    data = accuracy_data(chart)
    assert [data[key]["cpu_s"] for key in ("recommended", "cheaper", "better")] == [1e-4, 2e-5, 2e-4]
    accurate = headline(LINES, 0.001)
    assert accurate.recommended is not None and accurate.recommended.line is LINES[2] and accurate.better is None
    assert dict(headline_texts(accurate, ()))["Next better"] == "none: no other valid model has a clearly smaller error"
    alike = replace(LINES[2], points=tuple(replace(p, rms=0.95 * LINES[0].best) for p in LINES[2].points))
    assert headline((LINES[0], alike), 1.0).better is None  # 0.039 % was said to be better than 0.039 %
    coarse = headline(LINES, 0.02)
    assert coarse.better is not None and coarse.better.line is LINES[2]  # another model, not a finer run of the same
    (none, cheaper) = headline_texts(headline(LINES, 1e-4), ())
    assert none[1].startswith(
        "none: no valid model has an error of at most 0.01 %; the most accurate one is 1 beam, P2"
    )
    assert cheaper[1].startswith("1 beam, P2 to P5, truncated")
    finer = replace(LINES[3], points=line(4, (0.0001, 2e-5), (0.00001, 3e-5)).points)
    assert "10 % implied, 0.01 % measured" in headline_texts(headline((*LINES[:3], finer), 1e-3), ())[1][1]


def test_a_reference_with_a_larger_error_than_is_asked_for_decides_nothing() -> None:
    chart = replace(a_chart(), error=0.004)
    sentence = "Undecided: the error of the reference itself is 0.5 %, so an error of 0.4 % cannot be judged"
    assert sentence in " ".join(accuracy_text(chart).split())
    assert accuracy_data(chart)["recommended"] is None and "recommended" not in accuracy_svg(chart)
    unknown = replace(chart, reference=replace(chart.reference, error=None))
    assert unknown.headline.recommended is not None


def test_where_monitor_and_measurement_differ_both_are_shown_with_the_reason() -> None:
    """The monitor of the crank implies 31 %, and the plot, in which 0.94 % is measured, shows the rod."""
    crank = replace(WARNING, beam="crank", cause=Cause.BENDING_MOMENT, error=0.31)
    doubted = line(1, (0.02, 1e-5), (0.0094, 3e-5), warning=crank)
    reason = "the bending moment of crank is in doubt, and the plot shows rod"
    assert doubt(doubted, ("rod",)) == f"31 % implied, 0.94 % measured: {reason}"
    assert doubt_lines((doubted,), ("rod",))[1:] == [f"{reason}: {doubted.label} (31 %, 0.94 %)"]
    assert doubt(replace(doubted, warning=WARNING), ("rod",)).endswith("the measurement of what the plot shows")
    assert doubt(line(1, (0.09, 1e-5), warning=WARNING), ("rod",)).endswith("the axial force of rod is in doubt")
    page = accuracy_html(replace(a_chart(), lines=(*LINES, doubted)))
    row = next(row for row in re.findall("<tr>.*?</tr>", page) if reason in row)
    assert "<td>0.94 %</td>" in row and "<td>31 %</td>" in row
    assert page.count(f"<li>{doubted.label}: ") == 1, "a warning names its model"


def test_an_implied_error_beyond_all_bounds_is_no_number() -> None:
    """58456 % was printed of a leg of a fork that bends in the other plane."""
    doubted = line(1, (0.0023, 1e-5), warning=replace(WARNING, error=584.56))
    assert "a monitor implies 100 % or more in" in doubted.outcome
    assert doubt(doubted, ()).startswith("100 % or more implied, 0.23 % measured")
    assert "<td>100 % or more</td>" in accuracy_html(replace(a_chart(), lines=(*LINES, doubted)))


def test_the_beams_that_a_plot_shows() -> None:
    joint = next(joint.name for joint in crank_slider().joints if joint.second.body == "rod")
    outputs = (
        SceneOutput("tip", "position", {"marker": MarkerRef("rod", "middle")}),
        SceneOutput("length", "distance", {"between": (MarkerRef("ground", "o"), MarkerRef("rod", "right"))}),
        SceneOutput("force", "reaction", {"joint": joint}),
        SceneOutput("energy", "energy"),
    )
    scene = replace(crank_slider(), outputs=outputs)
    assert plotted_beams(scene.plots[0], scene) == ("rod",)
    columns = {"tip_2": True, "length": True, "force_1": True, "energy_total": False, "crank_phi": False}
    columns |= {"rod_1_alpha2": True, "rod_3_phidot": True, "t": False}
    shown = {name: plotted_beams(Plot("p", ColumnCurves((name,))), scene) == ("rod",) for name in columns}
    assert shown == columns


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here")
def test_the_table_fits_into_a_window(tmp_path: Path) -> None:
    """The last column is not cut off at 1400 pixels."""
    page = tmp_path / "page.html"
    measure = "<script>document.title = JSON.stringify([...document.querySelectorAll('.table, table, td:last-child')]"
    measure += ".map(e => [e.getBoundingClientRect().right, e.scrollWidth - e.clientWidth]))</script>"
    page.write_text(accuracy_html(replace(a_chart(), lines=(*LINES, *LINES))).replace("</body>", f"{measure}</body>"))
    title = re.search(r"<title>(\[\[.*?)</title>", browsed(page, "", "1400,1000"))
    assert title is not None
    (around, inner), *rest = json.loads(title[1])
    assert around <= 1400 and inner == 0 and len(rest) > 8
    assert all(right <= around and over <= 0 for right, over in rest)


def test_runs_of_other_programs_stand_where_runs_of_models_with_their_time_and_error_do() -> None:
    chart = replace(a_chart(), peers=(Peer("another", ((4e-5, 0.02, 0.05), (1e-4, 0.01, 0.02))),))

    def curve(group: str) -> str:
        drawn = accuracy_svg(chart).split(f'<g id="{group}">')[1]
        return re.findall(r'<path d="(M [^"]*)"', drawn)[0]

    assert curve("peer_0") == curve("line_0_1")  # of 2 shapes
    assert "another" in accuracy_svg(chart) and "other programs" in accuracy_svg(chart)
