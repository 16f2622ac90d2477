"""The section on the initial state: what is specified, what the state has, corrections, or why there is none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from derive.cli.main import main
from derive.report.document.page import Paragraph, TableBlock
from derive.report.sections.initial_state import initial_state_blocks
from derive.simulation.initial.contradictions import InitialValue
from derive.simulation.initial.initial_state import InitialState

SPEC = """name = "begins"
[ground.markers]
a = [0, 0]
[bodies.rod]
mass = 1
inertia = 1
markers = {{ top = [-0.5, 0] }}
start = {{ angle = {} }}
[joints.pin]
kind = "revolute"
between = ["ground.a", "rod.top"]
start = {{ angle = 0.3 }}
"""


def state(*values: InitialValue) -> InitialState:
    return InitialState(0.0, np.zeros(1), np.zeros(1), 0.0, 0.0, False, False, values)


def test_values_are_listed_with_what_became_of_them() -> None:
    values = (
        InitialValue("bodies.rod.start.angle", "rad", 0.5, 0.5, False, False),
        InitialValue("bodies.rod.start.spin", "rad/s", 2.0, 2.001, False, True),
        InitialValue("bodies.bar.start.angle", "rad", 1.0, 0.2, True, False),
    )
    _, text, whole = initial_state_blocks(state(*values))
    assert isinstance(text, Paragraph) and "corrects values that contradict each other by rounding" in str(text)
    assert isinstance(whole, TableBlock)
    assert [row[-1].text for row in whole.rows] == [("kept",), ("corrected",), ("first guess",)]
    assert [row[1].text + row[2].text for row in whole.rows] == [("0.5", "0.5"), ("2", "2.001"), ("1", "0.2")]
    assert len(initial_state_blocks(state())) == 2  # no table of nothing


def test_a_state_that_cannot_be_computed_says_why() -> None:
    _, text = initial_state_blocks("no compiler")
    assert text == Paragraph(("The initial state cannot be computed: no compiler",))


@pytest.mark.parametrize(("angle", "expected"), [(0.3001, "corrected"), (0.5, "0.5 rad contradicts ")])
def test_the_command_reports_the_initial_state(tmp_path: Path, angle: float, expected: str) -> None:
    spec = tmp_path / "begins.toml"
    spec.write_text(SPEC.format(angle))
    assert main(["report", str(spec), "--out", str(tmp_path / "page.html")]) == 0
    page = (tmp_path / "page.html").read_text()
    assert "Initial state" in page and expected in page
