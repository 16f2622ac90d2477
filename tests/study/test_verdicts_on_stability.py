"""Verdicts on the stability of models: beside a converged reference, and without one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_stability_of_models import FIRST, SECOND, lost_at, polynomials

from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.stability.chart import _description, frequency_line, growth_line
from derive.study.stability.eigenvalues import Eigenvalues
from derive.study.stability.ladder_stability import KnownLoss, LadderStability, distance
from derive.study.stability.model_path import ModelPath, PathPoint
from derive.study.stability.parameter import ParameterRange
from derive.study.stability.table import stability_data, stability_text
from derive.study.stability.thresholds import Interval, Threshold, wrong_intervals


def test_a_wrong_verdict_is_stable_where_the_truth_is_not_and_vice_versa() -> None:
    truth = (Interval(0, 2, True), Interval(2, 4, False))
    late = (Interval(0, 3, True), Interval(3, 4, False))
    early = (Interval(0, 1, True), Interval(1, 3.5, False), Interval(3.5, 4, None))
    assert wrong_intervals(late, truth) == (Interval(2, 3, True),)
    assert wrong_intervals(early, truth) == (Interval(1, 2, False),)
    assert wrong_intervals(truth, truth) == ()
    assert wrong_intervals(late, truth, least=1.0) == ()  # within the error of the truth
    of = LadderStability(
        "made",
        ParameterRange("P", 0, 4, 5),
        (),
        ModelPath(LadderModel(Shapes.RIGID)),
        ModelPath(LadderModel(Shapes.RIGID)),
    )
    for known, expected in (
        (2.0, truth),
        (None, (Interval(0, 4, True),)),
        (9.0, (Interval(0, 4, True),)),
        (-1.0, (Interval(0, 4, False),)),
    ):
        assert LadderStability(of.name, of.range, (), of.reference, of.before, KnownLoss(known)).truth == expected
    assert distance(3, 2) == 0.5 and distance(None, 2) is None and distance(3, 0.0) is None


@pytest.mark.parametrize(
    ("before", "reference", "why"),
    [
        (22.0, 20.0, "differs over more than 5 % of a threshold"),
        (None, 20.0, "2 beams, P2, P3, truncated keeps its stability"),
        (20.0, None, "2 beams, P2, P3, truncated loses it at 20"),
    ],
)
def test_without_a_converged_reference_verdicts_are_undecided(
    before: float | None, reference: float | None, why: str
) -> None:
    limits, models = ParameterRange("P", 0, 40, 5), (polynomials(2, SECOND, pieces=2), polynomials(4, SECOND, pieces=3))
    paths = lost_at(polynomials(2, FIRST), None), lost_at(polynomials(2, SECOND), 10.0)
    of = LadderStability("made", limits, paths, lost_at(models[1], reference), lost_at(models[0], before))
    assert not of.converged and not any(of.wrong(path) for path in paths)
    text = " ".join(stability_text(of).split())
    assert "the reference has not converged: " in text and why in text
    assert text.count("undecided") == len(paths) + 1 and "stable from" not in text
    data = stability_data(of)
    assert not data["reference"]["converged"] and [model["wrong"] for model in data["models"]] == [None] * 3
    assert "wrong somewhere" not in _description(of)
    given = LadderStability("made", limits, paths, of.reference, of.before, KnownLoss(20.0))
    assert given.converged and given.wrong(paths[1]) == (Interval(10.0, 20.0, False),)


def test_a_reference_without_steady_motion_at_some_values_has_not_converged_for_that_reason() -> None:
    limits, models = ParameterRange("P", 0, 40, 5), (polynomials(2, SECOND, pieces=2), polynomials(4, SECOND, pieces=3))
    gap = replace(lost_at(models[1], None), points=(PathPoint(40.0, None, failure="it is far away"),))
    text = " ".join(stability_text(LadderStability("made", limits, (), gap, lost_at(models[0], None))).split())
    assert "which keeps its stability where it moves steadily" in text
    assert "has not converged: no steady motion is known at some values of 3 beams, P2 to P5, truncated" in text


def test_with_a_converged_reference_verdicts_are_given() -> None:
    limits, models = ParameterRange("P", 0, 40, 5), (polynomials(2, SECOND, pieces=2), polynomials(4, SECOND, pieces=3))
    of = LadderStability("made", limits, (), lost_at(models[1], 20.0), lost_at(models[0], 20.5))
    assert of.converged and of.wrong(lost_at(polynomials(2, FIRST), None)) == (Interval(20.0, 40, True),)
    assert of.wrong(lost_at(polynomials(2, FIRST), 19.6)) == ()  # within the error of the reference


def test_lines_of_the_picture_keep_to_their_modes() -> None:
    """The lowest frequency ends where its mode begins to grow, and the second one goes on."""
    values = [np.array(x, dtype=complex) for x in ([2j, 5j], [1j, 6j], [1.5, -1.5, 7j])]
    points = tuple(PathPoint(float(n), Eigenvalues(v, np.full(len(v), 1e-9))) for n, v in enumerate(values))
    change = Threshold(1.2, 1.2, 0, 1)
    made = ModelPath(polynomials(2, FIRST), points=points, thresholds=(change,))
    assert frequency_line(made, 0) == ([0, 1], [2, 1])
    assert frequency_line(made, 1) == ([0, 1, 2], [5, 6, 7])
    assert frequency_line(made, 2) == ([], [])
    assert growth_line(made) == ([0, 1, 1.2, 2], [0, 0, 0, 1.5])
