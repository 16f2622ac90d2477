"""Ratios are printed in percent by one function."""

import re
from pathlib import Path

import pytest

import derive
from derive.percentages import percent

ROOT = Path(derive.__file__).parent


@pytest.mark.parametrize(
    ("ratio", "text", "signed"),
    [
        (0.0031, "0.31 %", "+0.31 %"),
        (0.01, "1 %", "+1 %"),
        (-0.0423, "-4.2 %", "-4.2 %"),
        (0.0996, "10 %", "+10 %"),
        (0.314, "31 %", "+31 %"),
        (1.0, "100 %", "+100 %"),
        (20.0, "2000 %", "+2000 %"),
        (1e-9, "0 %", "0 %"),
    ],
)
def test_two_significant_digits(ratio: float, text: str, signed: str) -> None:
    assert (percent(ratio), percent(ratio, signed=True)) == (text, signed)


def test_there_is_no_other_function_of_this_name() -> None:
    modules = [
        path.relative_to(ROOT).as_posix()
        for path in ROOT.rglob("*.py")
        if re.search(r"^def _?percent\w*\(", path.read_text(encoding="utf-8"), re.MULTILINE)
    ]
    assert modules == ["percentages.py"]
