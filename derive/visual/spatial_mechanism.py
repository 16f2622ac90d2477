"""The drawing of a scene in space in one configuration (SVG): its bodies with their surfaces and markers, to scale."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape

import numpy as np

from derive.artifacts import MARK
from derive.simulation.observables.motion import Array
from derive.simulation.observables.spatial_player_data import BodyPath, DrawnBody, Tie, placed
from derive.visual.mode_pages import VIEW

WIDTH, MOST, EDGE = 640.0, 420.0, 46.0
"""The largest width and height of the drawing and the width of its margin, in pixels."""
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
    @media (prefers-color-scheme: dark) {
      text { fill: #e6edf3; stroke: #0d1117; } .face { stroke: #0d1117; } .rigid { fill: #8d9aa6; }
      .flexible { fill: #58b4dc; } .link { stroke: #8d9aa6; } .edge { stroke: #58b4dc; }
      .tie, .spring { stroke: #8d9aa6; } .point { fill: #e6edf3; }
    }
  </style>"""

Shape = tuple[float, str]
"""A depth and the element of SVG that is drawn there."""


def spatial_picture(
    name: str,
    bodies: list[DrawnBody],
    paths: list[BodyPath],
    ground: list[tuple[str, Array]],
    ties: Sequence[Tie] = (),
) -> str:
    """The picture of bodies at the first instant of their paths.

    ground: names and places (3,), m, of the markers of the ground. ties: the lines between markers.
    """
    shown = [placed(body, path)[0] @ _axes().T for body, path in zip(bodies, paths, strict=True)]
    fixed = [(label, _axes() @ at) for label, at in ground]
    every = np.concatenate([*shown, *(at[None] for _, at in fixed), np.zeros((1, 3))])
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
    tips = pixels(np.vstack([np.zeros(3), 0.35 * float(np.ptp(every, axis=0).max()) * _axes().T]))
    axes = [_line("axis", tips[0], tip) for tip in tips[1:]]
    labels = [
        _label(marker, pixels(points[number][None])[0])
        for body, points in zip(bodies, shown, strict=True)
        for marker, number in body.markers
    ]
    labels += [_label(label, pixels(at[None])[0]) for label, at in fixed]
    labels += [_text(f"e{k}", tip) for k, tip in enumerate(tips[1:], 1)]
    content = [*axes, *(text for _, text in sorted(shapes, key=lambda shape: shape[0])), *labels]
    box = f"0 0 {size[0]:.0f} {size[1]:.0f}"
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" width="{size[0]:.0f}" role="img">'
    return "\n".join([head, f"  <!-- {MARK} -->", f"  <title>{escape(name)}</title>", STYLE, *content, "</svg>", ""])


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
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0]) * [1, -1, 1]
        light = abs(float(normal @ LAMP)) / (float(np.linalg.norm(normal)) or 1.0)
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


def _label(name: str, at: Array) -> str:
    return f'  <circle class="point" cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="2.5"/>\n{_text(name, at)}'


def _text(name: str, at: Array) -> str:
    return f'  <text x="{at[0] + 6:.1f}" y="{at[1] - 6:.1f}">{escape(name)}</text>'
