"""The summary of a run of many alike bodies: one warning and one line of names for all of them."""

from __future__ import annotations

from dataclasses import replace

from derive.cli.simulation_summary import pieces_text, summary_text
from derive.simulation.validity.monitors import Cause, Monitor, warnings
from derive.spec.model.body import DisplacementOrder


def test_a_warning_is_a_line_for_all_bodies_that_it_names() -> None:
    worst = Monitor("link[0]", 1, Cause.DEFLECTION, DisplacementOrder.FIRST_ORDER, 0.4, 0.3, 0.5)
    monitors = [worst, replace(worst, beam="link[1]", error=0.2), replace(worst, beam="rod", error=0.1)]
    run = {
        **dict.fromkeys(("coordinates", "constraints", "steps", "evaluations", "cpu_seconds"), 1),
        **dict.fromkeys(("drift", "drift_of_rates"), 0.0),
        "pieces": {of.beam: 1 for of in monitors},
        "finite_elements": (),
        "notes": (),
        "validity": [of.data for of in monitors],
        "warnings": warnings(monitors),
    }
    summary = {"name": "n", "duration": 1, "set": [], "runs": [run], "warnings": [], "plots": [], "files": []}
    (line,) = (line for line in summary_text(summary).splitlines() if "warning" in line)
    assert line.startswith("  warning: link[0] in 1 beam: it bends by 40 %")
    assert "20 % in link[1] and 10 % in rod" in line


def test_the_line_of_a_run_names_few_beams() -> None:
    assert pieces_text((("rod", 2), ("arm", 1))) == ["rod in 2 beams", "arm in 1 beam"]
    assert pieces_text(tuple((f"link[{i}]", 1) for i in range(9))) == ["9 bodies of 1 beam each"]
