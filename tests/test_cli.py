"""The command line as a user meets it."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive import sid
from derive.cli.main import main

MEAN, POINT = str(ROOT / "scenes/free_beam_mean.toml"), str(ROOT / "scenes/free_beam_point.toml")
BLOCK = str(ROOT / "scenes/block.toml")
WRONG = """\
name = "double"

[beam]
ansatz = ["1", "xi", "xi^2", "import os"]
frame = "meen"
mass = -1
lenght = 2
"""


def test_without_arguments_it_helps(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    output = capsys.readouterr().out
    assert "build" in output and "examples:" in output


def test_help_imports_nothing_heavy() -> None:
    code = (
        "import sys\n"
        "from derive.cli.main import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: pass\n"
        "print([m for m in ('sympy', 'casadi', 'numpy', 'pydantic', 'jinja2') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


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


def test_compare_shows_both_frames(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", MEAN, POINT]) == 0
    output = capsys.readouterr().out
    assert "5 of 25 structural non-zeros" in output and "15 of 25 structural non-zeros" in output
    assert main(["compare", MEAN, "--json"]) == 0
    (result,) = json.loads(capsys.readouterr().out)
    assert result["mass"][0] == [1.0, None, None, None, None]
    assert result["force"][3] == pytest.approx(144 * 0.02 - 9 * 0.02 / 5, rel=1e-14)


def test_all_errors_of_all_files_at_once_and_nothing_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    wrong = tmp_path / "wrong.toml"
    wrong.write_text(WRONG)
    out = tmp_path / "generated"
    assert main(["build", MEAN, str(wrong), str(tmp_path / "missing.toml"), "--out", str(out)]) == 2
    output = capsys.readouterr()
    assert output.out == "" and not out.exists()
    lines = output.err.splitlines()
    assert all(line.startswith(str(tmp_path)) for line in lines)
    for number, text in ((1, "double"), (4, "ansatz"), (5, "meen"), (6, "mass"), (7, "length")):
        assert any(line.startswith(f"{wrong}:{number}: ") and text in line for line in lines), (number, text)
    assert any("missing.toml" in line for line in lines)


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


def test_files_of_others_are_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mine = tmp_path / "free_beam_mean/free_beam_mean.c"
    mine.parent.mkdir()
    mine.write_text("int mine;\n")
    assert main(["build", MEAN, "--out", str(tmp_path)]) == 2
    assert "was not generated by Tisserand" in capsys.readouterr().err
    assert mine.read_text() == "int mine;\n" and len(list(mine.parent.iterdir())) == 1


def test_a_root_of_a_square_is_refused_with_advice(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It has a kink, at which integrators do not stop."""
    spec = tmp_path / "pushed.toml"
    spec.write_text(
        'name = "pushed"\n[bodies.mass]\nmass = 1\ninertia = 1\nmarkers = { centre = [0, 0] }\n'
        '[forces.push]\nat = "mass.centre"\ncomponents = ["sqrt(t^2)", 0]\n'
    )
    assert main(["build", str(spec), "--out", str(tmp_path / "out")]) == 2
    assert "has a kink; write abs(t)" in capsys.readouterr().err


def test_no_compiler_is_explained(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    assert main(["compare", MEAN]) == 2
    assert "no-such-compiler" in capsys.readouterr().err


def test_parameters_that_make_no_body_are_explained(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "dependent.toml"
    spec.write_text(
        'name = "dependent"\n[beam]\nansatz = ["1", "xi", "xi^2", "xi^2 + 1e-7*xi^3"]\northogonal = false\n'
    )
    assert main(["compare", str(spec)]) == 2
    assert "dependent_setup returned 1: a pivot vanished" in capsys.readouterr().err


def test_check_without_specifications(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(tmp_path)]) == 2
    assert "no specification" in capsys.readouterr().err
    assert main(["check", str(tmp_path / "absent")]) == 2
    assert "there is no such folder or file" in capsys.readouterr().err


def test_check_in_another_folder_says_how_to_name_the_folders(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["check"]) == 2
    advice = "change to the folder that holds it, or name the specifications and the generated files"
    assert capsys.readouterr().err == (
        f"scenes: there is no such folder or file here; {advice}: tisserand check SCENES --out GENERATED\n"
    )


@pytest.mark.parametrize("arguments", [["bild"], ["build"], ["build", MEAN, "--outt", "x"]])
def test_wrong_arguments(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    assert stopped.value.code == 2
    assert "usage:" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        (["bild"], "did you mean 'build'?"),
        (["simulat", "x.toml"], "did you mean 'simulate'?"),
        (["SIMULATE"], "did you mean 'simulate'?"),
        (["study", "pivot"], "did you mean 'pivots'?"),
        (["x"], "choose from new,"),
    ],
)
def test_unknown_commands_get_a_suggestion(arguments: list[str], hint: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    assert stopped.value.code == 2
    output = capsys.readouterr()
    assert hint in output.err and output.out == ""


def test_every_command_explains_its_options(capsys: pytest.CaptureFixture[str]) -> None:
    for command in ("build", "compare", "simulate", "study", "report", "check", "sid", "schema"):
        with pytest.raises(SystemExit) as stopped:
            main([command, "--help"])
        assert stopped.value.code == 0
        help_text = " ".join(capsys.readouterr().out.split())
        assert help_text.startswith(f"usage: tisserand {command}")
        assert main([]) == 0
        line = next(line for line in capsys.readouterr().out.splitlines() if line.startswith(f"    {command} "))
        assert " ".join(line.split()[1:4]).lower() in help_text.lower()


def test_the_help_of_report_names_both_kinds_of_specifications(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["report", "--help"])
    assert "of a body or a scene" in " ".join(capsys.readouterr().out.split())


def test_a_closed_pipe_is_no_error() -> None:
    done = subprocess.run(
        f"{sys.executable} -m derive schema | head -1", shell=True, capture_output=True, text=True, check=True
    )
    assert done.stderr == ""


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


def test_faults_of_the_numbers_have_their_lines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Rigid motion left in the modes is detected when they are used, and reported like any fault of the file."""
    x = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    modes = np.array([np.tile([1.0, 0, 0], (4, 1)), x * [1, -1, 0]])
    np.savez(tmp_path / "n.npz", positions=x, mass=np.ones(4), modes=modes, modal_stiffness=np.ones(2))
    spec = tmp_path / "rigid.toml"
    spec.write_text('name = "rigid"\n[body]\nnodes = "n.npz"\nunits = "SI"\nframe = "mean"\n')
    assert main(["build", str(spec), "--out", str(tmp_path / "out")]) == 2
    output = capsys.readouterr().err
    assert output.startswith(f"{spec}:") and "rigid motion" in output and "mode 1" in output
    assert not (tmp_path / "out").exists()


def test_sid_is_printed_and_reads_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sid", BLOCK]) == 0
    text = capsys.readouterr().out
    body, again = derive.modal(derive.read(BLOCK)), sid.read(text)
    assert np.array_equal(body.C5, again.C5) and np.array_equal(body.stiffness, again.stiffness)
    flat = derive.lower(derive.derive_modal(again, None, "flat"))
    assert flat.pattern("mass", "M") == derive.lower(derive.derive_modal(body, None, "flat")).pattern("mass", "M")
    assert main(["sid", MEAN]) == 2
    assert "SID describes a body given by nodes" in capsys.readouterr().err


def test_compare_shows_the_first_rows_of_a_large_body(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "large.toml"
    spec.write_text('name = "large"\n[body]\nintegrals = "symbolic"\nmodes = 30\n')
    picture = tmp_path / "large.svg"
    assert main(["compare", str(spec), "--picture", str(picture)]) == 0
    output = capsys.readouterr().out
    assert "the first 14 of 36 rows and columns" in output
    assert "222 of 1296 structural non-zeros" in output and "222 of 1296" in picture.read_text()


def test_a_spring_whose_ends_would_coincide_is_stretched_for_comparison(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    spec = tmp_path / "hung.toml"
    spec.write_text("""
name = "hung"
ground.markers = { o = [0, 0] }
[bodies.bob]
mass = 2
inertia = 0.1
markers = { centre = [0, 0] }
[springs.s]
between = ["ground.o", "bob.centre"]
stiffness = 10
rest = 1
""")
    assert main(["compare", str(spec), "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)
    pull = 10 * (1 - math.hypot(0.1, 0.2)) / math.hypot(0.1, 0.2)
    assert found["q"] == pytest.approx([0.1, 0.2, 0.5])
    assert found["force"] == pytest.approx([-0.1 * pull, -0.2 * pull, 0])
