"""Plots of columns of a trajectory over each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.simulation.observables.plots import plot_curves, plot_text
from derive.spec.model.plots import ColumnCurves, Plot
from derive.visual.line_chart import svg
from derive.visual.plot_chart import plot_chart

SCENE = derive.read(ROOT / "scenes/double_pendulum.toml")
TABLES = {
    "name": "two",
    "bodies": {"a": {"mass": 1, "inertia": 1}},
    "simulation": {"duration": 1, "output": 0.1},
}


@pytest.fixture(scope="module")
def trajectory() -> derive.Trajectory:
    return derive.simulate(replace(SCENE, plots=()), duration=0.1, output=0.01)


def test_any_column_over_any_other(trajectory: derive.Trajectory) -> None:
    plot = Plot("phase", ColumnCurves(("upper_phidot",), "upper_phi"))
    (curve,) = plot_curves(plot, trajectory, "")
    np.testing.assert_array_equal(curve.x, trajectory["upper_phi"])
    np.testing.assert_array_equal(curve.y, trajectory["upper_phidot"])
    chart = plot_chart("two", plot, plot_text(plot, SCENE, trajectory.units), [curve])
    assert (chart.x_label, chart.x_unit) == ("upper_phi", "rad")
    assert "upper_phi, rad</text>" in svg(chart) and "upper_phidot, rad/s</text>" in svg(chart)


def test_columns_of_a_unit_share_an_axis(trajectory: derive.Trajectory) -> None:
    """Columns of other units have axes of their own, below each other, in the order of the file."""
    same = Plot("same", ColumnCurves(("upper_phi", "lower_phi")))
    curves = plot_curves(same, trajectory, "3 beams")
    assert [curve.label for curve in curves] == ["3 beams: upper_phi", "3 beams: lower_phi"]
    (panel,) = plot_chart("same", same, plot_text(same, SCENE, trajectory.units), curves).panels
    assert (panel.y_label, panel.unit, len(panel.curves)) == ("upper_phi, lower_phi", "rad", 2)
    differ = Plot("differ", ColumnCurves(("upper_phi", "lower_phidot", "lower_phi")))
    curves = plot_curves(differ, trajectory, "")
    assert [(curve.label, curve.unit) for curve in curves] == [
        ("upper_phi", "rad"), ("lower_phidot", "rad/s"), ("lower_phi", "rad")
    ]  # fmt: skip
    chart = plot_chart("differ", differ, plot_text(differ, SCENE, trajectory.units), curves)
    assert [(p.unit, p.y_label) for p in chart.panels] == [("rad", "upper_phi, lower_phi"), ("rad/s", "lower_phidot")]
    assert "upper_phi, lower_phi, rad</text>" in svg(chart) and "lower_phidot, rad/s</text>" in svg(chart)


def test_unknown_columns_are_found_before_the_integration() -> None:
    plots = (Plot("a", ColumnCurves(("upper_phy", "lower_phi"))), Plot("b", ColumnCurves(("upper_phi",), "x")))

    def integrated(_: float) -> None:
        raise AssertionError("the integration has begun")

    with pytest.raises(derive.SpecError) as error:
        derive.simulate(replace(SCENE, plots=plots), progress=integrated)
    assert [problem.path for problem in error.value.problems] == ["plots.a.y", "plots.b.x"]
    assert 'did you mean "upper_phi"?' in error.value.problems[0].message
    assert "the columns are t, upper_c1" in error.value.problems[1].message


def test_tables_of_columns_are_read_and_written() -> None:
    given = {"plots": {"phase": {"x": "a_phi", "y": "a_phidot"}, "both": {"y": ["a_c1", "a_c2"]}}}
    scene = derive.scene({**TABLES, **given})
    assert [plot.quantity for plot in scene.plots] == [
        ColumnCurves(("a_phidot",), "a_phi"),
        ColumnCurves(("a_c1", "a_c2"), "t"),
    ]
    assert derive.validated(scene) == scene


@pytest.mark.parametrize(
    ("plot", "message"),
    [
        ({"x": "a_phi"}, 'plots.p.y: this key is missing; write y = "rod_phi"'),
        ({"y": []}, "plots.p.y: there are 0 columns, and 1 to 12 are allowed"),
        ({"y": 3}, "plots.p.y: a column or a list of columns is needed"),
        ({"y": "a_c1", "over": "m"}, "plots.p.over: unknown key"),
        ({"y": "a_c1", "pieces": [1]}, "plots.p: `cut` and `pieces` go together"),
        ({"chord": []}, "plots.p.deflection: this key is missing"),
    ],
)
def test_wrong_tables(plot: dict[str, object], message: str) -> None:
    with pytest.raises(derive.SpecError) as error:
        derive.scene({**TABLES, "plots": {"p": plot}})
    assert message in str(error.value)
