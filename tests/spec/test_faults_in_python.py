"""Errors of values in Python: they name no file and no line, and survive the way between processes."""

import pickle

import pytest
from test_faults import beam, errors

from derive.errors import Problem, SpecError
from derive.spec.construction.bodies import planar_beam


def test_an_error_in_python_has_no_file_and_no_line():
    with pytest.raises(SpecError) as caught:
        planar_beam("b", mass=-1, markers={"a": 2.5})
    assert caught.value.source is None
    assert caught.value.problems == (
        Problem("beam.mass", "a positive number is needed, not -1"),
        Problem("beam.markers.a", "xi = 5/2 is not on the beam: it goes from -1, the left end, to 1, the right end"),
    )
    assert str(caught.value).startswith("beam.mass: a positive number is needed, not -1\nbeam.markers.a: ")


@pytest.mark.parametrize(
    ("keywords", "path"),
    [
        ({"ansatz": "xi"}, "beam.ansatz"),
        ({"ansatz": {"xi^2", "xi^3"}}, "beam.ansatz"),
        ({"ansatz": None}, "beam.ansatz"),
        ({"ansatz": [(True, 1, 2)]}, "beam.ansatz[0]"),
        ({"ansatz": [(0, 0)]}, "beam.ansatz[0]"),
        ({"ansatz": [(0,) * 41 + (1,)]}, "beam.ansatz[0]"),
        ({"frame": 1}, "beam.frame"),
        ({"frame": {1: 2, "kind": "mean"}}, "beam.frame[1]"),
        ({"mass": float("nan")}, "beam.mass"),
        ({"mass": 5e-324}, "beam.mass"),
        ({"mass": 1j}, "beam.mass"),
        ({"mass": 10**5000}, "beam.mass"),
        ({"markers": {3: 0}}, "beam.markers[3]"),
        ({"markers": {"a\nb": 0}}, 'beam.markers."a\\nb"'),
        ({"markers": ["a"]}, "beam.markers"),
        ({"orthogonal": 0}, "beam.orthogonal"),
    ],
)
def test_python_values_of_the_wrong_kind_are_spec_errors_too(keywords, path):
    with pytest.raises(SpecError) as caught:
        planar_beam("b", **keywords)
    assert [problem.path for problem in caught.value.problems] == [path]


def test_an_error_survives_the_way_between_processes():
    error = SpecError((Problem("a", "b", 3),), "c.toml")
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.problems) == ("c.toml:3: a: b", error.problems)


def test_nothing_of_a_user_breaks_a_line_of_an_error():
    (line,) = errors(beam('mass = "1\\n\\u2028\\u202E2"'))
    assert line.startswith('b.toml:3: beam.mass: column 4 of "1\\n\\u2028\\u202e2": "\\u202e" has no meaning')
