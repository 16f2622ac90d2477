"""The drawing of a scene in space in one configuration (SVG): its bodies with their surfaces and markers, to scale."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from html import escape
from typing import assert_never

import numpy as np

from derive.artifacts import MARK
from derive.simulation.observables.motion import Array
from derive.simulation.observables.spatial_player_data import BodyPath, DrawnBody, Tie, placed
from derive.visual.labelled_drawing import LETTER
from derive.visual.mode_pages import VIEW

WIDTH, MOST, EDGE = 640.0, 420.0, 46.0
"""The largest width and height of the drawing and the width of its margin, in pixels."""
BESIDE = 6
"""The distance of a label from its point across and upwards, in pixels."""
LAMP = np.array([-0.35, -0.55, 0.76])
"""The direction of the light: above the left shoulder of the reader."""

STYLE = """\
  <style>
    text { font: 13px system-ui, 'DejaVu Sans', sans-serif; fill: #1c2733; stroke: #ffffff; stroke-width: 3px;
      paint-order: stroke; }
    .face { stroke: #ffffff; stroke-width: 0.6; } .rigid { fill: #5c6975; fill-opacity: 0.55; }
    .flexible { fill: #1f7fab; } .shade { fill: #000000; stroke: none; }
    .link { stroke: #5c6975; stroke-width: 4; stroke-linecap: round; }
    .edge { stroke: #1f7fab; stroke-width: 1.6; } .tie, .spring { stroke: #5c6975; stroke-width: 1.6; }
    .spring { stroke-dasharray: 5 3; }
    .axis { stroke: #9aa6b2; stroke-width: 1.4; } .point { fill: #1c2733; }
    .stand { fill: none; stroke: #5a6670; stroke-width: 1.4; } .along { stroke: #a8560f; stroke-width: 1.8; }
    .joint { fill: #ffffff; stroke: #1c2733; stroke-width: 1.6; } .weld { fill: #1c2733; }
    @media (prefers-color-scheme: dark) {
      text { fill: #e6edf3; stroke: #0d1117; } .face { stroke: #0d1117; } .rigid { fill: #8d9aa6; }
      .flexible { fill: #58b4dc; } .link { stroke: #8d9aa6; } .edge { stroke: #58b4dc; }
      .tie, .spring { stroke: #8d9aa6; } .point { fill: #e6edf3; } .stand { stroke: #9ba7b1; }
      .along { stroke: #e0a564; } .joint { fill: #13171b; stroke: #e6edf3; } .weld { fill: #e6edf3; }
    }
  </style>"""

LEVELS = 8
"""The number of degrees of light in which faces without edges are drawn."""


def _smooth_style() -> str:
    """The rules of faces without edges, which have a class for each degree of light, in light and dark pages."""

    def rules(colour: tuple[int, int, int]) -> str:
        shades = (tuple(round(c * (0.7 + 0.3 * level / (LEVELS - 1))) for c in colour) for level in range(LEVELS))
        texts = (f"#{red:02x}{green:02x}{blue:02x}" for red, green, blue in shades)
        return " ".join(f".s{k} {{ fill: {text}; stroke: {text}; stroke-width: 0.6; }}" for k, text in enumerate(texts))

    light, dark = rules((0x8D, 0x9A, 0xA6)), rules((0xA8, 0xB4, 0xBF))
    return f"  <style>{light} @media (prefers-color-scheme: dark) {{ {dark} }}</style>"


SYMBOL = 6.0
"""The radius of the symbol of a joint, in pixels."""


class JointSymbol(Enum):
    """The symbol of a joint, by the relative motions that it leaves."""

    WELD = "none"
    HINGE = "a rotation"
    UNIVERSAL = "two rotations"
    BALL = "three rotations"
    GUIDE = "displacements"
    GUIDE_THAT_TURNS = "displacements and rotations"


@dataclass(frozen=True, eq=False)
class JointMark:
    """The symbol of a joint at a place (3,), m, with the direction (3,) of its z axis; `label` is its title."""

    label: str
    symbol: JointSymbol
    at: Array
    axis: Array


Shape = tuple[float, str]
"""A depth and the element of SVG that is drawn there."""


def spatial_picture(
    name: str,
    bodies: list[DrawnBody],
    paths: list[BodyPath],
    ground: list[tuple[str, Array]],
    ties: Sequence[Tie] = (),
    joints: Sequence[JointMark] = (),
) -> str:
    """The picture of bodies at the first instant of their paths.

    ground: names and places (3,), m, of the markers of the ground. ties: the lines between markers.
    joints: their symbols, which are drawn above the bodies.
    """
    shown = [placed(body, path)[0] @ _axes().T for body, path in zip(bodies, paths, strict=True)]
    fixed = [(label, _axes() @ at) for label, at in ground]
    every = np.concatenate([*shown, *(at[None] for _, at in fixed), np.zeros((1, 3))])
    triad = np.vstack([np.zeros(3), 0.35 * float(np.ptp(every, axis=0).max()) * _axes().T])
    every = np.concatenate([every, triad])
    low, high = every[:, :2].min(axis=0), every[:, :2].max(axis=0)
    scale = min((WIDTH - 2 * EDGE) / max(high[0] - low[0], 1e-12), (MOST - 2 * EDGE) / max(high[1] - low[1], 1e-12))
    size = (high - low) * scale + 2 * EDGE

    def pixels(points: Array) -> Array:
        """The places (n, 3) on the page, with their depths."""
        x = EDGE + (points[:, 0] - low[0]) * scale
        y = EDGE + (high[1] - points[:, 1]) * scale
        return np.stack([x, y, points[:, 2] * scale], axis=1)

    shapes = [shape for body, points in zip(bodies, shown, strict=True) for shape in _shapes(body, pixels(points))]
    ends = {(k, i): shown[k][node] for k, body in enumerate(bodies) for i, (_, node) in enumerate(body.markers)}
    ends |= {(-1, i): at for i, (_, at) in enumerate(fixed)}
    shapes += [_tie(tie, pixels(np.array([ends[end] for end in tie.ends]))) for tie in ties]
    tips = pixels(triad)
    axes = [_line("axis", tips[0], tip) for tip in tips[1:]]
    places = _beside_each_other([pixels((_axes() @ joint.at)[None])[0] for joint in joints])

    def label(name: str, at: Array) -> str:
        """The label of a marker; its point is left out below the symbol of a joint."""
        hidden = any(np.hypot(*(at - place)[:2]) < SYMBOL for place in places)
        return _text(name, at) if hidden else _label(name, at)

    named = [
        (marker, pixels(points[number][None])[0])
        for body, points in zip(bodies, shown, strict=True)
        for marker, number in body.markers
    ]
    named += [(marker, pixels(at[None])[0]) for marker, at in fixed]
    names = [*_together(named)]
    labels = [label(text, at) for text, at in names]
    labels += [_text(f"e{k}", tip) for k, tip in enumerate(tips[1:], 1)]
    width = max(size[0], *(at[0] + 2 * BESIDE + LETTER * len(text) for text, at in names), 0.0)
    marks = [_joint(joint, at[:2], _axes() @ joint.axis) for joint, at in zip(joints, places, strict=True)]
    stands = [_stand(pixels(at[None])[0][:2]) for _, at in fixed]
    bodies_drawn = [text for _, text in sorted(shapes, key=lambda shape: shape[0])]
    content = [*axes, *stands, *bodies_drawn, *marks, *labels]
    box = f"0 0 {width:.0f} {size[1]:.0f}"
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" width="{width:.0f}" role="img">'
    styles = [STYLE, *([_smooth_style()] if any(body.smooth for body in bodies) else [])]
    return "\n".join([head, f"  <!-- {MARK} -->", f"  <title>{escape(name)}</title>", *styles, *content, "</svg>", ""])


def _axes() -> Array:
    """The directions of the page, to the right, upwards and towards the reader, by rows."""
    yaw, pitch = VIEW
    across = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    away = np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    up = np.sin(pitch) * away + np.array([0.0, 0.0, np.cos(pitch)])
    return np.stack([across, up, np.cross(across, up)])


def _shapes(body: DrawnBody, points: Array) -> Iterator[Shape]:
    kind = "flexible" if len(body.phi) else "rigid"
    for face in body.surface.faces:
        corners = points[list(face)]
        path = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y, _ in corners) + "z"
        first, second, third = (corners[i * len(face) // 3] for i in range(3))  # on no line, also of quadratic elements
        normal = np.cross(second - first, third - first) * [1, -1, 1]
        light = abs(float(normal @ LAMP)) / (float(np.linalg.norm(normal)) or 1.0)
        if body.smooth:
            shape = f'  <path class="s{round(light * (LEVELS - 1))}" d="{path}"/>'
            yield float(corners[:, 2].mean()), shape
            continue
        dark = f'<path class="shade" fill-opacity="{0.3 * (1 - light):.2f}" d="{path}"/>'
        yield float(corners[:, 2].mean()), f'  <path class="face {kind}" d="{path}"/>{dark}'
    for i, j in body.surface.edges if not body.surface.faces else ():
        yield float(points[[i, j], 2].mean()), _line("edge", points[i], points[j])
    for i, j in body.links:
        yield float(points[[i, j], 2].mean()), _line("link", points[i], points[j])


def _tie(tie: Tie, points: Array) -> Shape:
    return float(points[:, 2].mean()), _line("spring" if tie.spring else "tie", points[0], points[1])


def _line(kind: str, a: Array, b: Array) -> str:
    return f'  <path class="{kind}" d="M{a[0]:.1f} {a[1]:.1f}L{b[0]:.1f} {b[1]:.1f}"/>'


def _beside_each_other(places: Sequence[Array]) -> list[Array]:
    """Places (3,) of symbols, of which those that would cover another one are moved to the right."""
    result: list[Array] = []
    for place in places:
        moved = place.copy()
        while any(np.hypot(*(moved - other)[:2]) < 2 * SYMBOL for other in result):
            moved[0] += 2.4 * SYMBOL
        result.append(moved)
    return result


def _together(named: Sequence[tuple[str, Array]]) -> list[tuple[str, Array]]:
    """Labels with their places (3,); one that names all markers where several are at one place on the page."""
    gathered: list[tuple[list[str], Array]] = []
    for name, at in named:
        there = next((names for names, place in gathered if np.hypot(*(at - place)[:2]) < SYMBOL / 2), None)
        if there is None:
            gathered.append(([name], at))
        elif name not in there:
            there.append(name)
    return [(", ".join(names), at) for names, at in gathered]


def _stand(at: Array) -> str:
    """A hatched line below a marker of the ground."""
    x, y = at
    hatches = "".join(f"M{x + k:.1f} {y + 8:.1f}l-4 5" for k in (-6, 0, 6, 12))
    return f'  <path class="stand" d="M{x - 10:.1f} {y + 8:.1f}h20{hatches}M{x:.1f} {y:.1f}v8"/>'


def _joint(joint: JointMark, at: Array, axis: Array) -> str:
    """The symbol of a joint; those with an axis have a line along it, as long as it is seen from the reader."""
    (x, y), r = at, SYMBOL
    square = f'<rect class="joint" x="{x - r:.1f}" y="{y - r:.1f}" width="{2 * r:g}" height="{2 * r:g}"/>'
    circle = f'<circle class="joint" cx="{x:.1f}" cy="{y:.1f}" r="{r:g}"/>'
    dx, dy = 2.6 * r * axis[0], -2.6 * r * axis[1]
    line = f'<path class="along" d="M{x - dx:.1f} {y - dy:.1f}L{x + dx:.1f} {y + dy:.1f}"/>'
    match joint.symbol:
        case JointSymbol.WELD:
            drawn = square.replace('"joint"', '"joint weld"')
        case JointSymbol.HINGE:
            drawn = line + circle
        case JointSymbol.UNIVERSAL:
            d = 0.7 * r
            cross = f"M{x - d:.1f} {y - d:.1f}L{x + d:.1f} {y + d:.1f}M{x - d:.1f} {y + d:.1f}L{x + d:.1f} {y - d:.1f}"
            drawn = f'{circle}<path class="joint" d="{cross}"/>'
        case JointSymbol.BALL:
            drawn = f'{circle}<circle class="point" cx="{x:.1f}" cy="{y:.1f}" r="{r / 2:g}"/>'
        case JointSymbol.GUIDE:
            drawn = line + square
        case JointSymbol.GUIDE_THAT_TURNS:
            drawn = f'{line}{square}<circle class="joint" cx="{x:.1f}" cy="{y:.1f}" r="{r / 2:g}"/>'
        case _ as never:
            assert_never(never)
    return f"  <g><title>{escape(joint.label)}</title>{drawn}</g>"


def _label(name: str, at: Array) -> str:
    return f'  <circle class="point" cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="2.5"/>\n{_text(name, at)}'


def _text(name: str, at: Array) -> str:
    return f'  <text x="{at[0] + BESIDE:.1f}" y="{at[1] - BESIDE:.1f}">{escape(name)}</text>'
