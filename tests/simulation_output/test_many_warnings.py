"""The summary of a run of many alike bodies: one warning and one line of names for all of them."""

from __future__ import annotations

import math
from typing import Any

from derive.cli.simulation_summary import pieces_text, summary_text


def monitor(beam: str, error: float, quantity: str = "deflection") -> dict[str, Any]:
    return {"beam": beam, "pieces": 1, "quantity": quantity, "error": error, "passed": not error <= 0.05}


def text(*monitors: dict[str, Any]) -> list[str]:
    run = {
        **dict.fromkeys(("coordinates", "constraints", "steps", "evaluations", "cpu_seconds"), 1),
        **dict.fromkeys(("drift", "drift_of_rates"), 0.0),
        "pieces": {of["beam"]: 1 for of in monitors},
        "finite_elements": (),
        "notes": (),
        "validity": monitors,
        "warnings": [f"{of['beam']} {of['quantity']} {of['error']}" for of in monitors if of["passed"]],
    }
    summary = {"name": "n", "duration": 1, "set": [], "runs": [run], "warnings": [], "plots": [], "files": []}
    lines = summary_text(summary).splitlines()
    return [line for line in lines if "warning" in line or "likewise" in line]


def test_of_the_instances_of_a_table_the_worst_is_named() -> None:
    errors = {"link[0]": 0.06, "link[1]": 0.01, "link[2]": 0.3, "link[3]": 0.2, "rod": 0.5}
    assert text(*(monitor(beam, error) for beam, error in errors.items())) == [
        "  warning: link[2] deflection 0.3",
        "    likewise 2 others of link, with errors from 6 % on; the record has all",
        "  warning: rod deflection 0.5",
    ]


def test_an_error_that_is_no_number_is_the_worst() -> None:
    assert text(monitor("link[0]", 0.9), monitor("link[1]", math.nan))[0] == "  warning: link[1] deflection nan"


def test_other_quantities_have_warnings_of_their_own() -> None:
    first, second = text(monitor("link[0]", 0.9), monitor("link[1]", 0.9, "axial force"))
    assert first.endswith("link[0] deflection 0.9") and second.endswith("link[1] axial force 0.9")


def test_the_line_of_a_run_names_few_beams() -> None:
    assert pieces_text((("rod", 2), ("arm", 1))) == ["rod in 2 beams", "arm in 1 beam"]
    assert pieces_text(tuple((f"link[{i}]", 1) for i in range(9))) == ["9 bodies of 1 beam each"]
