"""A body whose functions loop over its modes moves as one in straight-line code, with the same columns."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from conftest import ROOT
from derive.cli.main import main


def table(out: Path) -> dict[str, list[float]]:
    with (out / "block" / "block.csv").open() as file:
        names, *rows = csv.reader(file)
    return {name: list(map(float, column)) for name, column in zip(names, zip(*rows, strict=True), strict=True)}


@pytest.mark.long
def test_columns_and_numbers_are_the_same(tmp_path: Path) -> None:
    (tmp_path / "block.npz").symlink_to(ROOT / "scenes" / "block.npz")
    text = (ROOT / "scenes" / "block.toml").read_text()
    for form in ("flat", "loops"):
        spec = tmp_path / f"{form}.toml"
        spec.write_text(text.replace("modes = 8 ", f'lowering = "{form}"\nmodes = 3 '))
        arguments = ["simulate", str(spec), "--output", "1e-5", "--out", str(tmp_path / form)]
        assert main([*arguments, "--duration", "5e-5"]) == 0
        assert main([*arguments, "--duration", "1e-4", "--resume"]) == 0
    flat, looped = table(tmp_path / "flat"), table(tmp_path / "loops")
    assert list(looped) == list(flat) and {"alpha1", "alpha3dot"} <= set(looped) and len(looped["t"]) == 11
    for name, values in looped.items():
        assert values == pytest.approx(flat[name], rel=1e-6, abs=1e-12), name
