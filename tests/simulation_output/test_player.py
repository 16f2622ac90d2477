"""The page that plays a motion: one island of JSON, no network, and the geometry of the model."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html import unescape
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import slider

from browser import CHROMIUM, browsed
from derive.artifacts import MARK
from derive.simulation.observables.csv_writer import Column
from derive.simulation.observables.marker_positions import marker_positions
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.observables.player_data import MAX_FRAMES, curves_data, player_data, speeds
from derive.simulation.prepared_run import PreparedRun
from derive.spec.model.markers import MarkerRef, PointMarker
from derive.spec.model.planar_bodies import RigidBody
from derive.spec.toml.read import parse
from derive.visual.player import json_island, player_page

EVIL = "</script><script>alert(1)</script>&<!--"


def page(motion: SceneMotion, curves: list[Column]) -> str:
    return player_page(player_data(motion, curves))


def decoded(channel: dict) -> np.ndarray:
    return np.cumsum(channel["values"]) * channel["step"]


def data_of(text: str) -> dict:
    return json.loads(re.search(r'<script type="application/json" id="motion">(.*?)</script>', text, re.S)[1])


def test_the_island_comes_back_and_cannot_be_left() -> None:
    given = {"name": EVIL, "x": [1.5, 2]}
    text = json_island(given)
    assert json.loads(text) == given
    assert not set("<>&") & set(text)
    evil = slider.motion(1, 3, EVIL)
    shown = page(evil, [Column(EVIL, EVIL, np.zeros(3))])
    assert data_of(shown)["name"] == EVIL and data_of(shown)["curves"][0]["unit"] == EVIL
    assert "alert(1)</script>" not in shown and shown.count("</script>") == 2


def test_it_needs_nothing_from_outside() -> None:
    text = page(slider.motion(3), [])
    assert MARK in text[:1000]
    assert len(text.encode()) < 300_000
    assert re.findall(r"https?://[^\s\"'`]+", text) == ["http://www.w3.org/2000/svg"] * 2
    assert not re.search(r"<link|@import|url\(|fetch\(|import\(|src=", text)


def test_frames_are_few_and_true() -> None:
    motion = slider.motion(3)
    found = player_data(motion, [])
    t = decoded(found["time"])
    assert len(t) == 501 <= MAX_FRAMES and t[-1] == pytest.approx(0.1)
    rod = found["beams"][0]
    for place in found["markers"]:
        if place["body"] != "rod":
            continue
        index, xi = place["on"]
        piece = rod["pieces"][int(index)]
        c1, c2, phi = map(decoded, piece["pose"])
        alphas = map(decoded, piece["amplitudes"])
        y = sum(a * shape(s, xi) for a, s in zip(alphas, rod["shapes"], strict=True))
        x = xi * rod["half"]
        at = np.stack([c1 + np.cos(phi) * x - np.sin(phi) * y, c2 + np.sin(phi) * x + np.cos(phi) * y], axis=1)
        wanted = marker_positions(motion, MarkerRef("rod", place["marker"]))[::2]
        np.testing.assert_allclose(at, wanted, atol=5e-6)  # m


def shape(terms: list[list[float]], xi: float) -> float:
    """The value of a shape function as geometry.js evaluates it."""
    return sum(
        xi**power * np.exp(growth * xi) * (cosine * np.cos(frequency * xi) + sine * np.sin(frequency * xi))
        for power, cosine, sine, growth, frequency in terms
    )


def test_what_does_not_change_is_told_once_and_much_is_thinned() -> None:
    found = player_data(slider.motion(1, 7), [])
    assert len(found["rigid"][0]["pose"][0]["values"]) == 1
    assert len(found["time"]["values"]) == 7
    few = player_data(slider.motion(1, 3), [Column("a", "m", np.array([0.0, 1.0, 3.0]))])
    assert [text for _, text in few["time"]["ticks"]] == ["0", "0.02", "0.04", "0.06", "0.08", "0.10"]
    assert few["curves"][0]["ticks"] == [(0.0, "0"), (1.0, "1"), (2.0, "2"), (3.0, "3")]
    many = slider.motion(32, 401)
    text = page(many, [])
    assert len(text) < 300_000 and 100 < len(data_of(text)["time"]["values"]) <= MAX_FRAMES


def test_what_varies_little_about_a_large_value_has_no_stairs() -> None:
    t = np.linspace(0.0, 1.0, 101)
    sag = Column("sag", "m", 3 + 2e-3 * np.cos(9 * t))
    (curve,) = curves_data([sag], np.arange(101))
    assert np.abs(decoded(curve["values"]) - sag.values).max() < 1e-3 * 4e-3
    (curve,) = curves_data([replace(sag, values=3 + 1e-5 * t)], np.arange(101))
    assert len(curve["values"]["values"]) == 1


def test_outlines_speeds_and_guides() -> None:
    motion = slider.motion(1, 5)
    corners = [("a", 0, 0), ("b", 2, 0), ("c", 1, 1), ("d", 1, 0), ("e", 0, 2)]
    plate = RigidBody("crank", None, None, (0, 0), tuple(PointMarker(n, x, y) for n, x, y in corners))
    crank = replace(plate, markers=(*plate.markers, *motion.scene.bodies[0].markers))
    scene = replace(motion.scene, bodies=(crank, *motion.scene.bodies[1:]))
    found = player_data(SceneMotion(scene, motion.native, motion.k, motion.t, motion.q, motion.v), [])
    assert found["rigid"][0]["outline"] == [[0, 0], [2, 0], [0, 2]]
    guide = found["joints"][3]
    assert guide["axis"] == [1, 0] and "axis" not in found["joints"][0]
    assert found["joints"][0]["circles"] == (((0.0, 0.0), 1.0),) and not found["joints"][0]["lines"]
    assert 0.15 <= guide["range"][0] < guide["range"][1] <= 0.45
    assert speeds(0.1) == [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1]
    assert speeds(10)[3] == 1 and speeds(15)[3] in (1, 2) and len(speeds(0)) == 7


MEASURE = """<script>
{ scrollTo(0, document.body.scrollHeight);
const box = e => { const r = e.getBoundingClientRect(); return [r.left, r.top, r.right, r.bottom]; };
const strips = [...document.querySelectorAll("figure svg")], texts = e => [...e.querySelectorAll("text")];
const boxes = query => [...document.querySelectorAll(query)].map(box);
document.body.dataset.boxes = JSON.stringify({
  window: [innerWidth, innerHeight, scrollY, document.documentElement.scrollWidth], stage: boxes("#stage"),
  supports: boxes("[data-k=hatch]"), controls: boxes("#play, #time, #loop, #speed"), figures: boxes("figure"),
  hidden: [...document.querySelectorAll("[hidden]")].map(e => getComputedStyle(e).display),
  scales: strips.map(e => [box(e), ...texts(e).map(box)]),
  numbers: strips.map(e => texts(e).map(t => t.textContent)),
}); }
</script>"""


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here")
@pytest.mark.parametrize("size", ["1400,1000", "400,900"])
def test_controls_stay_beside_the_animation_and_curves_have_scales(size: str, tmp_path: Path) -> None:
    """On a page with twelve curves, numbers of scales lie within their pictures and do not overlap."""
    motion = slider.motion(1)
    shown = page(motion, [Column(f"y{n}", "m", -(10.0 ** (n - 8)) * motion.t) for n in range(12)])
    path = tmp_path / "page.html"
    path.write_text(shown.replace("</body>", f"{MEASURE}</body>"))
    text = re.search(r'data-boxes="([^"]*)"', browsed(path, "t=0.02", size))
    assert text is not None
    boxes = json.loads(unescape(text[1]))
    width, height, scrolled, needed = boxes["window"]
    assert scrolled > 100 and needed <= width
    (stage,) = boxes["stage"]
    for left, top, right, bottom in [stage, *boxes["controls"]]:
        assert left >= 0 and top >= 0 and right <= width and bottom <= height
    beside = [figure for figure in boxes["figures"] if figure[0] > stage[2]]
    below = [figure for figure in boxes["figures"] if figure[1] > max(control[3] for control in boxes["controls"])]
    assert len(beside) == 12 if width > 1100 else below
    assert set(boxes["hidden"]) == {"none"}
    for (left, top, right, bottom), *numbers in boxes["scales"]:
        assert all(left <= n[0] and top <= n[1] and n[2] <= right and n[3] <= bottom for n in numbers)
        pairs = combinations(numbers, 2)
        assert not any(a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3] for a, b in pairs)
    assert all(len(numbers) >= 5 and numbers[-1] == "0.10 s" for numbers in boxes["numbers"])
    assert boxes["numbers"][-1][:2] == ["\N{MINUS SIGN}100", "\N{MINUS SIGN}50"]


POLE = """
name = "pole"
[ground.markers]
o = [0, 0]
[bodies.pole]
mass = 1
inertia = 1
markers = { foot = [0, 0], top = [1, 0] }
[joints.hinge]
kind = "revolute"
between = ["ground.o", "pole.foot"]
start = { angle = 1.5707963267948966 }
[simulation]
duration = 0.01
output = 0.005
"""


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here")
@pytest.mark.parametrize("size", ["1050,420", "1400,1000"])
def test_the_sign_of_a_support_is_within_the_drawing(size: str, tmp_path: Path) -> None:
    """Also at the lowest point of a motion, in a window that is wide and low."""
    motion = PreparedRun(parse(POLE), complete=False).trajectory().motion
    path = tmp_path / "page.html"
    path.write_text(page(motion, [Column("y", "m", motion.t)]).replace("</body>", f"{MEASURE}</body>"))
    text = re.search(r'data-boxes="([^"]*)"', browsed(path, "t=0.0", size))
    assert text is not None
    boxes = json.loads(unescape(text[1]))
    (stage,), (sign,) = boxes["stage"], boxes["supports"]
    assert stage[0] <= sign[0] and stage[1] <= sign[1] and sign[2] <= stage[2] and sign[3] <= stage[3]


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here")
def test_it_plays_in_a_browser(tmp_path: Path) -> None:
    """Its scripts run: the crank pin is drawn where it is, at the instant that was asked for."""
    motion = slider.motion(3)
    path = tmp_path / "page.html"
    path.write_text(page(motion, [Column("deflection", "m", motion.t)]))
    dom = browsed(path, "t=0.02&bend=5", "1000,800").split("<script", 1)[0]
    assert "t = <b>0.0200</b> s" in dom and "motor = <b>3.000</b> rad" in dom
    pins = re.findall(r'<path data-k="pin" d="M([-\d.]+) ([-\d.]+)a', dom)
    (hub, pin, end) = [np.array([float(x), float(y)]) for x, y in pins]
    angle = slider.SPEED * 0.02
    crank, rod = (pin - hub) * [1, -1], (end - hub) * [1, -1]
    np.testing.assert_allclose(crank / np.hypot(*crank), [np.cos(angle), np.sin(angle)], atol=1e-3)
    assert rod[0] / np.hypot(*crank) == pytest.approx(motion.q[200, -1] / 0.15, rel=2e-3)
    assert re.search(r'<path data-k="rod" d="M[-\d. L]{200,}"', dom)
