"""Drives whose position or speed jumps are refused; the derivatives of functions of time, by differences."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import derive
from derive.cli.main import main
from derive.simulation.drive_jumps import check_drives, rate_at
from derive.spec.model.scene import Scene
from derive.spec.model.time_function import value_at
from derive.spec.toml.read import parse

DRIVEN = """
name = "driven"
ground.markers = { origin = [0, 0] }
[bodies.block]
mass = 2
inertia = 1
markers = { middle = [0, 0] }
[joints.guide]
kind = "translational"
between = ["ground.origin", "block.middle"]
[drives.motor]
joint = "guide"
motion = "MOTION"
[simulation]
duration = 3
output = 0.5
"""
TABLE = '[tables]\nlift = { file = "lift.csv", x = "t", y = "s" }\n'


def scene(folder: Path, motion: str) -> Scene:
    (folder / "lift.csv").write_text("t,s\n0,0\n1,0.2\n2,0.1\n2.5,0.4\n")
    text = DRIVEN.replace("MOTION", motion) + (TABLE if "lift" in motion else "")
    result = parse(text, str(folder / "driven.toml"))
    assert isinstance(result, Scene)
    return result


@pytest.mark.parametrize(
    ("motion", "jumps"),
    [
        ("0.1*piecewise(t < 1, 1, 3)", [("1", "position", "0.1 m", "0.3 m")]),
        ("piecewise(t < 1.5, t^2, t < 2, 3*t - 2.25, 3.75)", [("2", "speed", "3 m/s", "0 m/s")]),
        ("abs(2*t - 1)", [("0.5", "speed", "-2 m/s", "2 m/s")]),
        ("min(t - 1, 3*t - 3)", [("1", "speed", "3 m/s", "1 m/s")]),
        ("abs(sin(2*t))", [(r"1\.57079633", "speed", "-2 m/s", "2 m/s")]),
        (
            "piecewise(t < 1, 0, t < 2, t, 2*t - 2)",
            [("1", "position", "0 m", "1 m"), ("2", "speed", "1 m/s", "2 m/s")],
        ),
    ],
)
def test_jumps_are_refused(tmp_path: Path, motion: str, jumps: list[tuple[str, ...]]) -> None:
    with pytest.raises(derive.SpecError) as caught:
        check_drives(scene(tmp_path, motion))
    texts = [
        rf"drives\.motor\.motion: at t = {t} s the {quantity} jumps from {old} to {new}, which takes an infinite force"
        for t, quantity, old, new in jumps
    ]
    assert len(texts) == len(caught.value.problems)
    for text, line in zip(texts, str(caught.value).splitlines(), strict=True):
        assert re.match(text, line), line


@pytest.mark.parametrize(
    "motion",
    [
        "step(t, 0.2, 0.2001)",
        "piecewise(t < 1, t^2, 2*t - 1)",
        "piecewise(t < 1, sin(t - 1), t < 2, exp(t - 1) - 1, 2.718281828459045*(t - 1) - 1)",
        "0.1*abs(t - 1)*(t - 1)^2 + 0*t",
        "sqrt(t)",
        "piecewise(t < 1, 0, 0)",
        "piecewise(t < 3.5, t, 0)",
    ],
)
def test_accelerations_may_jump_and_what_is_behind_the_end_does_not_count(tmp_path: Path, motion: str) -> None:
    check_drives(scene(tmp_path, motion))


def test_the_command_names_file_line_and_drive(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene(tmp_path, "t")
    file = tmp_path / "driven.toml"
    file.write_text(DRIVEN.replace("MOTION", "piecewise(t < 1, 0, t - 1)"))
    assert main(["simulate", str(file), "--out", str(tmp_path / "out")]) == 2
    line = DRIVEN.splitlines().index('motion = "MOTION"') + 1
    assert f"driven.toml:{line}: drives.motor.motion: at t = 1 s the speed jumps" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "function",
    [
        "3*t^3 - t/(1 + t^2) + t^0 + 2",
        "sin(t)*cos(2*t) - tanh(t)/exp(-t)",
        "sqrt(1 + t)*log(2 + t)",
        "max(sin(t), cos(t))*min(t, 1/(1 + t)) + abs(t - 2)",
        "atan2(sin(3*t), 2 + t)",
        "step(t, 0.3, 2.9)*step(2*t, 0, 1)",
        "piecewise(t < 0.7, t^2, t < 1.3, sin(t), 2)",
        "lift(t/2) - lift(t/3)",
    ],
)
def test_derivatives(tmp_path: Path, function: str) -> None:
    motion = scene(tmp_path, function).drives[0].motion
    assert motion is not None
    for t in (0.41, 0.95, 1.9, 2.7):
        h = 1e-6
        difference = (value_at(motion, t + h) - value_at(motion, t - h)) / (2 * h)
        assert rate_at(motion, t) == pytest.approx(difference, rel=1e-7, abs=1e-8)
