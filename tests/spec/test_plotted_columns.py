"""Columns of plots and of `until` that there cannot be are refused when a specification is read, others by `build`."""

from __future__ import annotations

from pathlib import Path

import pytest

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.simulation.simulated_scene import beam_scene
from derive.simulation.trajectory import column_units
from derive.spec.checks.plotted_columns import possible_columns
from derive.spec.model.scene import Scene
from derive.spec.set_values import with_values
from derive.spec.toml.read import parse

SLIDER, FREE = ROOT / "scenes/crank_slider_3.toml", ROOT / "scenes/free_beam_mean.toml"
OUTPUT = '[outputs.force]\nkind = "reaction"\njoint = "crank_pin"\n'


def errors(text: str) -> str:
    with pytest.raises(derive.SpecError) as error:
        parse(text, str(SLIDER))
    return str(error.value)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ('y = "rod_1_ph"', 'plots.p.y: there is no column "rod_1_ph"; did you mean "rod_1_phi"'),
        ('y = ["t", "forces_1"]', 'plots.p.y: there is no column "forces_1"; did you mean "force_1"?'),
        ('y = "rod_phi"\nx = "moto"', 'plots.p.x: there is no column "moto"; did you mean "motor"?'),
        ('y = "rod_4_phi"', 'there is no column "rod_4_phi"; did you mean "rod_'),
        ('y = "rod_1_s"', 'there is no column "rod_1_s"; did you mean "rod_1_c'),
        ('y = "zzz"', 'there is no column "zzz"; columns may be t, motor, crank_c1'),
    ],
)
def test_reading_refuses_columns_that_cannot_be(keys: str, message: str) -> None:
    text = f"{SLIDER.read_text()}\n{OUTPUT}"
    line = len(text.splitlines()) + 2
    found = errors(f"{text}[plots.p]\n{keys}\n").splitlines()
    assert message in found[-1] and any(found[-1].startswith(f"{SLIDER}:{line + k}: ") for k in (0, 1))


def test_single_beams_and_conditions() -> None:
    settings = "\n[simulation]\nduration = 1\noutput = 0.1\n"
    text = FREE.read_text()
    assert 'did you mean "beam_phi"' in errors(f'{text}{settings}[plots.p]\ny = "beam_ph"\n')
    assert "simulation.until: " in errors(f'{text}{settings}until = "phi > 1"\n')
    parse(f'{text}{settings}until = "beam_phi > 1"\n[plots.p]\ny = "beam_alpha1dot"\n')


def test_build_refuses_coordinates_that_joints_eliminate(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "slider.toml"
    text = SLIDER.read_text().replace('file = "', f'file = "{SLIDER.parent}/')
    path.write_text(f'{text}\n[plots.p]\ny = "crank_c1"\n')
    assert main(["build", str(path), "--out", str(tmp_path)]) == 2
    message = f'{path}:{len(text.splitlines()) + 3}: plots.p.y: there is no column "crank_c1"'
    assert message in capsys.readouterr().err and not (tmp_path / "crank_slider_3").exists()


def test_other_values_may_have_other_columns() -> None:
    """Only a simulation needs the columns of its plots: `modes --set` and the models of a study do not."""
    scene = parse(f'{SLIDER.read_text()}\n[plots.p]\ny = "rod_3_phi"\n', str(SLIDER))
    changed, _ = with_values(scene, {"bodies.rod.pieces": "1"})
    assert changed.bodies[1].pieces == 1 and changed.plots == scene.plots


@pytest.mark.parametrize("path", [SLIDER, FREE, ROOT / "scenes/four_bar.toml"], ids=lambda path: path.stem)
def test_all_columns_are_possible(path: Path) -> None:
    spec = derive.read(path)
    possible = possible_columns(spec)
    scene = spec if isinstance(spec, Scene) else beam_scene(spec)
    columns = [name for name, _ in column_units(scene, derive.lower(derive.derive(scene)))]
    assert possible is not None and not {*columns} - {*possible} and len(possible) == len({*possible})
