"""The samples of a sweep as text: grids, lists, distributions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from derive.study.sweep.samples import SamplesError, grid, listed, normal, parsed_samples, random_samples, uniform


def test_grids_and_lists() -> None:
    samples = parsed_samples([("EI", "10:100:4"), ("speed", "50,75"), ("m", "2")], None, None)
    assert samples.names == ("EI", "speed", "m") and samples.shape == (4, 2, 1) and samples.varying == ("EI", "speed")
    assert samples.values[:3].tolist() == [[10, 50, 2], [10, 75, 2], [40, 50, 2]] and len(samples) == 8
    assert parsed_samples([("EI", "1:100:3:log")], None, None).values.ravel().tolist() == pytest.approx([1, 10, 100])
    one_by_one = listed({"EI": [1, 2, 3], "m": 4})
    assert one_by_one.values.tolist() == [[1, 4], [2, 4], [3, 4]] and one_by_one.shape == ()


def test_random_samples_follow_from_the_seed() -> None:
    text = [("EI", "uniform(10, 20)"), ("m", "normal(1,0.1)"), ("l", "3"), ("d", "loguniform(1,100)")]
    samples = parsed_samples(text, 2000, 7)
    assert samples.values.tobytes() == parsed_samples(text, 2000, 7).values.tobytes()
    assert samples.values.tobytes() != parsed_samples(text, 2000, 8).values.tobytes()
    assert samples.values[:5].tobytes() == parsed_samples(text, 5, 7).values.tobytes()
    stiffness, mass, length, damping = samples.values.T
    assert 10 < stiffness.min() < 10.1 and 19.9 < stiffness.max() < 20 and abs(stiffness.mean() - 15) < 0.2
    assert abs(mass.mean() - 1) < 0.01 and abs(mass.std() - 0.1) < 0.01
    assert set(length) == {3} and abs(np.log10(damping).mean() - 1) < 0.05
    assert random_samples({"x": uniform(0, 1)}, 3).values.ravel().tolist() == [
        0.8444218515250481, 0.7579544029403025, 0.420571580830845,
    ]  # fmt: skip
    assert normal(0, 1).quantile(0.975) == pytest.approx(1.959964, rel=1e-6)


@pytest.mark.parametrize(
    ("text", "count", "message"),
    [
        ([("EI", "10:20")], None, "expected start:stop:count such as 10:100:40"),
        ([("EI", "10:20:0")], None, "expected start:stop:count"),
        ([("EI", "10:20:1")], None, "one value cannot be at both ends"),
        ([("EI", "10:20:5:lin")], None, "expected start:stop:count"),
        ([("EI", "-1:20:5:log")], None, "both ends have to be positive"),
        ([("EI", "1,2,inf")], None, "expected start:stop:count"),
        ([("EI", "gauss(1,2)")], 5, "normal"),
        ([("EI", "uniform(1)")], 5, "uniform"),
        ([("EI", "normal(1,0)")], 5, "a positive standard deviation"),
        ([("EI", "1,2"), ("EI", "3")], None, "EI: several sets of values"),
        ([("EI", "1,2,1")], None, "EI: a value of the grid is given twice"),
        ([("EI", "uniform(1,2)")], None, "add --samples N"),
        ([("EI", "1,2")], 5, "--samples and --seed are for random values"),
        ([("EI", "1,2"), ("m", "uniform(1,2)")], 5, "EI has 2 values and m is random"),
    ],
)
def test_what_makes_no_sense(text: list[tuple[str, str]], count: int | None, message: str) -> None:
    with pytest.raises(SamplesError) as error:
        parsed_samples(text, count, None)
    assert message in str(error.value)


def test_columns_of_different_lengths() -> None:
    with pytest.raises(SamplesError, match="the same number of values"):
        listed({"EI": [1, 2], "m": [1, 2, 3]})
    with pytest.raises(SamplesError, match=r"need an array \(n, 1\)"):
        grid({"EI": []})


def test_a_table_of_samples(tmp_path: Path) -> None:
    path = tmp_path / "samples.csv"
    path.write_text("EI, drives.motor.speed\n10,100\n\n12.5,90\n")
    samples = parsed_samples([("m", "2")], None, None, path)
    assert samples.names == ("EI", "drives.motor.speed", "m") and samples.shape == ()
    assert samples.values.tolist() == [[10, 100, 2], [12.5, 90, 2]]


@pytest.mark.parametrize(
    ("text", "assignments", "message"),
    [
        ("EI,m\n1,2\n3\n", [], "samples.csv:3: 2 numbers are needed, not 3"),
        ("EI,m\n1,x\n", [], "samples.csv:2: 2 numbers are needed, not 1, x"),
        ("EI,EI\n1,2\n", [], "samples.csv:1: each column needs a name of its own"),
        ("EI\n", [], "samples.csv: a line of names and a line of numbers for each sample are needed"),
        ("EI\n1\n", [("EI", "2")], "EI: beside --list, --set takes one number for a name that is not in the file"),
        ("EI\n1\n", [("m", "2,3")], "m: beside --list, --set takes one number"),
    ],
)
def test_tables_that_make_no_sense(tmp_path: Path, text: str, assignments: list[tuple[str, str]], message: str) -> None:
    path = tmp_path / "samples.csv"
    path.write_text(text)
    with pytest.raises(SamplesError) as error:
        parsed_samples(assignments, None, None, path)
    assert message in str(error.value)


def test_values_are_needed() -> None:
    with pytest.raises(SamplesError, match="no values to sweep over"):
        parsed_samples([], None, None)


def test_more_samples_than_a_sweep_takes_are_refused_before_they_take_memory() -> None:
    text = "more than the 1000000 that a sweep takes"
    with pytest.raises(SamplesError, match=f"1000000000 samples are {text}"):
        parsed_samples([("EI", "1:2:1000000000")], None, None)
    with pytest.raises(SamplesError, match=f"1002000 samples are {text}"):
        parsed_samples([("EI", "1:2:1002"), ("m", "1:2:1000")], None, None)
    with pytest.raises(SamplesError, match=f"1000000000 samples are {text}"):
        parsed_samples([("EI", "uniform(1, 2)")], 1_000_000_000, None)
    assert len(parsed_samples([("EI", "1:2:1000"), ("m", "1:2:1000")], None, None)) == 1_000_000
