"""The table of studies: text, CSV, plain data and HTML follow from its columns and values."""

from __future__ import annotations

import csv
import json

import numpy as np

from derive.percentages import percent
from derive.rendering import render
from derive.study.table import StudyColumn, StudyTable, columns, fixed, general, plain

TABLE = StudyTable(
    (
        StudyColumn("model"),
        StudyColumn("rms_error", percent, head="rms", doc="over the peak"),
        StudyColumn("step_s", general(2), "step", "s"),
    ),
    (("rigid", 0.123456789, None), ("a, <b>", float("nan"), np.float64(0.015))),
    "Models",
    notes=("a note",),
)


def test_text_has_units_and_blanks_where_there_is_no_value() -> None:
    assert TABLE.text == [
        "Models",
        "  model     rms   step",
        "                     s",
        "  rigid    12 %",
        "  a, <b>  nan %  0.015",
        "  rms: over the peak",
        "  a note",
    ]
    assert StudyTable(columns("a"), ((1,),)).text == ["  a", "  1"]


def test_csv_has_all_digits_and_data_no_number_that_json_does_not_have() -> None:
    rows = list(csv.reader(TABLE.csv.splitlines()))
    assert rows[0] == ["model", "rms_error", "step_s"]
    assert rows[1] == ["rigid", "0.123456789", ""] and rows[2][0] == "a, <b>" and float(rows[2][2]) == 0.015
    assert json.loads(json.dumps(TABLE.data, allow_nan=False)) == [
        {"model": "rigid", "rms_error": 0.123456789, "step_s": None},
        {"model": "a, <b>", "rms_error": None, "step_s": 0.015},
    ]


def test_some_columns_in_another_order() -> None:
    part = TABLE.only(("step_s", "model")).reversed
    assert part.head == ("step", "model") and part.cells == [["0.015", "a, <b>"], ["", "rigid"]]


def test_html_is_escaped_and_has_the_same_texts() -> None:
    page = render(
        "study/methods.html.jinja", {"name": "n", "picture": "", "failures": (), "tables": (TABLE,), "notes": ()}
    )
    assert '<td class="left">a, &lt;b&gt;</td><td>nan %</td><td>0.015</td>' in page
    assert "<th>step</th>" in page and '<p class="note">rms: over the peak.</p>' in page and "a note." in page


def test_formats() -> None:
    assert [fixed(2)(x) for x in (1.234, float("inf"))] == ["1.23", ""]
    assert [general(2)(x) for x in (123.4, float("nan"))] == ["1.2e+02", ""]
    assert plain({"a": (np.array([1.0, np.inf]), TABLE.columns[0].name)}) == {"a": [[1.0, None], "model"]}
