"""The command `build`: what it writes and says, and models that it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from derive.cli.main import main
from test_cli import BLOCK, MEAN, POINT


def test_build_shows_the_stages_and_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["build", MEAN, POINT, "--out", str(tmp_path)]) == 0
    output = capsys.readouterr()
    assert output.err == ""  # quiet in a pipe
    rows = [line.split() for line in output.out.splitlines() if line.startswith("  ") and len(line.split()) > 1]
    assert ["stage", "seconds", "terms", "operations", "non-zeros"] in rows
    lowered = [row[2:] for row in rows if row[0] == "lower"]
    assert lowered == [["18", "5"], ["37", "15"]]
    for name in ("free_beam_mean", "free_beam_point"):
        names = sorted(p.name for p in (tmp_path / name).iterdir())
        assert names == [f"{name}.c", f"{name}.h", f"{name}.py", "manifest.json"]


def test_build_for_machines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["build", MEAN, "--out", str(tmp_path), "--json"]) == 0
    (model,) = json.loads(capsys.readouterr().out)
    assert [stage["name"] for stage in model["stages"]] == ["read", "derive", "lower", "emit"]
    assert model["nonzeros"] == 5 and model["operations"]["mass_force"] == 18


def test_manifest_tells_what_was_made(tmp_path: Path) -> None:
    import hashlib

    main(["build", MEAN, "--out", str(tmp_path), "--json"])
    manifest = json.loads((tmp_path / "free_beam_mean/manifest.json").read_text())
    assert manifest["nonzeros"]["mass"] == {"structural": 5, "of": 25, "stored": 5}
    for path, digest in manifest["files"].items():
        assert hashlib.sha256((tmp_path / path).read_bytes()).hexdigest() == digest
    assert manifest["specification_sha256"] in (tmp_path / "free_beam_mean/free_beam_mean.h").read_text()


CHAIN = """
name = "chain"
[scene]
lowering = "instances"
[bodies.link]
count = 3
mass = 1
inertia = 1
markers = { left = [-1, 0], right = [1, 0] }
start = { position = ["2*i", 0] }
[joints.hinge]
count = 2
kind = "revolute"
between = ["link[i].right", "link[i+1].left"]
[simulation]
duration = 1
output = 0.5
"""


def test_bodies_in_loops_are_not_written_out_to_be_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """An initial state without rates takes no derivatives of poses either: both take long in chains of many bodies."""

    def refused(*_: object) -> None:
        raise AssertionError("this takes the square of the number of bodies")

    monkeypatch.setattr("derive.pipeline.Built.equations", property(refused))
    monkeypatch.setattr("derive.simulation.initial.kinematics.Kinematics.grouped", refused)
    (tmp_path / "chain.toml").write_text(CHAIN)
    assert main(["build", str(tmp_path / "chain.toml"), "--out", str(tmp_path), "--json"]) == 0
    (model,) = json.loads(capsys.readouterr().out)
    stages = {stage["name"]: stage for stage in model["stages"]}
    assert stages["derive"]["terms"] is None and stages["lower"]["nonzeros"] == 9 and "start" in stages


def test_two_files_with_one_name_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = tmp_path / "other.toml"
    other.write_text(Path(MEAN).read_text())
    assert main(["build", MEAN, str(other), "--out", str(tmp_path / "out")]) == 2
    assert "is taken by" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("first", "second", "output"),
    [
        ("beam", "Beam", "differs in more than case"),
        ("beam", "beam_pattern", "make the same names in C"),
        ("a_p", "a", "make"),
    ],
)
def test_models_that_meet_in_c_are_refused(
    first: str, second: str, output: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    paths = []
    for number, name in enumerate((first, second)):
        paths.append(tmp_path / f"{number}.toml")
        paths[-1].write_text(f'name = "{name}"\n[beam]\n')
    assert main(["build", *map(str, paths), "--out", str(tmp_path / "out")]) == 2
    assert output in capsys.readouterr().err


@pytest.mark.parametrize(
    ("keys", "output"),
    [
        ('ansatz = ["1", "xi", "xi^2", "xi^2 + 1e-20*xi^3"]\northogonal = false', "the pivot of alpha2 vanished"),
        ('ansatz = ["xi^2 - 1 + 1e-50"]\nframe = "given"', "which is out of the range of doubles"),
    ],
)
def test_folded_numbers_that_doubles_cannot_serve(
    keys: str, output: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With parameters setup refuses at run time; with numbers the tool knows at once."""
    numbers = (
        "mass = 1\nlength = 1\nbending_stiffness = 1"
        if "pivot" in output
        else ("mass = 1e59\nlength = 1e-59\nbending_stiffness = 1e59")
    )
    spec = tmp_path / "spec.toml"
    spec.write_text(f'name = "b"\n[beam]\n{keys}\n{numbers}\n')
    assert main(["build", str(spec), "--out", str(tmp_path / "out")]) == 2
    assert output in capsys.readouterr().err


# Bodies in space
def test_build_says_which_lowering_and_how_far_the_modes_are_from_the_mean_frame(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["build", BLOCK, "--out", str(tmp_path)]) == 0
    output = capsys.readouterr().out
    assert "unrolled, the faster form; predicted evaluation time of h:" in output
    assert "mean displacement of the modes (17)" in output
    assert main(["build", BLOCK, "--out", str(tmp_path), "--json"]) == 0
    (model,) = json.loads(capsys.readouterr().out)
    assert model["lowering"] == "flat" and len(model["notes"]) == 6
    manifest = json.loads((tmp_path / "block/manifest.json").read_text())
    assert manifest["lowering"]["kind"] == "flat" and "predicted evaluation time" in manifest["lowering"]["choice"]
    assert manifest["specification"]["data"]["nodes"] == 255 and len(manifest["specification"]["data"]["sha256"]) == 64
