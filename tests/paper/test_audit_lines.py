"""The lines of the audit: each one is evaluated, and misread ones differ from the true ones in dots alone."""

from __future__ import annotations

import pytest

from derive.report.notation.formula_reader import equation

from . import printed
from .audit_lines import ROWS
from .test_lines_of_sums import INTEGRALS, TERMS
from .test_lines_of_vectors import STATED


def test_every_line_of_the_audit_is_evaluated() -> None:
    alone = ("7", "10", "11", "13", "14", "16", "17", "19", "J", "d1", "D2", "d3")
    numbers = {name.rsplit("_", 1)[-1] for name in vars(printed)}
    of_beam = [number for number in ROWS if number in numbers and number.isdigit() and int(number) > 20]
    assert sorted((*STATED, *INTEGRALS, *TERMS, *alone, *of_beam)) == sorted(ROWS)


@pytest.mark.parametrize("number", [row.number for row in ROWS.values() if row.misread])
def test_a_misread_line_is_the_line_with_other_dots(number: str) -> None:
    row = ROWS[number]
    assert len(row.shown) == len(row.lines)
    assert all(correct in "\n".join(row.lines) for correct, _ in row.misread)
    pairs = [[equation(line, row.scalars) for line in pair] for pair in zip(row.shown, row.lines, strict=True)]
    assert any(shown != line for shown, line in pairs)
    # What is mended are the dots of time, and two letters of J.
    without_dots = [[line.replace("'", "") for line in side] for side in (row.shown, row.lines)]
    assert (without_dots[0] == without_dots[1]) is (number != "J")
