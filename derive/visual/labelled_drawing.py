"""A drawing to scale as lines of SVG, whose labels avoid what is drawn and each other."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from html import escape

import numpy as np
from numpy.typing import NDArray

from derive.spec.model.instances import instance_parts

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]

LETTER, LINE = 6.6, 15
"""Width of a letter and height of a line of a label, in pixels."""

MOST_LABELS = 40
"""The most labels that a drawing shows of instances, besides the first and the last of each table."""

EDGE = 12
"""The margin beside everything drawn, in pixels."""


@dataclass
class LabelledDrawing:
    """Lines of SVG in pixels, and the boxes that labels avoid.

    scale: pixels of a metre; low: the point (2,) of the inertial frame, in m, at the pixels left, bottom; width: that
    of the drawing.
    """

    scale: float
    low: Array
    left: float
    bottom: float
    width: int
    lines: list[str] = field(default_factory=list)
    taken: list[Box] = field(default_factory=list)
    labels: list[tuple[float, float, str, str]] = field(default_factory=list)

    def at(self, point: Array) -> tuple[float, float]:
        """A point of the inertial frame in pixels."""
        x, y = (point - self.low) * self.scale
        return round(self.left + float(x), 1), round(self.bottom - float(y), 1)

    def label(self, x: float, y: float, text: str, kind: str) -> None:
        """Add a label next to a point; `place_labels` chooses its position."""
        self.labels.append((x, y, text, kind))

    def path(self, kind: str, points: list[tuple[float, float]], closed: bool = False) -> None:
        """Add a line through points."""
        text = " ".join(f"{x:g},{y:g}" for x, y in points)
        self.lines.append(f'  <{"polygon" if closed else "polyline"} class="{kind}" points="{text}"/>')

    def place_labels(self, height: float) -> None:
        """Draw each label where it covers least: above, below, beside, or further away."""
        for x, y, text, kind in self._readable():
            wide = LETTER * len(text)
            boxes = [
                (x + dx * (wide / 2 + gap) - wide / 2, y + dy * (LINE / 2 + gap) - LINE / 2, wide, float(LINE))
                for gap in (9, 24, 40)
                for dx, dy in ((0, -1), (0, 1), (1, 0), (-1, 0), (1, -1), (-1, -1), (1, 1), (-1, 1))
            ]
            best = min(boxes, key=lambda box: self._cost(box, x, y, height))
            self.taken.append(best)
            middle, base = best[0] + wide / 2, best[1] + LINE - 4
            self.lines.append(
                f'  <text class="{kind}" x="{middle:g}" y="{base:g}" text-anchor="middle">{escape(text)}</text>'
            )

    def _readable(self) -> list[tuple[float, float, str, str]]:
        """All labels or, if there are many, of instances of a table the first and the last."""
        if len(self.labels) <= MOST_LABELS:
            return self.labels
        parts = [instance_parts(label[2]) for label in self.labels]
        indices: dict[str, list[int | None]] = {}
        for part in parts:
            indices.setdefault(part.table, []).append(part.index)
        return [
            label
            for label, part in zip(self.labels, parts, strict=True)
            if part.index is None or part.index in (indices[part.table][0], indices[part.table][-1])
        ]

    def extent(self) -> tuple[int, int]:
        """The left and the right edge of what is drawn, with a margin, so that narrow screens show it large."""
        left = min((box[0] for box in self.taken), default=0.0)
        right = max((box[0] + box[2] for box in self.taken), default=float(self.width))
        return max(0, math.floor(left) - EDGE), min(self.width, math.ceil(right) + EDGE)

    def _cost(self, box: Box, x: float, y: float, height: float) -> float:
        inside = box[0] >= 2 and box[1] >= 2 and box[0] + box[2] <= self.width - 2 and box[1] + box[3] <= height - 2
        covered = sum(_overlap(box, other) for other in self.taken)
        away = math.hypot(box[0] + box[2] / 2 - x, box[1] + box[3] / 2 - y)
        return covered + 0.2 * away + (0 if inside else 1e4)


def _overlap(a: Box, b: Box) -> float:
    across = min(a[0] + a[2], b[0] + b[2]) - max(a[0], b[0])
    along = min(a[1] + a[3], b[1] + b[3]) - max(a[1], b[1])
    return across * along if across > 0 and along > 0 else 0.0
