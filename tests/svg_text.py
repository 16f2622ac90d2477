"""The positions of the texts of a picture (SVG): boxes from the metrics of its font, in the units of its view box."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from xml.etree import ElementTree

import numpy as np
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path
from numpy.typing import NDArray

SVG = "{http://www.w3.org/2000/svg}"
SHIFT = {"start": 0.0, "middle": -0.5, "end": -1.0}
"""The left edge of a text from its anchor, in widths of the text."""

Affine = NDArray[np.float64]
"""A map (3, 3) of the plane in homogeneous coordinates."""


@dataclass(frozen=True)
class Box:
    """A rectangle that contains a text: left, top, right, bottom."""

    text: str
    left: float
    top: float
    right: float
    bottom: float


def text_boxes(svg: str) -> list[Box]:
    """The boxes of all texts of a picture.

    The font is DejaVu Sans, which is wider than most, so that texts that fit in it fit in those of other machines.
    """
    root = ElementTree.fromstring(svg)
    rules = {
        selector.strip(): declarations
        for style in root.iter(SVG + "style")
        for selector, declarations in re.findall(r"([^{}]+)\{([^{}]*)\}", (style.text or "").split("@media", 1)[0])
    }
    return list(_boxes(root, np.eye(3), rules))


def outside(svg: str) -> list[Box]:
    """The texts that are not within the view box."""
    root = ElementTree.fromstring(svg)
    left, top, width, height = map(float, root.attrib["viewBox"].split())
    return [
        box
        for box in text_boxes(svg)
        if box.left < left or box.top < top or box.right > left + width or box.bottom > top + height
    ]


def _boxes(element: ElementTree.Element, above: Affine, rules: dict[str, str]) -> Iterator[Box]:
    here = above @ _transform(element.get("transform", ""))
    if element.tag == SVG + "text":
        text = "".join(element.itertext())
        x, y = float(element.get("x", "0")), float(element.get("y", "0"))
        style = "; ".join([rules.get("text", ""), rules.get("." + element.get("class", ""), "")])
        size, bold = _font(f"{style}; {element.get('style', '')}")
        width, ascent, descent = _metrics(text, size, bold)
        anchor = re.search(r"text-anchor: (\w+)", element.get("style", ""))
        start = x + width * SHIFT[anchor[1] if anchor else element.get("text-anchor", "start")]
        corners = [(u, v, 1.0) for u in (start, start + width) for v in (y - ascent, y + descent)]
        points = (here @ np.array(corners).T)[:2]
        (left, top), (right, bottom) = points.min(axis=1), points.max(axis=1)
        yield Box(text, left, top, right, bottom)
    for child in element:
        yield from _boxes(child, here, rules)


def _font(style: str) -> tuple[float, bool]:
    """Size and weight, of which the last declarations count."""
    sizes = re.findall(r"font(?:-size)?:[^;]*?([\d.]+)px", style)
    weights = re.findall(r"font(?:-weight)?: *(bold|\d00)\b", style)
    return float(sizes[-1]) if sizes else 16.0, bool(weights) and weights[-1] in ("bold", "600", "700")


@cache
def _metrics(text: str, size: float, bold: bool) -> tuple[float, float, float]:
    font = FontProperties(family="DejaVu Sans", weight="bold" if bold else "normal", size=size)
    width, height, descent = text_to_path.get_text_width_height_descent(text, font, False)
    return width, height - descent, descent


def _transform(text: str) -> Affine:
    result = np.eye(3)
    for kind, numbers in re.findall(r"(\w+)\(([^)]*)\)", text):
        values = [float(x) for x in re.split(r"[ ,]+", numbers.strip())]
        result = result @ _map(kind, values)
    return result


def _map(kind: str, values: list[float]) -> Affine:
    if kind == "translate":
        return _shift(values[0], values[1] if len(values) > 1 else 0.0)
    if kind == "scale":
        return np.diag([values[0], values[-1], 1.0])
    assert kind == "rotate", kind
    c, s = math.cos(math.radians(values[0])), math.sin(math.radians(values[0]))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return turn if len(values) == 1 else _shift(values[1], values[2]) @ turn @ _shift(-values[1], -values[2])


def _shift(x: float, y: float) -> Affine:
    return np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]])
