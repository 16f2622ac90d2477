"""The CSV of a motion: names, units, numbers that come back."""

from __future__ import annotations

import io

import numpy as np

from derive.artifacts import MARK
from derive.simulation.observables.csv_writer import Column, csv

COLUMNS = [
    Column("t", "s", np.array([0.0, 1e-4, 0.2])),
    Column("rod_phi", "rad", np.array([-0.0, -1 / 3, 1e-300])),
    Column("guide", "N", np.array([12345.678901234, -7e20, 0.5])),
]


def test_header_and_values() -> None:
    lines = csv("The motion of\nx.", COLUMNS).splitlines()
    assert lines[0] == f"# {MARK}. The motion of x."
    assert lines[1] == "# units: s,rad,N"
    assert lines[2] == "t,rod_phi,guide"
    assert lines[3] == "0.0000000000e+00,0.0000000000e+00,1.2345678901e+04"  # no -0
    assert lines[4] == "1.0000000000e-04,-3.3333333333e-01,-7.0000000000e+20"
    assert len(lines) == 6


def test_it_reads_back_as_it_says() -> None:
    table = np.genfromtxt(io.StringIO(csv("", COLUMNS)), delimiter=",", names=True, skip_header=2)
    assert table.dtype.names == ("t", "rod_phi", "guide")
    for column in COLUMNS:
        np.testing.assert_allclose(table[column.name], column.values, rtol=1e-10)
