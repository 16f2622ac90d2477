"""The modes of a body as small surfaces that move, in one SVG; a printed page shows them at their largest deflection.

Each face is a polygon whose corners go to and fro between two positions, which browsers animate without a program.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from derive.simulation.observables.body_surface import Face
from derive.spec.files.mesh_clusters import at_most
from derive.visual.chart_style import head
from derive.visual.text_metrics import FONT

Array = NDArray[np.float64]

COLUMNS, WIDTH, HEIGHT, CAPTION, EDGE = 3, 232, 150, 20, 8
"""The panels beside each other, their size, the height of the text below each and the margin, in pixels."""

MOST_PANELS, MOST_FACES = 12, 1500
"""The most modes that are shown, and the most faces of all of them together."""

DEFLECTION = 0.16
"""The largest displacement that is shown, relative to the radius of the body."""

VIEW = np.array([0.55, -0.7, 0.46])
"""The direction to the eye, in the axes of the body."""

STILL, MOVED = np.array([221.0, 229.0, 236.0]), np.array([208.0, 112.0, 42.0])
"""The colours (red, green, blue) of faces that do not move, and of those that move most."""

SECONDS = 1.6
"""The time of one vibration in the picture, whatever the frequency."""


def mode_surfaces(x: Array, faces: Sequence[Face], modes: Array, captions: Sequence[str], title: str) -> str:
    """The SVG of the first modes (N, n, 3) of a surface with points x (n, 3), m, with a caption below each."""
    shown = min(len(modes), MOST_PANELS)
    x, faces, modes = _coarse(x, faces, modes[:shown], MOST_FACES // max(shown, 1))
    columns = min(COLUMNS, shown)
    width, height = columns * WIDTH, -(-shown // columns) * (HEIGHT + CAPTION)
    lines = [
        f'<svg role="img" xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" font-family="system-ui, {FONT}, sans-serif" font-size="12">',
        head(title),
    ]
    for number, (mode, caption) in enumerate(zip(modes, captions[:shown], strict=True)):
        left, top = number % columns * WIDTH, number // columns * (HEIGHT + CAPTION)
        lines.append(f'  <g transform="translate({left},{top})" stroke="#5b6670" stroke-width="0.4">')
        lines += _panel(x, faces, mode)
        lines.append(
            f'    <text x="{WIDTH // 2}" y="{HEIGHT + 12}" text-anchor="middle" stroke="none" '
            f'style="fill: #1c2733">{escape(caption, quote=False)}</text>'
        )
        lines.append("  </g>")
    return "\n".join([*lines, "</svg>"]) + "\n"


def _panel(x: Array, faces: Sequence[Face], mode: Array) -> list[str]:
    """The faces of one mode, those behind first."""
    eye = VIEW / np.linalg.norm(VIEW)
    right = np.cross([0.0, 0.0, 1.0], eye)
    right /= np.linalg.norm(right)
    picture = np.array([right, -np.cross(eye, right)])  # across, and down
    radius = float(np.linalg.norm(x, axis=1).max()) or 1.0
    sizes = np.linalg.norm(mode, axis=1)
    step = mode * (DEFLECTION * radius / (float(sizes.max()) or 1.0))
    ends = [(x + sign * step) @ picture.T for sign in (1, -1)]
    low, high = (of([of(end, axis=0) for end in ends], axis=0) for of in (np.min, np.max))
    scale = min((WIDTH - 2 * EDGE) / (high[0] - low[0]), (HEIGHT - 2 * EDGE) / (high[1] - low[1]))
    middle = np.array([WIDTH, HEIGHT]) / 2
    points = [np.round(middle + (end - (low + high) / 2) * scale, 1) for end in ends]
    depth, moved = x @ eye, sizes / (float(sizes.max()) or 1.0)
    order = sorted(faces, key=lambda face: float(depth[list(face)].mean()))
    return [_polygon([_corners(p, face) for p in points], float(moved[list(face)].mean())) for face in order]


def _corners(points: Array, face: Face) -> str:
    return " ".join(f"{x:g},{y:g}" for x, y in points[list(face)])


def _polygon(ends: Sequence[str], moved: float) -> str:
    red, green, blue = (int(c) for c in STILL + moved * (MOVED - STILL))
    first, last = ends
    return (
        f'    <polygon fill="#{red:02x}{green:02x}{blue:02x}" points="{first}"><animate attributeName="points" '
        f'values="{first};{last};{first}" dur="{SECONDS}s" repeatCount="indefinite" calcMode="spline" '
        'keyTimes="0;0.5;1" keySplines="0.37 0 0.63 1;0.37 0 0.63 1"/></polygon>'
    )


def _coarse(x: Array, faces: Sequence[Face], modes: Array, most: int) -> tuple[Array, Sequence[Face], Array]:
    """A surface with about so many faces at most, whose points move as the nearest ones of the surface."""
    if len(faces) <= most:
        return x, faces, modes
    triangles = np.array([(face[0], *pair) for face in faces for pair in pairwise(face[1:])])
    points, corners = at_most(x, triangles, most)
    _, nearest = cKDTree(x).query(points)
    return points, [(int(a), int(b), int(c)) for a, b, c in corners], modes[:, nearest]
