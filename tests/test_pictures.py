"""Every picture has an opaque background, light and dark as its text: the page around it may have another scheme."""

from __future__ import annotations

import re
from functools import cache
from xml.etree import ElementTree

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.generated_models import generated
from derive.spec.model.scene import Scene
from derive.visual.kkt_matrix import kkt_picture
from derive.visual.line_chart import Chart, Curve, Panel, svg
from derive.visual.mechanism import mechanism_picture
from derive.visual.mode_shapes import ModePanel, mode_picture
from derive.visual.sparsity import mass_patterns
from svg_text import outside

SVG = "{http://www.w3.org/2000/svg}"
LIGHT, DARK = "#ffffff", "#13171b"


COMMITTED = {path.stem: path for path in sorted((ROOT / "docs").rglob("*.svg"))}
DRAWN = ("mass", "kkt", "mechanism", "modes", "chart")


@cache
def drawn() -> dict[str, str]:
    """A picture of each kind that the code draws."""
    scene = derive.read(ROOT / "scenes/double_pendulum.toml")
    assert isinstance(scene, Scene)
    model, _ = generated(scene)
    assert model.kkt is not None
    line = np.array([[0.0, 0.0], [1.0, 0.5]])
    return {
        "mass": mass_patterns([model]),
        "kkt": kkt_picture(model.kkt, tuple(x.name for x in (*model.coordinates, *model.multipliers))),
        "mechanism": mechanism_picture(scene),
        "modes": mode_picture("modes", "note", [ModePanel("1", [line], [line + 0.1], [line - 0.1])], line),
        "chart": svg(Chart("title", "time", "s", (Panel("y", "", (Curve("a", np.arange(3.0), np.arange(3.0)),)),))),
    }


@pytest.fixture(params=[*COMMITTED, *DRAWN])
def picture(request: pytest.FixtureRequest) -> str:
    """A committed picture, or one that the code draws."""
    name = request.param
    return COMMITTED[name].read_text(encoding="utf-8") if name in COMMITTED else drawn()[name]


def backgrounds(text: str) -> tuple[str, str]:
    """The colours of the first thing that is drawn, which covers the whole picture, in both schemes."""
    root = ElementTree.fromstring(text)
    width, height = (float(x) for x in root.attrib["viewBox"].split()[2:])
    style, dark = text.split("</style>", 1)[0].split("prefers-color-scheme: dark", 1)
    first = next(e for e in root if e.tag in (SVG + "rect", SVG + "g"))
    if first.tag == SVG + "rect":
        assert (float(first.attrib["width"]), float(first.attrib["height"])) == (width, height)
        pattern = rf"\.{first.attrib['class']} {{ fill: (#\w+);? }}"
        return re.search(pattern, style)[1], re.search(pattern, dark)[1]  # type: ignore[index]
    path = next(first.iter(SVG + "path"))
    x, y = np.reshape([float(n) for n in re.findall(r"[\d.]+", path.attrib["d"])], (-1, 2)).T
    assert (x.min(), x.max(), y.min(), y.max()) == (0, width, 0, height)
    fill = re.search(r"fill: (#\w+)", path.attrib["style"])[1]  # type: ignore[index]
    return fill, re.search(rf'style\*="fill: {fill}"\] {{ fill: (#\w+) !important', dark)[1]  # type: ignore[index]


def test_the_background_is_opaque(picture: str) -> None:
    assert backgrounds(picture) == (LIGHT, DARK)


def test_all_texts_are_within_the_picture(picture: str) -> None:
    assert outside(picture) == []
