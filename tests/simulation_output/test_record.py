"""The CSV of a motion: names, units, numbers that come back."""

from __future__ import annotations

import io
import os
from importlib import import_module

import numpy as np
import pytest

from derive.simulation.observables.csv_writer import Column, csv

COLUMNS = [
    Column("t", "s", np.array([0.0, 1e-4, 0.2])),
    Column("rod_phi", "rad", np.array([-0.0, -1 / 3, 1e-300])),
    Column("guide", "N", np.array([12345.678901234, -7e20, 0.5])),
]


def test_header_and_values() -> None:
    lines = csv(COLUMNS).splitlines()
    assert lines[0] == "t,rod_phi,guide"
    assert lines[1] == "0.0000000000e+00,0.0000000000e+00,1.2345678901e+04"  # no -0
    assert lines[2] == "1.0000000000e-04,-3.3333333333e-01,-7.0000000000e+20"
    assert len(lines) == 4


def test_it_reads_back_as_it_says() -> None:
    table = np.genfromtxt(io.StringIO(csv(COLUMNS)), names=True, delimiter=",")
    assert table.dtype.names == ("t", "rod_phi", "guide")
    for column in COLUMNS:
        np.testing.assert_allclose(table[column.name], column.values, rtol=1e-10)


def test_pandas_reads_it_with_its_defaults() -> None:
    pandas = import_module("pandas") if os.environ.get("CI") else pytest.importorskip("pandas")
    table = pandas.read_csv(io.StringIO(csv(COLUMNS)))
    assert [*table] == ["t", "rod_phi", "guide"] and {str(kind) for kind in table.dtypes} == {"float64"}
    for column in COLUMNS:
        np.testing.assert_allclose(table[column.name], column.values, rtol=1e-10)
