"""`tisserand study accuracy`: the ladder, what is worth its cost, the reference, and the chart that shows them."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from conftest import ROOT
from derive.cli.main import main
from derive.errors import SpecError
from derive.simulation.validity.monitors import Cause
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.planar_bodies import RigidBody
from derive.spec.model.scene import Scene
from derive.spec.toml.read import read
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.measurement import compiled, motion, plot_errors
from derive.study.accuracy.models import ladder, model_scene
from derive.study.accuracy.reference import compared_plot
from derive.study.study_options import LadderRange

SCENE = ROOT / "scenes" / "crank_slider_3.toml"
FIRST, TRUNCATED = DisplacementOrder.FIRST_ORDER, DisplacementOrder.TRUNCATED


@cache
def crank_slider() -> Scene:
    scene = read(SCENE)
    assert isinstance(scene, Scene)
    return scene


def test_a_ladder_goes_from_rigid_beams_to_many_coordinates() -> None:
    models = ladder(LadderRange(("first", "full"), ("mean", "chord"), (2, 4), (3,), (1,)))
    labels = [model.label for model in models]
    assert labels[0] == "rigid" and len(labels) == len(set(labels)) == 15
    assert labels[1:3] == ["1 sine, first", "1 sine, full"]
    assert "1 beam, P2 to P5, full" in labels and "1 beam, 4 shapes, chord, first" in labels
    assert labels[-1] == "3 beams, P2, P3, full"


def test_the_beams_of_a_scene_are_modelled() -> None:
    def rod(model: LadderModel) -> object:
        return next(body for body in model_scene(crank_slider(), model).bodies if body.name == "rod")

    rigid = rod(LadderModel(Shapes.RIGID))
    assert isinstance(rigid, RigidBody)
    mass, length = 0.0667557, 0.3
    assert float(rigid.mass) == pytest.approx(mass, rel=1e-5)  # type: ignore[arg-type]
    assert float(rigid.inertia) == pytest.approx(mass * length**2 / 12, rel=1e-5)  # type: ignore[arg-type]
    assert {m.name: float(m.x) for m in rigid.markers} == {"left": -0.15, "middle": 0, "right": 0.15}
    beam = rod(LadderModel(Shapes.POLYNOMIALS, 3, TRUNCATED, "mean", 2))
    assert (beam.pieces, len(beam.beam.ansatz), beam.beam.order) == (2, 5, TRUNCATED)  # type: ignore[attr-defined]


def test_plots_are_chosen_by_their_names() -> None:
    assert compared_plot(crank_slider(), None).name == "deflection"
    with pytest.raises(SpecError, match="did you mean"):
        compared_plot(crank_slider(), "deflexion")
    with pytest.raises(SpecError, match=r"a ladder compares a plot; add one, such as \[plots.tip\]"):
        compared_plot(replace(crank_slider(), plots=()), None)
    assert crank_slider().simulation is not None
    ends = replace(crank_slider(), simulation=replace(crank_slider().simulation, until="rod_phi > 1"))
    with pytest.raises(SpecError, match="leave `until` out"):
        compared_plot(ends, None)


@pytest.mark.parametrize("command", [["study", "accuracy"], ["choose"]])
def test_where_nothing_can_be_written_is_known_before_the_work(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nothing is derived, which would raise."""
    monkeypatch.setattr("derive.study.accuracy.measurement.generated", None)
    (tmp_path / "file").write_text("mine")
    assert main([*command, str(SCENE), "--out", str(tmp_path / "file" / "x")]) == 2
    assert "this is a file, not a folder; choose another --out" in capsys.readouterr().err


@pytest.mark.long
def test_one_sine_of_second_order_costs_little_and_is_right(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Set A: 0.27 % rms, for a tenth of the operations of two beams, which have 2.5 %."""
    asked = ["--orders", "truncated", "--shapes", "3", "--pieces", "2", "--sines", "1", "--tolerances", "1e-3,1e-5"]
    asked += ["--runs", "1", "--reference-error", "1e-4", "--out", str(tmp_path), "--json"]  # less than it has
    peers = tmp_path / "peers.csv"
    peers.write_text("model,cpu_s,rms_error,largest_error\ncables,0.03,0.0018,0.005\ncables,0.05,0.001,0.003\n")
    asked += ["--integrators", "rk4,generalised-alpha", "--peers", str(peers)]
    assert main(["study", "accuracy", str(SCENE), *asked]) == 0
    said = capsys.readouterr()
    assert said.err.startswith("4 models, about ") and "model 2 of 4: 1 sine, truncated: 0.27 % in " in said.err
    found = json.loads(said.out)
    stepped = {model["model"]: model for model in found["models"] if model["integrator"] != "adaptive"}
    models = {model["model"]: model for model in found["models"] if model["integrator"] == "adaptive"}
    best = {name: 100 * model["runs"][-1]["rms_error"] for name, model in models.items()}
    expected = {"rigid": 47.03, "1 sine": 0.268, "1 beam, P2 to P4": 0.068, "2 beams, P2, P3": 2.548}
    named = {name if name == "rigid" else f"{name}, truncated": error for name, error in expected.items()}
    assert best == pytest.approx(named, rel=0.01)
    assert not any(model["warning"] for model in models.values())  # a rigid body has no monitor
    sine, two = (models[name]["runs"][0] for name in ("1 sine, truncated", "2 beams, P2, P3, truncated"))
    assert two["evaluations"] > 7 * sine["evaluations"] and two["operations"] > 19 * sine["operations"]
    assert found["recommended"]["model"] == "1 sine, truncated"
    assert len(stepped) == 2 * len(models)
    for name, error in named.items():
        explicit, implicit = (stepped[f"{name}, {method}"]["runs"] for method in ("rk4", "generalised-alpha"))
        assert 100 * explicit[-1]["rms_error"] == pytest.approx(error, abs=0.35)  # of their steps
        assert explicit[0]["step_s"] == pytest.approx((8 if name == "rigid" else 4) * explicit[-1]["step_s"])
        assert explicit[-1]["operations"] > 3 * explicit[0]["operations"] and implicit[0]["operations"] == 0
    picture = (tmp_path / "accuracy.svg").read_text()
    assert "<title>cables\nrms 0.18 %, largest 0.5 %, 30 ms\n" in picture and "dotted: rk4" in picture
    assert found["peers"][0]["runs"][1] == {"cpu_s": 0.05, "rms_error": 0.001, "largest_error": 0.003}
    names = [f"accuracy.{kind}" for kind in ("svg", "html", "csv", "json")]
    assert [Path(file).name for file in found["files"]] == names


@pytest.mark.long
def test_modes_of_other_ends_are_wrong() -> None:
    """Set A, first order, rms: pinned 12.5 %, free-free 14 and 12 %, clamped-free 130 %; and the monitors say so.

    One free-free mode misses the shear forces at the pins.
    """
    plot = replace(crank_slider().plots[0], cut=None, pieces=())
    models = ladder(LadderRange(("first",), ("mean",), (), (), (1, 3), ("free-free", "clamped-free")))
    found = {}
    for model in models:
        moved = motion(compiled(crank_slider(), model), 1e-6, monitored=True)
        ends = [m.value for m in moved.validity if m.cause is Cause.BENDING_MOMENT]
        found[model.label] = (100 * plot_errors((plot,), moved)[0], *ends)
    errors = {label: values[0] for label, values in found.items()}
    expected = {
        "rigid": 47.0, "1 sine, first": 12.53, "1 free-free mode, first": 14.12, "1 clamped-free mode, first": 32.5,
        "3 sines, first": 12.46, "3 free-free modes, first": 11.99, "3 clamped-free modes, first": 134.2,
    }  # fmt: skip
    assert errors == pytest.approx(expected, rel=5e-3)
    wrong = {"1 free-free mode, first", "1 clamped-free mode, first", "3 clamped-free modes, first"}
    assert {label for label, values in found.items() if len(values) > 1 and values[1] > 0.2} == wrong


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (["--orders", "frist"], "did you mean first?"),
        (["--frames", "given"], "choose from mean, chord, point, tangent"),
        (["--shapes", "13"], "at most 12 shapes"),
        (["--tolerances", "2"], "expected a small positive number"),
        (["--error", "2"], "an error is a fraction such as 0.01, not '2'; 2 % is 0.02"),
        (["--error", "0.1%"], "an error is a fraction such as 0.01, not '0.1%'; 0.1 % is 0.001"),
        (["--plot", "x"], 'there is no plot "x"'),
        (["--set", "EL=3"], '--set: "EL" is no parameter and no key'),
    ],
)
def test_wrong_arguments(asked: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    try:
        code = main(["study", "accuracy", str(SCENE), *asked])
    except SystemExit as stopped:
        code = int(str(stopped.code))
    assert code == 2 and message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "model,cpu_s,rms_error\na,1,2\n",
            "peers.csv: line 1: the table of peers has no column largest_error; its",
        ),
        ("model,cpu_s,rms_error,largest_error\n", "the table of peers has no rows"),
        ("model,cpu_s,rms_error,largest_error\na,1,0,x\nb,1,2\n", 'line 2: "0" is no positive number'),
        (None, "the table of peers cannot be read: No such file"),
    ],
)
def test_wrong_tables_of_peers(
    text: str | None, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    peers = tmp_path / "peers.csv"
    if text is not None:
        peers.write_text(text)
    assert main(["study", "accuracy", str(SCENE), "--peers", str(peers), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr()
    assert message in said.err and said.out == "" and not (tmp_path / "out").exists()
