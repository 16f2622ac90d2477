"""`tisserand choose`: scenes of which the answer is known, references that have not converged, and what is written."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_up_choice import reference

from conftest import ROOT
from derive.cli.main import main
from derive.simulation.observables.plots import PlotCurve
from derive.simulation.validity.monitors import Cause, Monitor
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.plots import ColumnCurves, Deflection, Plot
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse, read
from derive.study.accuracy.ladder_model import LadderModel, Shapes, mixed
from derive.study.accuracy.measurement import Line, Point
from derive.study.accuracy.predicted_cost import fastest_rate
from derive.study.accuracy.reference import rms_difference
from derive.study.choice import one_beam, search
from derive.study.choice import reference_models as references
from derive.study.choice.choice_text import choice_text, neighbours
from derive.study.choice.model_runs import ModelRuns
from derive.study.choice.reference_errors import Agreement, TrustedReference
from derive.study.choice.screening import Screening, screening
from derive.study.choice.search import Choice, cheapest_model
from derive.study.choice.trusted_reference import NotConverged
from derive.study.choice.written_specification import chosen_specification, relative_path

SCENE = ROOT / "scenes" / "crank_slider_3.toml"

BEAM = """
name = "{name}"
[bodies.rod]
length = 1
mass = 1
bending_stiffness = {stiffness}
markers = {{ left = -1, middle = 0, right = 1 }}
start = {start}
{joints}
[simulation]
duration = {duration}
output = {output}
[plots.it]
{plot}
"""
ON_PINS = """
[ground.markers]
left = [0, 0]
[bodies.roller]
mass = 0.01
inertia = 1
markers = { pin = [0, 0] }
start = { position = [1, 0] }
[joints.left]
kind = "revolute"
between = ["ground.left", "rod.left"]
[joints.guide]
kind = "translational"
between = ["ground.left", "roller.pin"]
[joints.right]
kind = "revolute"
between = ["roller.pin", "rod.right"]
[scene]
gravity = [0, "-0.3"]
"""
ACROSS = 'deflection = "rod.middle"\nchord = ["rod.left", "rod.right"]\ndivided_by = 1'


def made(name: str, stiffness: float, start: str, joints: str, duration: float, plot: str) -> Scene:
    """A scene with one rod of 1 m and 1 kg."""
    keys = {"name": name, "stiffness": stiffness, "start": start, "joints": joints, "plot": plot}
    scene = parse(BEAM.format(duration=duration, output=duration / 100, **keys))
    assert isinstance(scene, Scene)
    return scene


@pytest.fixture
def small_references(monkeypatch: pytest.MonkeyPatch) -> None:
    """References of two beams with three shapes, which is enough here, and an end with the first model that is good."""
    monkeypatch.setattr(references, "MOST_BEAMS", 2)
    monkeypatch.setattr(references, "MOST_SHAPES", 3)
    monkeypatch.setattr(one_beam, "BEYOND", 0)


def label(choice: Choice) -> str:
    """The model that is chosen."""
    assert choice.chosen is not None
    return choice.chosen[0].model.label


def quiet(_: str) -> None: ...


def runs_of(scene: Scene, plots: Sequence[Plot] = ()) -> ModelRuns:
    """The runs for some plots of a scene, for all without."""
    return ModelRuns(scene, plots or scene.plots, quiet)


@pytest.mark.long
def test_the_sag_of_a_beam_needs_one_shape(small_references: None) -> None:
    """It swings about its sag, 0.4 % of its length: a half sine wave is right to 0.4 %, whatever its order."""
    scene = made("sag", 1.0, "{ position = [0.5, 0] }", ON_PINS, 0.6, ACROSS)
    runs = runs_of(scene)
    (one,) = screening(runs)
    choice = cheapest_model(runs, 0.02, screened=(one,))
    assert label(choice) == "1 sine, first" and choice.reference.difference < 0.02 / 3
    assert choice.tried[0].model.label == "rigid"
    text = choice_text(choice)
    assert one.text in text and "Chosen: 1 sine, first" in text
    assert one.frequency == pytest.approx(np.pi**2, rel=4e-4)  # pi^2 sqrt(EI/(m l^3)); of P2 to P4, 3e-4 high
    assert one.deflection == pytest.approx(4 / np.pi * 0.3 / np.pi**4, rel=1e-3)


@pytest.mark.long
def test_all_plots_that_are_asked_for_have_to_be_accurate(small_references: None) -> None:
    """The error of a run is that of its worst curve."""
    x = np.linspace(0, 1, 5)
    exact, rough = PlotCurve("a", x, x, None), PlotCurve("a", x, 1.1 * x, None)
    assert rms_difference((exact, exact), (exact, rough)) == pytest.approx(0.1 * np.sqrt(np.mean(x**2)))
    assert rms_difference((exact, PlotCurve("a", x, 0 * x, None)), (exact, exact)) is None
    scene = made("sag", 1.0, "{ position = [0.5, 0] }", ON_PINS, 0.6, ACROSS)
    far = replace(scene.plots[0], name="far")
    choice = cheapest_model(runs_of(scene, (scene.plots[0], far)), 0.02)
    assert label(choice) == "1 sine, first" and [plot.name for plot in choice.reference.plots] == ["it", "far"]


@pytest.mark.long
def test_a_stiff_slow_pendulum_needs_no_flexibility(small_references: None) -> None:
    pin = '[ground.markers]\nleft = [0, 0]\n[joints.pin]\nkind = "revolute"\nbetween = ["ground.left", "rod.left"]\n'
    joints = pin + '[scene]\ngravity = [0, -10]\n[outputs]\nend = { kind = "position", marker = "rod.right" }'
    scene = made("stiff", 1e4, "{ position = [0.5, 0] }", joints, 1.0, 'y = ["end_1"]')
    choice = cheapest_model(runs_of(scene), 0.01)
    assert label(choice) == "rigid"


@pytest.mark.long
def test_a_fast_spin_needs_second_order(small_references: None) -> None:
    knock = '[forces.knock]\nat = "rod.middle"\ncomponents = [0, "0.2/(1 + (5*t)^2)^2"]\n'
    scene = made("spin", 1.0, "{ spin = 12 }", knock, 0.5, ACROSS)
    choice = cheapest_model(runs_of(scene), 0.07)
    assert label(choice).endswith("truncated")
    tried = {line.model.label: line for line in choice.tried}
    first = tried[label(choice).replace("truncated", "first")]
    assert first.warning is not None and min(p.rms for p in first.points) > 0.07


@pytest.mark.long
def test_a_large_deflection_needs_all_terms() -> None:
    """A beam that is struck bends by a tenth of its length: truncation leaves out 13 % of it, whatever the shapes."""
    scene = made("struck", 1.0, '{ deflection_rate = "1.4*(3*xi^2/2 - 1/2)" }', "", 0.6, ACROSS)
    choice = cheapest_model(runs_of(scene), 0.09)
    assert label(choice) == "1 sine, full"
    tried = {line.model.label: line for line in choice.tried}
    assert min(p.rms for p in tried["1 sine, truncated"].points) == pytest.approx(0.13, rel=0.005)


@pytest.fixture(scope="module")
def set_a() -> tuple[Scene, TrustedReference]:
    """Set A, with the finite-element run as the reference, which is good to 0.1 %."""
    scene = read(SCENE)
    assert isinstance(scene, Scene)
    plot = replace(scene.plots[0], cut=None, pieces=())
    agreement = Agreement("finite elements", 1e-3)
    return replace(scene, plots=(plot,)), TrustedReference((plot,), LadderModel(Shapes.RIGID), (agreement,))


@pytest.mark.long
def test_set_a(set_a: tuple[Scene, TrustedReference], monkeypatch: pytest.MonkeyPatch) -> None:
    """One shape of second order at 1 and at 5 %, one sine of first order at 15 %, and nothing at 0.01 %."""
    scene, known = set_a
    runs = runs_of(scene)
    (one,) = screening(runs)
    assert one.axial == pytest.approx(0.227, abs=1e-3)  # what a run with P2 to P5 sees
    assert "axial force up to 23 % of its buckling load" in one.text
    monkeypatch.setattr(one_beam, "candidates", lambda *_: (RIGID, SINE, FINE))
    monkeypatch.setattr(search, "trusted_references", lambda *_: [known])
    found = {error: cheapest_model(runs, error) for error in (0.01, 0.05, 0.15, 1e-4)}
    assert [label(found[error]) for error in (0.01, 0.05, 0.15)] == ["1 sine, truncated"] * 2 + ["1 sine, first"]
    assert found[1e-4].chosen is None
    text = choice_text(found[1e-4])
    assert "No model that was tried has an error of at most 0.01 %" in text
    assert "The best model is 1 beam, P2 to P4" in text
    monkeypatch.setattr(search, "trusted_references", lambda *_: [replace(known, errors=((FINE, 8e-4),))])
    steps = neighbours(cheapest_model(runs, 0.01))  # what the reference has needed shows what more costs
    assert [one.model.label for one, _ in steps["step up"]][-1] == "1 beam, P2 to P4, truncated"


@pytest.mark.long
def test_a_reference_that_has_not_converged_is_not_trusted(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = made("sag", 1.0, "{ position = [0.5, 0] }", ON_PINS, 0.6, ACROSS)
    monkeypatch.setattr(references, "FIRST", replace(PARABOLA, count=2, pieces=2))
    monkeypatch.setattr(references, "MOST_BEAMS", 2)
    monkeypatch.setattr(references, "MOST_SHAPES", 2)
    with pytest.raises(
        NotConverged,
        match=r"accurate enough: 2 beams, P2, P3, truncated differs by .* from the model with fewer shapes",
    ):
        reference(runs_of(scene), 1e-3)


def test_paths_on_another_drive_are_written_whole(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """There is no relative path between two drives of Windows."""

    def across_drives(*_: object) -> str:
        raise ValueError("path is on mount 'C:', start on mount 'D:'")

    assert relative_path(tmp_path / "curve.csv", tmp_path / "x") == "../curve.csv"
    monkeypatch.setattr("os.path.relpath", across_drives)
    scene = read(SCENE)
    assert isinstance(scene, Scene)
    text = chosen_specification(
        SCENE.read_text(), SCENE, tmp_path / "c.toml", scene, LadderModel(Shapes.SINES, 1), 1e-5
    )
    whole = f'file = "{SCENE.parent.as_posix()}/'
    assert whole in text.text
    (tmp_path / "c.toml").write_text(text.text)
    assert read(tmp_path / "c.toml").name == "crank_slider_3_chosen"


@pytest.mark.parametrize(
    ("model", "keys"),
    [
        (LadderModel(Shapes.RIGID), ["inertia = 0.0005006677", "left = [-0.15, 0.0]"]),
        (LadderModel(Shapes.SINES, 2), ['ansatz = {kind = "pinned", count = 2}']),
        (
            LadderModel(Shapes.POLYNOMIALS, 3, DisplacementOrder.TRUNCATED, "mean", 2),
            ["order = 2", "pieces = 2"],
        ),
    ],
)
def test_what_is_written_is_the_text_of_the_user_with_other_beams(
    model: LadderModel, keys: list[str], set_a: tuple[Scene, TrustedReference], tmp_path: Path
) -> None:
    scene, _ = set_a
    target = tmp_path / "x" / "chosen.toml"
    target.parent.mkdir()
    text = chosen_specification(SCENE.read_text(), SCENE, target, scene, model, 1e-5).text
    assert all(key in text for key in keys), text
    assert (
        text.splitlines()[1]
        == f"# Chosen by tisserand choose: {model.label}. Other comments are those of {SCENE.name}."
    )
    assert "# 7870 kg/m^3" in text and "cut =" not in text
    target.write_text(text)
    chosen = read(target)  # the reference curve is found from there
    assert isinstance(chosen, Scene) and chosen.name == "crank_slider_3_chosen"
    assert chosen.simulation is not None and chosen.simulation.tolerance == 1e-5
    assert isinstance(chosen.plots[0].quantity, Deflection) and chosen.plots[0].reference is not None


def test_the_command(
    set_a: tuple[Scene, TrustedReference], tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    """It writes what `build` accepts, and never overwrites anything."""
    monkeypatch.setattr(search, "trusted_references", lambda *_: [set_a[1]])
    monkeypatch.setattr(one_beam, "candidates", lambda *_: (RIGID, PARABOLA, SINE))
    monkeypatch.setattr(one_beam, "_try_first_order", lambda *_: None)
    out = tmp_path / "new" / "chosen.toml"  # the scene refers to a file
    assert main(["choose", str(SCENE), "--error", "0.05", "--out", str(out), "--json"]) == 0
    text = capsys.readouterr()
    found = json.loads(text.out)
    assert "model 3: 1 sine, truncated: 0.2" in text.err  # a line for each model where standard error is no terminal
    assert found["chosen"]["model"] == "1 sine, truncated" and found["specification"] == str(out)
    assert main(["build", str(out), "--out", str(tmp_path)]) == 0
    before = out.read_bytes()
    assert main(["choose", str(SCENE), "--out", str(out)]) == 2
    assert "exists, and is not overwritten" in capsys.readouterr().err and out.read_bytes() == before
    monkeypatch.setattr(one_beam, "candidates", lambda *_: (RIGID,))
    assert main(["choose", str(SCENE), "--error", "1e-4", "--out", str(tmp_path / "none.toml")]) == 1
    assert "No model that was tried" in capsys.readouterr().out and not (tmp_path / "none.toml").exists()


TWO = """
name = "two"
[ground.markers]
pin = [0, 0]
[bodies.upper]
ansatz = ["1", "xi", "xi^2", "xi^3"]
mass = 1
length = 1
bending_stiffness = 1000
markers = { top = -1, middle = 0, end = 1 }
masses = { lump = { at = 1, mass = 1 } }
start = { position = [0.5, 0] }
[bodies.lower]
ansatz = ["1", "xi", "xi^2", "xi^3"]
mass = 1
length = 1
bending_stiffness = 5
markers = { top = -1, middle = 0, end = 1 }
start = { position = [1.5, 0], angle = 0, deflection_rate = "0.3*xi^2 - 0.1" }
[joints]
bearing = { kind = "revolute", between = ["ground.pin", "upper.top"] }
pin = { kind = "revolute", between = ["upper.end", "lower.top"] }
[scene]
gravity = [0, -9.81]
[outputs]
bending = { kind = "bending_moment", section = "upper.middle" }
place = { kind = "position", marker = "lower.middle" }
[simulation]
duration = 0.2
output = 0.002
[plots.place]
y = ["place_1", "bending"]
[plots.moment]
y = ["bending"]
[plots.deflection]
deflection = "lower.middle"
chord = ["lower.top", "lower.end"]
divided_by = 1
"""
RIGID, SINE = LadderModel(Shapes.RIGID), LadderModel(Shapes.SINES, 1, DisplacementOrder.TRUNCATED, "chord")
PARABOLA, FINE = (LadderModel(Shapes.POLYNOMIALS, count, DisplacementOrder.TRUNCATED) for count in (1, 3))


def two() -> Scene:
    scene = parse(TWO)
    assert isinstance(scene, Scene)
    return scene


@pytest.mark.long
def test_each_beam_has_a_model_of_its_own() -> None:
    """A stiff beam above a soft one: the upper one is rigid, the lower one bends; and what is claimed is true."""
    scene = parse(TWO.replace(', deflection_rate = "0.3*xi^2 - 0.1"', ""))
    assert isinstance(scene, Scene)
    choice = cheapest_model(runs_of(scene, scene.plots[2:]), 0.1)
    assert choice.chosen is not None
    line, point = choice.chosen
    assert line.model.of("upper") == RIGID and line.model.of("lower").shapes is not Shapes.RIGID
    assert point.rms + choice.reference.error <= 0.1
    shares = {(of.beam, of.model.shapes): of.share for of in choice.shares}
    assert shares["upper", Shapes.RIGID] < 0.02 < shares["lower", Shapes.RIGID]  # type: ignore[operator]
    text = choice_text(choice)
    assert "Share of each beam in the error" in text and "Chosen: upper: rigid; lower: " in text


def test_stiffness_is_predicted_from_the_fastest_vibration() -> None:
    """A free beam with P2 alone has sqrt(720) for 22.4; pieces are stiffer by their number squared."""
    scene = two()
    unit = np.sqrt(1000.0)  # sqrt(EI/(m l^3)) of the upper beam
    assert fastest_rate(scene, PARABOLA) == pytest.approx(np.sqrt(720) * unit)
    assert fastest_rate(scene, replace(PARABOLA, pieces=2)) == pytest.approx(4 * np.sqrt(720) * unit)
    assert fastest_rate(scene, RIGID) == 0
    assert fastest_rate(scene, mixed({"upper": RIGID, "lower": PARABOLA})) == pytest.approx(np.sqrt(3600))


def test_what_is_written_of_rigid_beams_runs_and_says_what_is_gone(tmp_path: Path) -> None:
    spec, target = tmp_path / "two.toml", tmp_path / "chosen.toml"
    spec.write_text(TWO)
    model = mixed({"upper": RIGID, "lower": SINE})
    written = chosen_specification(TWO, spec, target, two(), model, 1e-5)
    assert "# Chosen by tisserand choose: upper: rigid; lower: 1 sine, truncated." in written.text
    chosen = parse(written.text, str(target))
    assert isinstance(chosen, Scene)
    upper, lower = chosen.bodies
    assert upper.kind == "rigid" and upper.mass == 2 and upper.centre == (0.25, 0)  # type: ignore[union-attr]
    assert lower.start.guess and [plot.name for plot in chosen.plots] == ["place", "deflection"]
    assert [output.name for output in chosen.outputs] == ["place"]
    assert any("deflection_rate" in note and "is not in the shapes of lower" in note for note in written.notes)
    assert "outputs.bending: left out, since upper is rigid" in written.notes
    assert "plots.moment: left out, since it shows bending" in written.notes
    assert "plots.place: the curves of bending are left out" in written.notes
    target.write_text(written.text)
    assert main(["simulate", str(target), "--out", str(tmp_path)]) == 0


def test_a_plot_of_several_sections_of_a_rigid_beam_keeps_no_curve_of_them(tmp_path: Path) -> None:
    text = TWO.replace("[outputs]", '[outputs]\nfirst = { kind = "bending_moment", section = "upper.middle" }')
    text += '[plots.all]\ny = ["first", "bending", "place_1"]\n[plots.both]\ny = ["first", "bending"]\n'
    scene = parse(text)
    assert isinstance(scene, Scene)
    model = mixed({"upper": RIGID, "lower": SINE})
    written = chosen_specification(text, tmp_path / "two.toml", tmp_path / "chosen.toml", scene, model, 1e-5)
    chosen = parse(written.text)
    assert isinstance(chosen, Scene)
    curves = {plot.name: plot.quantity.y for plot in chosen.plots if isinstance(plot.quantity, ColumnCurves)}
    assert curves == {"place": ("place_1",), "all": ("place_1",)}
    assert "plots.all: the curves of first, bending are left out" in written.notes
    assert "plots.both: left out, since it shows first, bending" in written.notes


def test_errors_that_vanish_and_runs_that_fail_are_in_the_text() -> None:
    """A prescribed motion has no error; a run that fails after coarser ones is noted."""

    def point(tolerance: float, rms: float, operations: int) -> Point:
        return Point(tolerance, rms, rms, (1e-3,) * 3, 10, operations)

    exact = Line(SINE, 4, (point(1e-3, 0.0, 200),))
    failed = Line(PARABOLA, 4, (point(1e-3, 0.004, 100),), failure="tolerance 1e-05: too many steps")
    assert failed.outcome == "0.4 % in 1 ms; tolerance 1e-05: too many steps"
    known = TrustedReference((), FINE, (Agreement("larger steps", 0.0),))
    scene = made("a", 1.0, "{ position = [0.5, 0] }", ON_PINS, 0.6, ACROSS)
    text = choice_text(Choice(scene, 0.01, known, (exact, failed)))
    assert "100  fails: tolerance 1e-05: too many steps" in text
    assert (
        "step down: 1 beam, P2, truncated, tolerance 0.001, takes 0.5 times the operations and has an error of 0.4 %"
        in text
    )


def test_a_shaft_that_spins_about_its_axis_does_not_turn_it() -> None:
    """Such a shaft at 60 rad/s was said to rotate at up to 5.7e-08 rad/s."""
    shaft = Screening("shaft", 68.0, 60.0, 5.7e-8, 0.002)
    assert "driven at 60 rad/s" in shaft.text and "turns" not in shaft.text
    assert "its own inertia bends it by about 0.2 % of its length" in shaft.text  # and not what other bodies exert
    assert "its axis turns at up to 5 rad/s" in Screening("shaft", 68.0, 60.0, 5.0, 0.002).text


def test_a_cheaper_model_that_a_monitor_doubts_is_named_with_the_doubt() -> None:
    """A crane got a model of 120 times the operations, because its jib twists, and nothing said so."""
    warning = Monitor("jib", 1, Cause.TWISTING_MOMENT, DisplacementOrder.TRUNCATED, 0.3, 0.12, 0.0)
    cheap, dear = (Line(model, 4, (Point(1e-3, 1e-4, 1e-4, (1e-3,), 10, n),)) for model, n in ((SINE, 50), (FINE, 900)))
    doubted = replace(cheap, warning=warning)
    known = TrustedReference((), FINE, (Agreement("larger steps", 0.0),))
    scene = made("a", 1.0, "{ position = [0.5, 0] }", ON_PINS, 0.6, ACROSS)
    choice = Choice(scene, 0.01, known, (doubted, dear))
    assert choice.chosen is not None and choice.chosen[0] is dear
    implied = "12 % implied, 0.01 % measured: the twisting moment of jib is in doubt; the estimate is of all of jib"
    assert f"Cheaper, if its warning does not matter: {SINE.label}, tolerance 0.001, 1 ms: {implied}" in choice_text(
        choice
    )
    assert "does not matter" not in choice_text(replace(choice, tried=(replace(doubted, warning=None), dear)))
    finer = Point(1e-6, 1e-5, 1e-5, (3e-3,), 30, 150)
    alone = choice_text(replace(choice, tried=(replace(doubted, points=(*doubted.points, finer)),)))
    assert f"Would be accurate, if its warning does not matter: {SINE.label}, tolerance 0.001, 1 ms: {implied}" in alone
    assert "Cheaper" not in alone, "nothing is chosen"
