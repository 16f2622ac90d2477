"""`tisserand modes` as a user meets it: text, table, record, matrices, picture and animation."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from linear_scenes import hanging_rod, pendulums

import derive
from browser import CHROMIUM, browsed
from conftest import ROOT
from derive.artifacts import sha256
from derive.cli.main import main
from derive.simulation.linear.displaced import displaced, mode_lines
from derive.simulation.linear.modes import Modes
from derive.simulation.observables.marker_positions import marker_positions
from derive.simulation.observables.spatial_player_data import drawn_body
from derive.spec.model.markers import MarkerRef
from derive.visual.mode_pages import modes_page, modes_picture

PENDULUM = """\
name = "damped_bar"
[scene]
gravity = [0, -9.81]
[ground.markers]
hook = [0, 0]
[bodies.bar]
mass = { symbol = "m", unit = "kg", default = 2.0 }
inertia = 0.1
centre = [0.5, 0]
markers = { top = [0, 0], tip = [1, 0] }
start = { angle = -1.5707963267948966 }
keep_coordinates = true
[joints.pin]
kind = "revolute"
between = ["ground.hook", "bar.top"]
[springs.damper]
kind = "rotational"
between = ["ground.hook", "bar.top"]
stiffness = 0
damping = 0.5
"""


@pytest.fixture(scope="module")
def rod() -> Modes:
    return derive.modes(hanging_rod("drawn_rod", shapes=4))


def motions_of(page: str) -> list[dict]:
    return json.loads(re.search(r'id="motion">(.*?)</script>', page, re.S)[1])["motions"]


def test_it_prints_and_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "bar.toml"
    spec.write_text(PENDULUM)
    command = ["modes", str(spec), "--set", "m=3", "--out", str(tmp_path)]
    assert main(command) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    square, rate = 3 * 9.81 * 0.5 / (0.1 + 3 * 0.25), 0.5 / (0.1 + 3 * 0.25)
    row = next(line.split() for line in printed.out.splitlines() if line.startswith("  1 "))
    assert float(row[1]) == pytest.approx(np.sqrt(square) / (2 * np.pi), rel=1e-5)
    assert float(row[2]) == pytest.approx(rate / (2 * np.sqrt(square)), rel=1e-3)
    folder = tmp_path / "damped_bar"
    kinds = ("csv", "html", "json", "npz", "svg")
    assert sorted(p.name for p in folder.iterdir()) == [f"damped_bar.modes.{kind}" for kind in kinds]
    table = np.genfromtxt(folder / "damped_bar.modes.csv", names=True, delimiter=",")
    assert table["frequency"] == pytest.approx(np.sqrt(square) / (2 * np.pi), rel=1e-9)
    with np.load(folder / "damped_bar.modes.npz") as matrices:
        assert matrices["states"].tolist() == ["bar_phi", "bar_phidot"]
        np.testing.assert_allclose(matrices["A"], [[0, 1], [-square, -rate]], rtol=1e-9)
        tip = matrices["inputs"].tolist().index("bar_tip_F1")
        assert matrices["B"][1, tip] == pytest.approx(1 / (0.1 + 3 * 0.25)) == matrices["C"][tip, 0] / 0.85
        assert matrices["D"].shape == (4, 4)
    record = json.loads((folder / "damped_bar.modes.json").read_text())
    for name, digest in record["files"].items():
        assert sha256((folder / name).read_bytes()) == digest
    before = {p: p.read_bytes() for p in folder.iterdir()}
    assert main([*command, "--json"]) == 0  # over its own files, with the same bytes
    assert {p: p.read_bytes() for p in folder.iterdir()} == before
    plain = json.loads(capsys.readouterr().out)
    assert plain["modes"] == record["modes"] and len(plain["modes"]) == 1


def test_a_drive_at_constant_speed_is_refused_before_anything_is_derived(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A newcomer waited a minute and a half for this message."""
    monkeypatch.setattr("derive.simulation.linear.modes.generated", lambda scene: pytest.fail("derived"))
    driven = tmp_path / "driven.toml"
    driven.write_text(f'{PENDULUM}[drives.motor]\njoint = "pin"\nspeed = 3\n')
    assert main(["modes", str(driven), "--out", str(tmp_path / "new")]) == 2
    assert "drives move at t = 0 has no static equilibrium: motor" in capsys.readouterr().err


def test_wrong_uses(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    driven = tmp_path / "driven.toml"
    driven.write_text(f'{PENDULUM}[drives.motor]\njoint = "pin"\nmotion = "t - pi/2"\n')
    assert main(["modes", str(driven), "--out", str(tmp_path / "new")]) == 2
    text = capsys.readouterr().err
    assert "drives move at t = 0 has no static equilibrium: motor" in text
    assert 'start = "steady"' in text and "--at 0" in text
    beam = str(ROOT / "scenes/free_beam_mean.toml")
    assert main(["modes", beam, "--at", "0", "--out", str(tmp_path / "new")]) == 2
    assert "leave out --at" in capsys.readouterr().err and not (tmp_path / "new").exists()
    driven.write_text(PENDULUM)
    assert main(["modes", str(driven), "--at", "1e300", "--out", str(tmp_path / "new")]) == 2
    assert "driven.toml: --at 1e+300 (in Python at=1e+300) is no time, in s, up to which" in capsys.readouterr().err
    with pytest.raises(SystemExit) as stopped:
        main(["modes", beam, "--at", "-1"])
    assert stopped.value.code == 2 and "a time of at least 0" in capsys.readouterr().err


def test_an_unstable_state_is_announced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "bar.toml"
    spec.write_text(PENDULUM.replace("-1.57", "1.57"))
    assert main(["modes", str(spec), "--at", "0", "--out", str(tmp_path)]) == 0
    assert "warning: the state is unstable; mode 1 grows" in capsys.readouterr().out
    inverted = ["modes", str(ROOT / "scenes/double_pendulum.toml"), "--set", "scene.gravity=[-9.81, 0]"]
    assert main([*inverted, "--at", "0", "--out", str(tmp_path)]) == 0
    assert "warning: the state is unstable; modes 2, 4 grow\n" in capsys.readouterr().out


def test_a_single_zero_eigenvalue_is_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A damper on a wheel leaves its angle, at which nothing holds it, and one rate that decays."""
    (tmp_path / "wheel.toml").write_text(
        """name = "wheel"
ground.markers = { o = [0, 0] }
bodies.wheel = { mass = 1, inertia = 0.1, markers = { hub = [0, 0] } }
joints.hub = { kind = "revolute", between = ["ground.o", "wheel.hub"] }
springs.damper = { kind = "rotational", between = ["ground.o", "wheel.hub"], stiffness = 0, damping = 1 }
"""
    )
    assert main(["modes", str(tmp_path / "wheel.toml"), "--out", str(tmp_path)]) == 0
    assert "  1 eigenvalue is zero: a motion without stiffness\n" in capsys.readouterr().out


def test_the_picture_shows_linear_displacements(rod: Modes) -> None:
    lines = mode_lines(rod, rod.modes[0])
    swing = lines.displacements[0]  # it stays nearly straight and its tip moves by a tenth of its length
    np.testing.assert_allclose(lines.lines[0][-1], [0, -1], atol=1e-9)
    np.testing.assert_allclose(np.abs(swing[:, 0]), 0.1 * -lines.lines[0][:, 1], atol=1e-3)
    np.testing.assert_allclose(swing[:, 1], 0, atol=1e-9)
    root = ElementTree.fromstring(modes_picture(rod, 2))
    svg = "{http://www.w3.org/2000/svg}"
    kinds = [line.attrib["class"] for line in root.iter(f"{svg}path")]
    assert kinds == ["rest", "back", "there"] * 2
    titles = [text.text for text in root.iter(f"{svg}text") if text.attrib["class"] == "mode"]
    assert titles == [f"{i}: {mode.frequency:.4g} Hz" for i, mode in enumerate(rod.modes[:2], 1)]


def test_the_animation_keeps_the_joints(rod: Modes) -> None:
    motion = displaced(rod, rod.modes[1], np.array([0.0, np.pi / 2, np.pi]))
    hook = marker_positions(motion, MarkerRef("rod", "left"))
    np.testing.assert_allclose(hook, 0, atol=1e-12)
    tip = marker_positions(motion, MarkerRef("rod", "right"))[:, 0]
    assert tip[1] == pytest.approx(0, abs=1e-9) and tip[0] == pytest.approx(-tip[2], rel=1e-2)
    assert 0.01 < abs(tip[0]) < 0.11
    text = modes_page(rod, 2)
    motions = motions_of(text)
    assert [m["name"] for m in motions] == [f"{i}: {mode.frequency:.4g} Hz" for i, mode in enumerate(rod.modes[:2], 1)]
    for data, mode in zip(motions, rod.modes, strict=False):
        duration = np.sum(data["time"]["values"]) * data["time"]["step"]
        assert duration == pytest.approx(4 / mode.frequency, rel=1e-4)
    assert not re.search(r"<link|@import|url\(|fetch\(|import\(|src=", text)


def test_two_pendulums_move_together_and_against_each_other() -> None:
    found = derive.modes(pendulums("two_drawn", 2))
    for mode, sign in zip(found.modes, (1, -1), strict=True):
        first, second = (line[1, 0].real for line in mode_lines(found, mode).displacements)
        assert np.sign((second - first) * first) == sign


def test_a_beam_alone_is_drawn_like_a_scene() -> None:
    found = derive.modes(derive.planar_beam("lone", frame="point", mass=1, length=2, bending_stiffness=1))
    bending = mode_lines(found, found.modes[3])
    (line,) = bending.displacements  # the first bending shape has equal displacements of both ends
    assert line[0, 1].real == pytest.approx(line[-1, 1].real, rel=1e-9)
    assert np.abs(line).max() == pytest.approx(0.2, rel=1e-6) and np.sign(line[8, 1].real) == -np.sign(line[0, 1].real)
    assert len(re.findall("<path", modes_picture(found, 2))) == 6
    assert [m["beams"][0]["name"] for m in motions_of(modes_page(found, 2))] == ["beam", "beam"]


def test_a_body_in_space_is_drawn() -> None:
    body = derive.nodal_body("small_block", str(ROOT / "scenes/block.npz"), units="SI", modes=2, frame="mean")
    found = derive.modes(body)
    assert re.findall('<path class="(.*?)"', modes_picture(found, 2)) == ["rest", "there"] * 2
    first, second = motions_of(modes_page(found, 2))
    assert first["name"] == "7: 1834 Hz" and second["name"] == "8: 2749 Hz"
    (bending,) = (a for a in first["paths"][0]["amplitudes"] if len(a["values"]) > 1)
    moved = np.abs(np.cumsum(bending["values"])).max() * bending["step"] * drawn_body(body).phi[0]
    assert np.linalg.norm(moved, axis=1).max() == pytest.approx(0.1 * 0.4, rel=1e-3)


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here")
def test_a_mode_is_selected_in_a_browser(rod: Modes, tmp_path: Path) -> None:
    """#mode=2 draws the second motion at an instant: the tip is beside the line through the hook."""
    path = tmp_path / "page.html"
    path.write_text(modes_page(rod, 2))
    dom = browsed(path, "mode=2&t=0", "1000,800").split("<script", 1)[0]
    assert [f"{i}: {mode.frequency:.4g} Hz" in dom for i, mode in enumerate(rod.modes[:2], 1)] == [True, True]
    points = re.findall(r'<path data-k="(?:rod|beam)" d="M([^"]*)"', dom)[0].split("L")
    first, last = (np.array(point.split(), dtype=float) for point in (points[0], points[-1]))
    (motion,) = (displaced(rod, rod.modes[1], np.zeros(1)),)
    tip = marker_positions(motion, MarkerRef("rod", "right"))[0]
    assert (last - first)[0] / (first - last)[1] == pytest.approx(tip[0] / tip[1], rel=2e-2)


def test_modes_are_drawn_where_the_truncated_mass_matrix_is_not_definite() -> None:
    """The beam is clamped and of second order, with a mass at its tip, displaced by a tenth of its length."""
    rod = {"mass": 1, "length": 1, "bending_stiffness": 1, "ansatz": [f"xi^{n}" for n in range(6)], "order": 2}
    rod |= {"markers": {"root": -1, "tip": 1}, "masses": {"weight": {"at": 1, "mass": 0.5}}}
    clamp = {"kind": "weld", "between": ["ground.wall", "rod.root"]}
    found = derive.modes(derive.scene("tipped", ground={"wall": [0, 0]}, bodies={"rod": rod}, joints={"clamp": clamp}))
    motion = displaced(found, found.modes[3], np.array([0.0, np.pi / 2]))
    native = motion.native
    masses = [native.mass_pattern.dense(native.mass(q, motion.k)) for q in motion.q]
    assert [np.linalg.eigvalsh(mass)[0] > 0 for mass in masses] == [False, True]
    np.testing.assert_allclose(marker_positions(motion, MarkerRef("rod", "root")), 0, atol=1e-12)
    dots = [circle for circle in re.findall(r'<circle class="(.*?)"', modes_picture(found, 1)) if circle != "point"]
    assert dots == ["rest", "back", "there"]


def test_a_terminal_sees_how_far_the_motion_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In a pipe it is silent."""
    (tmp_path / "bar.toml").write_text(PENDULUM)
    arguments = ["modes", str(tmp_path / "bar.toml"), "--out", str(tmp_path), "--at", "0.25"]
    assert main(arguments) == 0
    assert capsys.readouterr().err == ""
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    assert main(arguments) == 0
    text = capsys.readouterr().err
    assert re.search(r"simulating damped_bar: [0-9.]+ of 0\.25 s", text) and text.endswith("\r\x1b[K")


def test_defaults_of_physical_constants_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Frequencies depend on them; --json has them in the record."""
    spec = tmp_path / "some.toml"
    spec.write_text('name = "some"\n[beam]\nlength = 2\nbending_stiffness = 3\n')
    expected = (
        f"{spec}:2: beam.mass: no mass is given, so that it is the parameter m, 1 kg by default; write mass = 1.0"
    )
    assert main(["modes", str(spec), "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().out.splitlines()[0] == f"warning: {expected}"
    assert main(["modes", str(spec), "--out", str(tmp_path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["warnings"] == [expected]
    spec.write_text('name = "some"\n[body]\nintegrals = "symbolic"\nmodes = 1\n')
    assert main(["modes", str(spec), "--out", str(tmp_path)]) == 0
    assert "warning: " in (text := capsys.readouterr().out) and "these are the modes with their defaults" in text


def test_an_equilibrium_says_which_functions_of_time_it_is_at(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "damped_bar.toml"
    loads = '[inputs.twist]\nvalue = "2*step(t, 0, 1)"\n[torques.twist]\nat = "bar.top"\nvalue = { input = "twist" }\n'
    file.write_text(PENDULUM + loads)
    assert main(["modes", str(file), "--out", str(tmp_path)]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "functions of time have their values at t = 0 there: inputs.twist.value; --at T linearises about" in text
    record = json.loads((tmp_path / "damped_bar/damped_bar.modes.json").read_text())
    assert record["functions_of_time"] == ["inputs.twist.value"]
    file.write_text(PENDULUM)
    assert main(["modes", str(file), "--out", str(tmp_path)]) == 0
    assert "functions of time" not in capsys.readouterr().out
