"""The whole way: from the file through derivation, C and integration to what is shown. One beam, half a revolution."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.simulation.observables.beams import beam_points
from derive.simulation.observables.marker_positions import marker_positions
from derive.spec.model.markers import MarkerRef

SCENE = ROOT / "scenes/crank_slider_3.toml"


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The scene with one beam, for 0.02 s, and its reference."""
    folder = tmp_path_factory.mktemp("scene")
    text = SCENE.read_text()
    for old, new in (("pieces = 3 ", "pieces = 1 "), ("duration = 0.1 ", "duration = 0.02 "), ("[1, 2, 3]", "[1]")):
        assert text.count(old) == 1
        text = text.replace(old, new)
    (folder / "crank_slider_A.csv").write_text((SCENE.parent / "crank_slider_A.csv").read_text())
    path = folder / "crank_slider.toml"
    path.write_text(text)
    return path


def test_simulate(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """0.0142043 at 0.78 rad: an independent prototype of one beam in the mean frame gave the same."""
    out = short.parent / "results"
    assert main(["simulate", str(short), "--out", str(out), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    (curve_of,) = found["plots"][0]["curves"]
    assert curve_of["largest"]["value"] == pytest.approx(0.0142043, abs=1e-7)
    assert curve_of["largest"]["at"] == pytest.approx(0.78)
    assert found["runs"][0]["drift"] < 1e-9 and not found["runs"][0]["deformed_start"]
    table = np.genfromtxt(out / "crank_slider_3/crank_slider_3.csv", names=True, delimiter=",")
    assert len(table) == 201 and table["slider_s"][0] == pytest.approx(0.45)


def test_poses_and_amplitudes_tell_where_markers_are(short: Path) -> None:
    """The player draws points at their positions in the model, and joints hold them together."""
    scene = derive.read(short)
    motion = derive.simulate(scene).motion
    rod = scene.bodies[1]
    left, middle, right = beam_points(motion, rod)
    for name, shown in (("left", left), ("middle", middle), ("right", right)):
        np.testing.assert_allclose(marker_positions(motion, MarkerRef("rod", name)), shown, atol=1e-14)
    np.testing.assert_allclose(marker_positions(motion, MarkerRef("crank", "pin")), left, atol=1e-12)
    np.testing.assert_allclose(marker_positions(motion, MarkerRef("slider", "pin")), right, atol=1e-12)
    angle = 150 * motion.t
    pin = 0.15 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    np.testing.assert_allclose(marker_positions(motion, MarkerRef("crank", "pin")), pin, atol=1e-14)
