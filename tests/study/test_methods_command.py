"""`tisserand study methods` as a user meets it: a line for each failure, tables, files, errors."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.runtime.integrators.compilation import LibraryMissing
from derive.simulation.errors import SimulationError
from derive.spec.model.beam_parts import BeamDamping
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene
from derive.spec.toml.read import read
from derive.study.methods import scene_methods
from derive.study.methods.failures import failure_table, failures
from derive.study.methods.method_study import MethodStudy, method_study
from derive.study.methods.methods_chart import MethodPanel, _growth, methods_svg, panels_svg
from derive.study.methods.methods_table import methods_data, methods_html, methods_text
from derive.study.methods.scene_methods import Method
from derive.study.variants import variant
from svg_text import text_boxes

FAILURES = ("explicit step limit", "index 3 drift")


def scene(pieces: int = 1) -> Scene:
    given = read(ROOT / "scenes/crank_slider_3.toml")
    assert isinstance(given, Scene)
    return replace(variant(given, pieces, "mean").scene, plots=())


def small() -> Scene:
    """The mechanism with a rod of one shape."""
    given = scene()
    bodies = (
        replace(b, beam=replace(b.beam, ansatz=b.beam.ansatz[:3])) if isinstance(b, BeamBody) else b
        for b in given.bodies
    )
    return replace(given, bodies=tuple(bodies))


@cache
def study() -> MethodStudy:
    methods = [Method.RK4, Method.ADAPTIVE, Method.GENERALISED_ALPHA, Method.TRAPEZOIDAL]
    return method_study(scene(), methods, 3000, 13, lambda _: None)


@pytest.mark.long
def test_every_failure_has_a_line_that_agrees_with_theory() -> None:
    lines = failures(study())
    assert tuple(line.failure for line in lines) == FAILURES
    assert [line.failure for line in lines if not line.agrees] == []
    text = methods_text(study())
    for line in lines:
        assert f"  {line.failure}: " in text
    assert text.count("agrees: ") == len(FAILURES) and "DIFFERS" not in text


@pytest.mark.long
def test_a_line_differs_where_its_measurement_does() -> None:
    """Each line alone, if what it measures is what it warns of."""
    s = study()
    assert s.order is not None
    worse = {
        "explicit step limit": replace(s, limits=(replace(s.limits[0], above=True), *s.limits[1:])),
        "index 3 drift": replace(s, order=replace(s.order, step=1.0)),
    }
    assert tuple(worse) == FAILURES
    for name, changed in worse.items():
        assert [line.failure for line in failures(changed) if not line.agrees] == [name]
        assert methods_text(changed).count("DIFFERS: ") == 1


@pytest.mark.long
def test_the_tables_and_the_files() -> None:
    s = study()
    text = methods_text(s)
    for title in (
        "largest stable step",
        "drift over 3000 steps",
        "formulations",
        "conditioning in 13 states",
    ):
        assert f"\n{title}" in text
    assert "trapezoidal, index 3" in text and "fails after" in text
    svg, page = methods_svg(s), methods_html(s)
    assert svg.startswith("<svg") and svg == methods_svg(s) and "mathdefault" not in svg
    assert "The rank of G along the motion" in svg and svg.count("not projected") == 2
    assert "no energies" not in svg
    damped = replace(s, conserved=False, drifts=tuple(replace(run, energy=run.energy[:0]) for run in s.drifts))
    shown = " ".join(box.text for box in text_boxes(methods_svg(damped)))
    assert "no energies: damping or loads change the energy of this scene as well" in shown
    assert "no energies: damping" in methods_text(damped)
    assert page.count("<h2>") == 5 and "http" not in page.replace("http://www.w3.org", "")
    rows = list(csv.DictReader(failure_table(failures(s)).csv.splitlines()))
    assert tuple(row["failure"] for row in rows) == FAILURES
    data: dict[str, Any] = json.loads(json.dumps(methods_data(s), allow_nan=False))
    assert data["limits"][2]["theory"] is None and data["drifts"][0]["projected"] is False
    assert [line["agrees"] for line in data["failures"]] == [True] * len(FAILURES)


def test_without_klu_the_rest_remains(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(_: object) -> None:
        raise LibraryMissing("SuiteSparse with KLU was not found. Install it")

    monkeypatch.setattr(scene_methods, "GeneralisedAlpha", missing)
    s = method_study(small(), [Method.RK4, Method.TRAPEZOIDAL], 50, 3, lambda _: None)
    assert [line.method for line in s.limits] == [Method.RK4]
    assert "generalised-alpha, trapezoidal: left out; SuiteSparse with KLU was not found" in methods_text(s)
    assert methods_svg(s)


def test_what_does_not_apply_to_a_scene_is_left_out_with_a_line() -> None:
    """Damping, and runs too short for a power: neither energies nor exponents; the limit is that without damping."""
    given = small()
    damped = [
        replace(b, beam=replace(b.beam, damping=BeamDamping(ratio=Fraction(1, 5)))) if isinstance(b, BeamBody) else b
        for b in given.bodies
    ]
    s = method_study(replace(given, bodies=tuple(damped)), [Method.RK4], 2, 3, lambda _: None)
    text = methods_text(s)
    assert "no energies: damping or loads" in text and "no powers of t where" in text
    limit = replace(s.limits[0], measured=1.2 * s.limits[0].predicted)
    slow = replace(s, period=1.0)  # steps resolve its motion
    (line, *_) = failures(replace(slow, limits=(limit,)))
    assert line.agrees is None and "this scene does not conserve energy" in line.measured
    assert "does not apply: rk4" in methods_text(replace(s, limits=(limit,)))
    (line, *_) = failures(replace(slow, limits=(limit,), conserved=True))
    assert line.agrees is False
    (line, *_) = failures(replace(s, limits=(limit,), conserved=True, period=1e-3))
    assert line.agrees is None and "resolve neither the motion of 0.001 s" in line.measured
    assert methods_svg(s) and methods_html(s) and json.dumps(methods_data(s), allow_nan=False)


def test_runs_that_do_not_fit_into_memory_are_refused() -> None:
    with pytest.raises(
        SimulationError, match=r"the rows of 20000000 steps need 2.24 GB; give at most 17857142 --steps"
    ):
        method_study(small(), [Method.RK4], 20_000_000, 3, lambda _: None)


def test_a_scene_that_does_not_vibrate_has_no_limit_of_steps() -> None:
    given = scene()
    rigid = replace(given, bodies=tuple(b for b in given.bodies if b.name == "slider"), joints=(), drives=())
    s = method_study(rigid, [Method.RK4], 10, 3, lambda _: None)
    text = methods_text(s)
    assert s.limits == () and "largest stable step: left out; nothing vibrates" in text
    assert "explicit step limit" not in text and methods_svg(s).count("Explicit steps have a limit") == 0
    assert json.dumps(methods_data(s), allow_nan=False)


PENDULUM = """
name = "rigid_pendulum"
[scene]
gravity = [0, -9.81]
[ground.markers]
bearing = [0, 0]
[bodies.upper]
mass = 1
inertia = 0.0833
markers = { hub = [-0.5, 0], tip = [0.5, 0] }
start = { position = [0.5, 0] }
[bodies.lower]
mass = 1
inertia = 0.0833
markers = { hub = [-0.5, 0] }
start = { position = [1.5, 0] }
[joints.bearing]
kind = "revolute"
between = ["ground.bearing", "upper.hub"]
[joints.pin]
kind = "revolute"
between = ["upper.tip", "lower.hub"]
[simulation]
duration = 2
output = 0.01
"""


@pytest.mark.long
def test_the_methods_of_a_rigid_mechanism(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A double pendulum: no limit of steps, which resolve the motion; drift, formulations and conditioning."""
    (tmp_path / "pendulum.toml").write_text(PENDULUM)
    asked = ["--steps", "1000", "--states", "5", "--out", str(tmp_path), "--json"]
    assert main(["study", "methods", str(tmp_path / "pendulum.toml"), *asked]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["limits"] == [] and data["conserved"] is True and 1e-3 < data["h"] < 0.05
    assert data["frequency"]["unloaded"] == 0 < data["frequency"]["largest"]
    assert [note for note in data["notes"] if "which do not resolve the motion" in note]
    free, projected = data["drifts"][:2]
    assert not free["projected"] and projected["projected"] and projected["failure"] == ""
    assert projected["position"][-1] < 1e-12 < 1e-6 < free["position"][-1]
    assert projected["energy"][-1] < 1e-3
    index3, _, stabilised, *_ = data["forms"]
    assert index3["rule"] == "trapezoidal rule" and index3["late"] > 100 * stabilised["late"]  # the multipliers ring
    assert data["order"]["step"] == pytest.approx(4, abs=0.3)


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = str(ROOT / "scenes/spinning_beam.toml")
    asked = ["--steps", "500", "--states", "5", "--integrators", "rk4", "--out", str(tmp_path), "--json"]
    assert main(["study", "methods", spec, *asked, "--set", "simulation.output=0.02"]) == 0
    said = capsys.readouterr()
    data = json.loads(said.out)
    assert data["set"] == data["notes"][:1] and data["set"][0].endswith("-> 0.02")
    assert said.err == "" and data["files"] == [
        str(tmp_path / f"methods.{kind}") for kind in ("svg", "html", "csv", "json")
    ]
    assert data["frequency"]["unloaded"] == pytest.approx(91.65, abs=0.01)
    assert [limit["method"] for limit in data["limits"]] == ["rk4"] and data["forms"] == []
    assert "index 3 drift" not in [line["failure"] for line in data["failures"]]  # there are no constraints
    record = json.loads((tmp_path / "methods.json").read_text())
    assert record["files"]["methods.csv"] and record["generator"].startswith("Generated by Tisserand")


@pytest.mark.parametrize(
    "wrong", [["--steps", "0"], ["--states", "1"], ["--integrators", "rk5"], ["--integrators", "dop853"]]
)
def test_wrong_arguments(wrong: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["study", "methods", str(ROOT / "scenes/spinning_beam.toml"), *wrong])
    assert stopped.value.code == 2 and wrong[0] in capsys.readouterr().err


def test_where_nothing_can_be_written_is_known_before_the_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("derive.study.methods.scene_methods.generated", None)
    (tmp_path / "file").write_text("mine")
    spec = str(ROOT / "scenes/spinning_beam.toml")
    assert main(["study", "methods", spec, "--out", str(tmp_path / "file" / "x")]) == 2
    assert "this is a file, not a folder; choose another --out" in capsys.readouterr().err


def test_names_and_numbers_of_the_limits_do_not_overlap() -> None:
    """The names of the implicit methods have room between the numbers at the limits of the explicit ones."""
    limits = [
        SimpleNamespace(method=method, theory=limit, measured=limit)
        for method, limit in ((Method.RK4, 2.828), (Method.ADAPTIVE, 5.79))
    ]
    made_up = cast(Any, SimpleNamespace(limits=limits, frequency=SimpleNamespace(largest=1)))
    svg = panels_svg("limits", [MethodPanel("steps", "", lambda axes: _growth(axes, made_up))])
    places = {box.text: box for box in text_boxes(svg)}
    name, number = places["trapezoidal"], places["5.79"]
    assert number.right > name.right and name.right < number.left


def test_a_drift_of_lower_order_at_a_kink_is_no_contradiction() -> None:
    """A step across the end of `step` is of third order: where it is measured, the line names the time."""
    of = derive.scene(
        "crank",
        gravity=(0, -9.81),
        ground={"hub": (0, 0)},
        bodies={
            "arm": {"mass": 1, "inertia": "0.1", "markers": {"hub": (0, 0), "end": (1, 0)}},
            "rod": {
                "mass": 1,
                "inertia": 1,
                "markers": {"top": (-1.5, 0), "foot": (1.5, 0)},
                "start": {"position": (2.5, 0)},
            },
            "foot": {"mass": 1, "inertia": 1, "markers": {"pin": (0, 0)}, "start": {"position": (4, 0)}},
        },
        joints={
            "hub": {"kind": "revolute", "between": ["ground.hub", "arm.hub"]},
            "elbow": {"kind": "revolute", "between": ["arm.end", "rod.top"]},
            "pin": {"kind": "revolute", "between": ["rod.foot", "foot.pin"]},
            "guide": {"kind": "translational", "between": ["ground.hub", "foot.pin"], "axis": (1, 0)},
        },
        drives={"motor": {"joint": "hub", "speed": "20*step(t, 0, 0.11)"}},
        simulation={"duration": "0.4", "output": "0.01"},
    )
    result = derive.study_methods(of, integrators=["rk4"], steps=200, states=3)
    assert result.order is not None and result.order.kinks == (0.11,)
    lower = replace(result.order, step=3.1)
    (line,) = failures(replace(result, order=lower))
    assert line.agrees is None and "functions of time have kinks at t = 0.11 s" in line.measured
    (line,) = failures(replace(result, order=replace(lower, kinks=())))
    assert line.agrees is False
