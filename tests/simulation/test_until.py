"""Conditions that end a simulation: what they may contain, and the time at which they are met."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.runtime.native_scene import NativeScene
from derive.simulation.integration.stop_event import StopEvent
from derive.spec.parsing.condition import condition
from derive.spec.parsing.parser import ExpressionError
from explicit_motion import moved

BEAM = replace(
    derive.planar_beam("falling", gravity=[0, "-9.81"]),
    start=derive.InitialValues(velocity=(1.0, 2.0)),
    simulation=derive.Simulation(3.0, 0.1, 1e-10),
)


def test_the_run_ends_where_a_coordinate_crosses_a_value() -> None:
    """2 t - 9.81 t^2 / 2 returns to 0 at 4 / 9.81 s; that it is 0 at the start does not count."""
    end = 4 / 9.81
    for text in ("beam_c2 = 0", "beam_c2 < 0", "t > 1/2 + t + beam_c2 - 0.5"):
        found = moved(BEAM, until=text)
        assert found.t[-1] == pytest.approx(end, abs=1e-9)
        np.testing.assert_allclose(found.t[:-1], [0, 0.1, 0.2, 0.3, 0.4], atol=1e-15)
        assert found.q.shape[0] == found.lam.shape[0] == 6 and abs(found["beam_c2"][-1]) < 1e-9
        anew = " anew" if "=" in text else ""
        assert found.solution.notes[-1].startswith(f"until {text}: met{anew} at t = 0.40774719")
        assert len(found.solution.notes) == (2 if anew else 1)


def test_a_condition_that_is_never_met_is_reported() -> None:
    found = moved(replace(BEAM, simulation=derive.Simulation(0.2, 0.1, until="beam_c1 > 5")))
    assert found.t[-1] == 0.2 and found.solution.notes == ("until beam_c1 > 5: not met up to t = 0.2 s",)


def test_unknown_columns_are_refused() -> None:
    with pytest.raises(derive.SpecError, match=r'simulation.until: .*no column "beam_c3"; did you mean "beam_c'):
        moved(BEAM, until="beam_c3 < 0")


def test_columns_of_a_state_are_computed_from_the_state_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """The result is to the bit that from a whole row."""
    calls: list[float] = []
    solve = NativeScene.solve
    monkeypatch.setattr(NativeScene, "solve", lambda self, t, *rest: (calls.append(t), solve(self, t, *rest))[1])
    quick = moved(BEAM, until="beam_c2 + beam_phidot*t < 0")
    assert not any(calls)  # at the start monitors ask for the forces of vibrations
    monkeypatch.setattr("derive.simulation.prepared_run.state_columns", lambda scene, native, names: {})
    slow = moved(BEAM, until="beam_c2 + beam_phidot*t < 0")
    assert len(calls) > 50
    assert np.array_equal(quick.t, slow.t) and np.array_equal(quick.q, slow.q)


def event(crossing: bool = False) -> StopEvent:
    return StopEvent("x", lambda t, y: float(y[0]), crossing)


def test_a_condition_that_is_met_within_a_step_and_not_at_its_ends_is_found() -> None:
    """0.1 - (t - 0.5)^2 is positive between 0.5 -+ sqrt(0.1)."""
    dense = lambda t: np.array([0.1 - (t - 0.5) ** 2])  # noqa: E731
    assert event().time(0.0, 1.0, dense) == pytest.approx(0.5 - np.sqrt(0.1), abs=1e-14)
    assert event().time(0.6, 1.0, dense) is None  # it holds there already, and then no more
    assert event(crossing=True).time(0.6, 1.0, dense) == pytest.approx(0.5 + np.sqrt(0.1), abs=1e-14)


def test_zero_at_the_start_is_no_crossing() -> None:
    assert event(crossing=True).time(0.0, 1.0, lambda t: np.array([t])) is None
    assert event().time(0.0, 1.0, lambda t: np.array([t])) == pytest.approx(0.0, abs=1e-15)
    assert event().time(0.0, 1.0, lambda t: np.array([-t])) is None


@pytest.mark.parametrize("crossing", [True, False])
@pytest.mark.parametrize("at", [0.5, 0.3])
def test_the_condition_holds_where_the_run_ends(crossing: bool, at: float) -> None:
    """The function may be zero at one of the times at which it is evaluated. A run that goes on from there meets
    the condition no more."""
    dense = lambda t: np.array([t - at])  # noqa: E731
    stop = event(crossing).time(0.0, 1.0, dense)
    assert stop == pytest.approx(at, abs=1e-15)
    assert event(crossing).holds(stop - at) or stop > at
    assert event(crossing).time(stop, 1.0, dense) is None


@pytest.mark.parametrize(
    ("text", "row", "positive"),
    [
        ("a > b", {"a": 2.0, "b": 1.0}, True),
        ("a < b", {"a": 2.0, "b": 1.0}, False),
        ("sqrt(a^2 + b^2) >= 5", {"a": 3.0, "b": 4.1}, True),
        ("-a*exp(b)/2 > -pi", {"a": 1.0, "b": 0.0}, True),
        ("cos(pi) > a - 1", {"a": 0.5}, False),
    ],
)
def test_conditions_are_comparisons_of_columns(text: str, row: dict[str, float], positive: bool) -> None:
    found = condition(text, row)
    assert (found.value(row) > 0) is positive and found.names == frozenset(row)


@pytest.mark.parametrize("text", ["a", "a > b > c", "a = ", "__import__('os') > 1", "a.b > 1", "f(a) > 1", "a > 1; b"])
def test_anything_else_is_refused(text: str) -> None:
    with pytest.raises(ExpressionError):
        condition(text)
    with pytest.raises(derive.SpecError, match=r"simulation\.until"):
        moved(BEAM, until=text)


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["simulate", str(ROOT / "scenes/free_beam_mean.toml"), "--out", str(tmp_path), "--duration", "2"]
    options = ["--output", "0.5", "--set", "beam.start.spin=1", "--until", "beam_phi > 1"]
    assert main([*arguments, *options]) == 0
    assert "  note: until beam_phi > 1: met at t = 1 s" in capsys.readouterr().out
