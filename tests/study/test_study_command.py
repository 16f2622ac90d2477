"""`tisserand study` as a user meets it, on the crank-slider with few beams."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from conftest import ROOT
from derive.cli.main import main

SCENE = str(ROOT / "scenes/crank_slider_3.toml")


@pytest.mark.long
def test_frames(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    chart = tmp_path / "frames.svg"
    asked = ["--pieces", "1,2", "--runs", "1", "--chart", str(chart), "--json"]
    assert main(["study", "frames", SCENE, *asked]) == 0
    said = capsys.readouterr()
    assert said.err == "" and chart.read_text().startswith("<svg")  # quiet in a pipe
    found = json.loads(said.out)
    assert found["frames"] == ["mean", "point"] and found["files"] == [str(chart)]
    one, two = found["rows"]
    assert [one["pieces"], one["paper"], two["pieces"], two["paper"]] == [1, 0.97, 2, 0.93]
    assert [row[f]["counts"]["mass"] for row in (one, two) for f in ("mean", "point")] == [6, 16, 11, 31]
    # PHYSICS: cond(KKT) 2.9e3 and 1.8e4, 1.6e6 and 4.8e6; cond(M) about 7 times lower
    conditions = [row[f]["condition_kkt"] for row in (one, two) for f in ("mean", "point")]
    assert conditions == pytest.approx([2.888e3, 1.815e4, 1.627e6, 4.781e6], rel=1e-3)
    assert [row["point"]["condition_mass"] / row["mean"]["condition_mass"] for row in (one, two)] == pytest.approx(
        [7.3, 7.1], rel=0.01
    )
    for row in (one, two):
        times = row["times"]
        assert times["runs"] == 1 and times["accelerations"][0] == times["accelerations"][1]
        assert times["simulated"] == pytest.approx(times["step"] * times["steps"])
        assert 0 < times["integration_ratio"]["least"] <= times["integration_ratio"]["median"]
        assert min(*times["accel"], *times["force"], *times["per_step"]) > 0


def test_pivots(capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["--pieces", "1", "--states", "37", "--numberings", "8"]
    assert main(["study", "pivots", SCENE, *asked, "--json"]) == 0
    said = capsys.readouterr()
    (found,) = json.loads(said.out)
    mean, point = found["frames"]
    for kind in ("undeformed", "simulated"):
        assert mean[kind]["vanishing_mass"] == 0 and point[kind]["vanishing_mass"] == 6  # the c-phi entries, twice, ...
        for name in ("constrained", "matched", "markowitz"):
            for one in (mean, point):
                pivots = one[kind]["orders"][name]
                assert (pivots["without_diagonal"], pivots["vanishing"], pivots["failures"]) == (0, 0, 0)
                assert pivots["backward_error"] < 1e-11
        # the blind order takes a multiplier before its coordinates in the point frame alone
        assert mean[kind]["orders"]["unconstrained"]["failures"] == 0
        blind = point[kind]["orders"]["unconstrained"]
        assert (blind["without_diagonal"], blind["failures"], blind["growth"]) == (1, 37, None)
    assert (
        mean["broken"]["constrained"] == point["broken"]["constrained"] == 0 and point["broken"]["unconstrained"] == 1
    )
    assert any("holds in part" in sentence for sentence in found["verdict"])


def test_pivots_for_people(capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["--pieces", "1", "--states", "9", "--numberings", "1", "--frames", "mean,chord"]
    assert main(["study", "pivots", SCENE, *asked]) == 0
    text = capsys.readouterr().out
    assert "crank_slider_3, 1 beam: 9 states of one revolution of motor" in text
    assert len([line for line in text.splitlines() if line.startswith("  constrained    chord")]) == 2
    assert "Haug's conjecture" in text


@pytest.mark.parametrize("study", ["frames", "pivots"])
def test_a_body_alone_and_a_scene_without_beams_are_refused(
    study: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["study", study, str(ROOT / "scenes/free_beam_mean.toml")]) == 2
    assert "this is a single body" in capsys.readouterr().err
    rigid = tmp_path / "rigid.toml"
    rigid.write_text(
        'name = "rigid"\n[bodies.bob]\nmass = 1\ninertia = 1\nmarkers = { end = [0, 1] }\n'
        '[ground.markers]\nnail = [0, 0]\n[joints.pin]\nkind = "revolute"\nbetween = ["ground.nail", "bob.end"]\n'
        "[simulation]\nduration = 1\noutput = 0.1\n"
    )
    assert main(["study", study, str(rigid)]) == 2
    assert "bodies: there is no beam here" in capsys.readouterr().err


@pytest.mark.parametrize(
    "wrong",
    [["--frames", "mean"], ["--frames", "mean,tangent"], ["--pieces", "0"], ["--pieces", "1,65"], ["--runs", "0"]],
)
def test_wrong_arguments(wrong: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["study", "frames", SCENE, *wrong])
    assert stopped.value.code == 2 and wrong[0] in capsys.readouterr().err


@pytest.mark.parametrize("command", [["study", "frames"], ["study", "pivots"]])
def test_scenes_in_space_are_refused_with_what_compares_their_runs(
    command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The commands that the message names run as they are written."""
    scene = tmp_path / "space.toml"
    shutil.copy(ROOT / "scenes/block.npz", tmp_path)
    scene.write_text(IN_SPACE)
    assert main([*command, str(scene)]) == 2
    error = capsys.readouterr().err
    assert f"space.toml: {NEEDED}: tisserand sweep {scene} --set bodies.block.modes=1,2,3 --output final:e_kin" in error
    (line,) = error.splitlines()
    commands = [text.split()[1:] for text in line.split("runs in space: ")[1].split("; ")]
    assert [words[0] for words in commands] == ["sweep", "simulate", "modes"]
    if command == ["study", "pivots"]:
        commands[0][3] = "bodies.block.modes=1,2"  # fewer, for a test
        for words in commands[:2]:
            assert main([*words, "--out", str(tmp_path)]) == 0


@pytest.mark.parametrize("command", ["frames", "pivots"])
def test_the_frames_of_beams_in_space_are_compared_by_the_study_of_accuracy(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = str(ROOT / "examples/spatial_crank_slider_beam.toml")
    assert main(["study", command, scene]) == 2
    words = ["study", "accuracy", scene, "--own-reference", "--frames", "mean,chord,point,tangent"]
    assert f"{NEEDED}: tisserand {' '.join(words)};" in capsys.readouterr().err


NEEDED = (
    "a planar scene is needed, and this is a scene in space: models of planar beams are what this command compares. "
    "What compares runs in space"
)
IN_SPACE = """
name = "space"
[bodies.block]
nodes = "block.npz"
units = "SI"
modes = 1
start = { velocity = [1, 0, 0] }
[outputs.e]
kind = "energy"
[simulation]
duration = 1e-4
output = 1e-4
"""
