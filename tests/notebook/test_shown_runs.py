"""The texts and the HTML of motions, modes and models for hosts: a bar on a hinge, one derivation for all of them."""

from __future__ import annotations

import json
import sys
from dataclasses import replace

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.notebook.linear import modes_html
from derive.short_text import LINES, WIDTH
from derive.simulation.conversions import data_set
from derive.simulation.observables.csv_writer import Column
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.trajectory import column_docs, column_units
from derive.spec.toml.read import parse
from strict_html import Page

TEXT = """
name = "bar"
[scene]
gravity = [0, -9.81]
[ground.markers]
hook = [0, 0]
[bodies.bar]
mass = { symbol = "m", default = 2 }
inertia = 0.1
markers = { end = [-0.5, 0] }
start = { position = [0.5, 0] }
[joints.hinge]
kind = "revolute"
between = ["ground.hook", "bar.end"]
[outputs.speed]
kind = "velocity"
marker = "bar.end"
[simulation]
duration = 2
output = 0.002
"""


@pytest.fixture(scope="module")
def motion() -> derive.Trajectory:
    return derive.simulate(parse(TEXT))


def text(shown: object) -> str:
    """The text of an object, which is short."""
    lines = repr(shown).splitlines()
    assert 1 <= len(lines) <= LINES
    assert max(map(len, lines)) <= WIDTH
    return repr(shown)


def page(shown: object) -> Page:
    """The HTML that a notebook shows of an object: well-formed, and the same each time."""
    html: str = shown._repr_html_()  # type: ignore[attr-defined]
    assert html == shown._repr_html_()  # type: ignore[attr-defined]
    result = Page(html)
    assert result.faults == []
    return result


def test_a_motion_has_a_text_and_is_shown_with_its_chart_and_its_player(motion: derive.Trajectory) -> None:
    assert text(motion).splitlines()[0] == "Trajectory of bar: 1001 rows from 0 to 2 s"
    shown = page(motion)
    assert shown.count("svg") == 1
    assert shown.words["td"][0] == "t"
    assert set(motion.columns) <= set(shown.words["td"])
    (player,) = shown.values("srcdoc")
    data = json.loads(player.split('id="motion">')[1].split("</script>")[0])
    assert data["view"][2] - data["view"][0] > 1  # the body swings about its only marker, which stays where it is
    instants = len(data["time"]["values"])
    assert 100 < instants < 1001
    assert f"The player shows {instants} of the 1001 instants; the columns have all of them." in shown.words["p"]


def test_a_motion_with_plots_shows_these(motion: derive.Trajectory) -> None:
    spec = parse(TEXT + '[plots.swing]\ny = ["bar_phi"]\n[plots.velocity]\ny = ["speed_1", "speed_2"]\n')
    shown = page(replace(motion, scene=spec))
    assert shown.count("svg") == 2
    assert "bar: speed_1, speed_2" in "".join(shown.words["title"])


def test_a_motion_of_one_instant_has_no_player(motion: derive.Trajectory) -> None:
    first = {name: getattr(motion.solution, name)[:1] for name in ("t", "q", "v", "lam", "drift", "outputs")}
    solution = replace(motion.solution, **first)
    one = replace(motion, solution=solution, motion=replace(motion.motion, t=solution.t, q=solution.q, v=solution.v))
    assert not page(one).count("iframe")
    assert page(one).words["td"][2] == "0"


def test_the_parts_of_a_motion_have_texts(motion: derive.Trajectory) -> None:
    assert "nq = 1, nv = 1, np = 1, nlambda = 0" in text(motion.motion.native)
    assert "1001 rows from 0 to 2 s" in text(motion.solution)
    assert "drift" in text(motion.solution)
    assert "consistent state" in text(motion.initial)
    assert "consistent state" in "".join(page(motion.initial).words["p"])
    assert "bodies.bar.start.position (component 1)" in page(motion.initial).words["td"]


def test_modes_and_what_hosts_see_have_texts_and_html() -> None:
    scene = parse(TEXT)
    modes = derive.modes(scene)
    assert f"{modes.frequencies[0]:.4g} Hz" in text(modes)
    assert "equilibrium" in text(modes)
    shown = page(modes)
    assert f"{modes.frequencies[0]:.6g}" in shown.words["td"]
    assert shown.count("iframe") == 1
    assert "states x   bar_phi" in text(modes.linear)
    assert [cell for cell in page(modes.linear).words["td"] if cell == "bar_phi, bar_phidot"]
    assert "stable" in text(modes.equilibrium)
    assert "q[0]" in page(modes.equilibrium).words["td"]
    assert text(modes.modes[0]).startswith("Mode: ")
    assert modes_html(modes) == modes._repr_html_()
    host = derive.host_model(scene)
    assert "outputs     speed_1, speed_2" in text(host)
    assert {"m", "kg", "bar_phi", "speed_2"} <= set(page(host).words["td"])


def test_a_motion_becomes_a_data_set_of_xarray_with_units_and_descriptions(motion: derive.Trajectory) -> None:
    xarray = pytest.importorskip("xarray")
    data = motion.to_xarray()
    assert isinstance(data, xarray.Dataset)
    assert data.attrs["title"] == "bar"
    assert dict(data.sizes) == {"time": 1001}
    assert data.time.attrs == {"units": "s", "long_name": "time"}
    assert tuple(data.data_vars) == motion.columns[1:]
    for name in motion.columns[1:]:
        assert np.array_equal(data[name], motion[name])
        assert data[name].attrs["units"] == (motion.units[name] or "1")
    ratio = data_set("a", [Column("t", "s", np.ones(2)), Column("r", "", np.ones(2))], {"t": "time", "r": "ratio"})
    assert ratio["r"].attrs == {"units": "1", "long_name": "ratio"}
    angle = motion.model.coordinates[0]
    assert data["bar_phi"].attrs["long_name"] == angle.doc
    assert float(data["bar_phi"].sel(time=1.0)) == motion["bar_phi"][500]


def test_what_is_missing_for_a_conversion_is_said(motion: derive.Trajectory, monkeypatch: pytest.MonkeyPatch) -> None:
    for package, convert in (("xarray", motion.to_xarray), ("pandas", motion.to_pandas)):
        monkeypatch.setitem(sys.modules, package, None)
        with pytest.raises(derive.TisserandError, match=f"pip install {package}"):
            convert()


def test_the_columns_of_all_scenes_have_descriptions() -> None:
    """A driven joint, multipliers, rates and outputs: a description for each column, in the order of the columns."""
    scene = derive.read(ROOT / "scenes/crank_slider_3.toml")
    run = PreparedRun(scene)
    docs = dict(zip([name for name, _ in column_units(scene, run.model)], column_docs(scene, run.model), strict=True))
    assert docs["motor"] == "prescribed motion of crank_bearing"
    assert docs["rod_1_phi"] == "rod_1: rotation of the floating frame"
    assert docs["lambda_crank_pin_1"].startswith("multiplier: ")
    assert all(docs.values())
