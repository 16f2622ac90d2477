"""The output and the charts of `study frames`; the times of the two frames are measured interleaved."""

from __future__ import annotations

import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path

import pytest
from made_up import frame_study, row

import derive
from derive.artifacts import MARK
from derive.cli.main import main
from derive.lowering.elimination_orders import EliminationRule
from derive.lowering.flat.kkt_matrix import DependentConstraints
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse
from derive.study.frame_cost import _lowered
from derive.study.frame_cost_chart import frame_cost_svg
from derive.study.frame_cost_table import frame_cost_data, frame_cost_text
from derive.study.timing import interleaved, ratio

DRAW = """
import sys
sys.path.insert(0, {here!r})
from test_study_frames import drawn
sys.stdout.write(drawn())
"""


def drawn() -> str:
    return frame_cost_svg(frame_study("slider & more", row(1), row(3, 0.7e-6), row(30)))


SINES = """
name = "sines"
[bodies.rod]
ansatz = { kind = "pinned", count = 2 }
markers = { left = -1 }
[simulation]
duration = 1
output = 0.1
"""


@pytest.mark.parametrize("study", ["frames", "pivots"])
def test_shapes_that_do_not_fit_a_frame_are_named_with_their_place(study: str, tmp_path: Path, capsys) -> None:
    path = tmp_path / "sines.toml"
    path.write_text(SINES)
    assert main(["study", study, str(path), "--pieces", "1"]) == 2
    message = capsys.readouterr().err
    assert message.startswith(f"{path}:4: bodies.rod.ansatz: in the frame mean: pinned shapes do not fulfil")


TWICE = """
name = "twice"
scene.gravity = [0, -9.81]
ground.markers = { o = [0, 0] }
[bodies.arm]
mass = 1
inertia = 0.1
markers = { o = [0, 0], tip = [1, 0] }
[bodies.rod]
ansatz = ["1", "xi", "xi^2"]
mass = 0.1
length = 0.5
bending_stiffness = 5
markers = { left = -1 }
start = { position = [1.25, 0] }
[joints.one]
kind = "revolute"
between = ["ground.o", "arm.o"]
[joints.other]
kind = "revolute"
between = ["ground.o", "arm.o"]
[joints.pin]
kind = "revolute"
between = ["arm.tip", "rod.left"]
[simulation]
duration = 0.1
output = 0.05
"""


def test_redundant_joints_have_a_proximal_term() -> None:
    scene = parse(TWICE)
    assert isinstance(scene, Scene)
    equations = derive.derive(scene).expanded()
    assert _lowered(equations, scene, EliminationRule.SAFE).proximal
    with pytest.raises(DependentConstraints, match="other_1"):
        _lowered(equations, replace(scene, redundant="error"), EliminationRule.SAFE)
    (text,) = (
        line
        for line in frame_cost_text(frame_study("twice", replace(row(1), redundant=True))).splitlines()
        if "redund" in line
    )
    assert "joints are redundant, and the KKT matrices are singular" in text


def test_pivots_of_redundant_joints_are_not_compared(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "twice.toml"
    path.write_text(TWICE)
    assert main(["study", "pivots", str(path), "--pieces", "1"]) == 2
    message = capsys.readouterr().err
    assert "a pivot vanishes in every order" in message and "other_1" in message


def test_frames_take_turns() -> None:
    calls: list[str] = []

    def way(name: str):
        return lambda: calls.append(name) or float(len(calls))

    told: list[int] = []
    assert interleaved([way("mean"), way("point")], 3, told.append) == [(1, 2), (3, 4), (5, 6)]
    assert calls == ["mean", "point"] * 3 and told == [0, 1, 2]


def test_ratios_are_of_pairs() -> None:
    found = ratio([(1.0, 2.0), (3.0, 4.0), (9.0, 10.0)])
    assert (found.median, found.least, found.most) == (0.75, 0.5, 0.9)
    # The ratio of the medians would be 3 / 4.
    found = ratio([(1.0, 2.0), (8.0, 4.0), (3.0, 10.0)])
    assert (found.median, found.least, found.most) == (0.5, 0.3, 2.0)


def test_the_table() -> None:
    lines = frame_cost_text(frame_study("slider", row(1), row(3), row(10))).splitlines()
    cells = [line.split() for line in lines]
    assert cells[7][:9] == ["3", "mean", "16", "138", "29", "594", "411", "42", "922"]
    assert cells[5][:3] == ["ratio", "0.35", "0.82"]
    assert [r[-3:] for r in cells if r[:1] == ["ratio"]] == [
        ["0.50", "0.49..0.53", "0.97"],
        ["0.50", "0.49..0.53", "0.92"],
        ["0.50", "0.50", "0.49..0.53"],  # the paper has no 10 beams
    ]
    assert "not the same measurement" in " ".join(" ".join(c) for c in cells)


@pytest.mark.parametrize(("rule", "safe"), [(EliminationRule.SAFE, True), (EliminationRule.MATCHED, False)])
def test_it_says_of_each_elimination_order_whether_it_is_safe_in_every_state(rule: EliminationRule, safe: bool) -> None:
    study = frame_study("slider", row(1), elimination=rule)
    text = " ".join(frame_cost_text(study).split())
    assert ("not safe in every state" in text) is not safe and "safe in every state" in text
    assert frame_cost_data(study)["safe_in_every_state"] is safe


def test_the_paper_compares_other_frames_with_nothing() -> None:
    study = frame_study("slider", row(1), frames=("chord", "point"))
    said = frame_cost_text(study)
    assert "DADS" not in said and "0.97" not in said
    assert "DADS" not in frame_cost_svg(study)


def test_nothing_names_the_machine_or_a_path() -> None:
    known = frame_cost_data(frame_study("slider", row(1)))
    assert known["flags"].split()[:2] == ["-std=c99", "-O2"] and known["compiler"]
    assert not any("/" in known[key] or not known[key] for key in ("flags", "machine"))


@pytest.mark.long
def test_the_chart_has_the_same_bytes_each_time() -> None:
    code = DRAW.format(here=str(Path(__file__).parent))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    assert done.stdout.decode() == drawn()


def test_the_chart_is_a_picture_with_its_numbers() -> None:
    text = drawn()
    root = ElementTree.fromstring(text)
    assert MARK in text[:1000] and "slider &amp; more" in text
    said = "".join(root.itertext())
    assert "30 beams: CPU time 0.50" in said and "0.70" in said and "CPU time in the paper (1988, DADS)" in said


@pytest.mark.parametrize("pieces", [1, 30])
def test_one_row_is_a_chart_as_well(pieces: int) -> None:
    ElementTree.fromstring(frame_cost_svg(frame_study("slider", row(pieces))))
