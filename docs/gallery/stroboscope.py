"""A motion in one picture: the bodies of a planar scene at several instants, of which the last is the darkest."""

from __future__ import annotations

from html import escape

import numpy as np

from derive.artifacts import MARK
from derive.simulation.observables.beams import axis_points, piece_names
from derive.simulation.observables.motion import Array, SceneMotion, outline, planar, transformed
from derive.spec.model.planar_bodies import BeamBody

INSTANTS = 12
WIDTH, HEIGHT, MARGIN = 480.0, 300.0, 16.0
"""The largest size of the picture and its margin, in pixels."""
FEW = 100
"""The largest number of beams whose bending is drawn; of more beams the ends."""
STYLE = """\
  <style>
    path { fill: none; stroke-linecap: round; stroke-linejoin: round; }
    .flexible { stroke: #1f7fab; stroke-width: 2.8; } .rigid { stroke: #5c6975; stroke-width: 3.2; }
    @media (prefers-color-scheme: dark) { .flexible { stroke: #58b4dc; } .rigid { stroke: #9ba7b1; } }
  </style>"""


def stroboscope(motion: SceneMotion) -> str:
    """The picture (SVG) of a planar scene in motion, to scale."""
    chosen = np.unique(np.linspace(0, len(motion.t) - 1, INSTANTS).round().astype(int))
    shown = SceneMotion(motion.scene, motion.native, motion.k, motion.t[chosen], motion.q[chosen], motion.v[chosen])
    lines = _lines(shown)
    every = np.concatenate([line.reshape(-1, 2) for _, line in lines])
    low, size = every.min(axis=0), np.ptp(every, axis=0)
    scale = float(min((np.array([WIDTH, HEIGHT]) - 2 * MARGIN) / np.maximum(size, 1e-9 * size.max() + 1e-300)))
    width, height = size * scale + 2 * MARGIN
    content = []
    for k in range(len(chosen)):
        opacity = 0.12 + 0.88 * (k / max(len(chosen) - 1, 1)) ** 2
        for kind in dict.fromkeys(kind for kind, _ in lines):
            paths = [_path((line[k] - low) * scale, height) for other, line in lines if other == kind]
            content.append(f'  <path class="{kind}" opacity="{opacity:.2f}" d="{"".join(paths)}"/>')
    box = f'viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" height="{height:.0f}"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {box} role="img">'
    title = f"<title>{escape(motion.scene.name)} at {len(chosen)} instants</title>"
    return "\n".join([head, f"  <!-- {MARK} -->", f"  {title}", STYLE, *content, "</svg>", ""])


def _lines(motion: SceneMotion) -> list[tuple[str, Array]]:
    """The kinds of the bodies, and the points (instants, points, 2), m, of the line that each is drawn as."""
    scene = planar(motion.scene)
    beams = sum(body.pieces for body in scene.bodies if isinstance(body, BeamBody))
    xi = np.linspace(-1, 1, 9 if beams <= FEW else 2)
    lines: list[tuple[str, Array]] = []
    for body in scene.bodies:
        if isinstance(body, BeamBody):
            pieces = [axis_points(motion, body, piece, xi) for piece in piece_names(body)]
            lines.append(("flexible", np.concatenate(pieces, axis=1)))
        else:
            corners = outline(body)
            pose = motion.pose(body.name)
            closed = [*corners, corners[0]] if len(corners) > 1 else [[0.0, 0.0], *corners]
            lines.append(("rigid", np.stack([transformed(pose, np.array(corner)) for corner in closed], axis=1)))
    return lines


def _path(points: Array, height: float) -> str:
    """A line through points (n, 2) in pixels from the lower left corner inside the margin."""
    texts = (f"{x + MARGIN:.1f} {height - MARGIN - y:.1f}" for x, y in points)
    return "M" + "L".join(texts)
