"""Observables of a motion: positions, deflections, drives, deviations from a reference."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import slider

from derive.percentages import percent
from derive.simulation.observables.beams import piece_at, relative_deflection
from derive.simulation.observables.marker_positions import marker_positions
from derive.simulation.observables.motion import deviation, drive_values, function_values
from derive.simulation.observables.plots import PlotCurve, plot_curve, plot_text
from derive.simulation.output_times import output_times
from derive.spec.model.joints import Drive
from derive.spec.model.markers import MarkerRef
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.plots import ReferenceCurve
from derive.spec.model.simulation import Simulation
from derive.spec.model.time_function import TimeFunction
from derive.visual.line_chart import svg
from derive.visual.plot_chart import plot_chart

T = TimeFunction("t")


def test_places_of_every_kind_of_body() -> None:
    motion = slider.motion(3, 11)
    angle = slider.SPEED * motion.t
    pin = 0.15 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    np.testing.assert_allclose(marker_positions(motion, MarkerRef("crank", "pin")), pin, atol=1e-15)
    np.testing.assert_allclose(
        marker_positions(motion, MarkerRef("rod", "left")), pin, atol=1e-4
    )  # as far as shapes can
    np.testing.assert_allclose(marker_positions(motion, MarkerRef("slider", "pin"))[:, 1], 0, atol=0)
    assert not marker_positions(motion, MarkerRef("ground", "bearing")).any()


@pytest.mark.parametrize(("count", "most"), [(1, 0.04), (3, 1e-3)])
def test_deflection_is_to_the_left_of_the_chord(count: int, most: float) -> None:
    motion = slider.motion(count, 201)
    shown = plot_curve(motion.scene.plots[0], motion, "")
    wanted = slider.deflection(shown.x) / 0.3
    assert np.abs(shown.y - wanted).max() < most * wanted.max()
    assert shown.x[-1] == pytest.approx(15)
    assert shown.error is not None and 0 < shown.error[0] < shown.error[1] < most
    assert shown.largest[0] > 0.01 > -0.01 > shown.least[0]


def test_pieces_of_a_rod() -> None:
    rod = next(b for b in slider.scene(3).bodies if isinstance(b, BeamBody))
    assert [piece_at(rod, Fraction(at)) for at in (-1, 0, 1)] == [(0, -1), (1, 0), (2, 1)]
    assert piece_at(replace(rod, pieces=2), Fraction(0)) == (0, 1)


@pytest.mark.parametrize("count", [1, 3])
def test_bending_is_that_of_a_piece(count: int) -> None:
    """Half a sine of 0.018 of the length: from its mean, and of the middle third of it."""
    motion = slider.motion(count, 201)
    rod = next(b for b in motion.scene.bodies if isinstance(b, BeamBody))
    most = np.abs(slider.deflection(slider.SPEED * motion.t)).max() / slider.ROD
    part = most * (1 - np.sin(np.pi / 2 / count) / (np.pi / 2 / count)) * count
    ends = most * (np.sin(np.pi / 2 / count) / (np.pi / 2 / count) - np.cos(np.pi / 2 / count)) * count
    assert relative_deflection(motion, rod) == pytest.approx(max(part, ends), rel=0.1)


def test_drives_are_functions_of_time() -> None:
    t = np.array([0.0, 0.5, 1.0])
    two = TimeFunction("number", value=Fraction(2))
    motion = TimeFunction("add", (TimeFunction("pow", (T, two)), TimeFunction("sin", (TimeFunction("neg", (T,)),))))
    np.testing.assert_allclose(function_values(motion, t), t**2 - np.sin(t))
    np.testing.assert_allclose(drive_values(Drive("m", "j", two), t), [2, 2, 2])
    np.testing.assert_allclose(drive_values(Drive("m", "j", None, Fraction(3), Fraction(1)), t), 1 + 3 * t)


def test_deviation_is_of_the_peak_and_where_both_are() -> None:
    reference = ReferenceCurve("r.csv", "x", "y", ((0, 0), (1, 2), (2, -4), (9, 1)))
    x, y = np.array([0.0, 2.0]), np.array([0.4, 0.4])
    for sign in (1, -1):
        at, off = deviation(x[::sign], y[::sign], reference)
        assert at.tolist() == [0, 1, 2]
        np.testing.assert_allclose(off, [0.1, -0.4, 1.1])
    assert deviation(np.array([0, 2.0, 1.0]), np.zeros(3), reference) is None
    assert deviation(np.array([3.0, 4.0]), np.zeros(2), reference) is None


def test_curves_are_cubic_between_their_points() -> None:
    x = np.array([0.0, 1.0, 3.0, 4.0, 5.0])
    reference = ReferenceCurve("r.csv", "x", "y", ((0.5, 0.0), (2.0, 0.0), (4.5, 1.0)))
    _, off = deviation(x, x**3 - x, reference) or pytest.fail("no point in common")
    np.testing.assert_allclose(off, [0.125 - 0.5, 6.0, 4.5**3 - 5.5])


def test_rows_end_with_the_duration() -> None:
    assert len(output_times(Simulation(0.1, 1e-4))) == 1001
    assert output_times(Simulation(0.1, 1e-4))[-1] == 0.1
    np.testing.assert_allclose(output_times(Simulation(0.25, 0.1)), [0, 0.1, 0.2, 0.25])
    np.testing.assert_allclose(output_times(Simulation(0.05, 0.1)), [0, 0.05])


def test_the_legend_tells_errors() -> None:
    motion = slider.motion(2, 101)
    plot = motion.scene.plots[0]
    shown = plot_curve(plot, motion, "2 beams")
    text = svg(plot_chart("slider", plot, plot_text(plot, motion.scene, {}), [shown]))
    rms, most = shown.error or (0, 0)
    assert f"2 beams: rms {percent(rms)}, max {percent(most)}" in text
    assert "reference: given.csv" in text and "angle of motor, rad" in text and "deviation," in text
    alone = replace(plot, reference=None, over=None, cut=None, pieces=())
    words = plot_text(alone, motion.scene, {})
    text = svg(plot_chart("slider", alone, words, [plot_curve(alone, motion, "rod.middle")]))
    assert "reference" not in text and "time, s" in text and "deviation," not in text


def test_an_extreme_of_zero_has_no_sign():
    curve = PlotCurve("P", np.array([0.0, 1.0]), np.array([-0.0, -2.0]), None)
    assert [str(value) for value in curve.largest] == ["0.0", "0.0"]
