"""A drawing of a mechanism at t = 0: bodies, joints, drives, forces and springs with their names, as SVG."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from html import escape

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from derive.artifacts import MARK
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.point_motion import PointMotion, RelativeMotion, fixed_point
from derive.simulation.observables.motion import (
    body_coordinates,
    drive_values,
    function_values,
    outline,
    si_value,
    transformed,
)
from derive.spec.model.body import Parameter
from derive.spec.model.scene import (
    GROUND,
    BeamBody,
    CustomBody,
    CustomJoint,
    Force,
    Joint,
    MarkerRef,
    RigidBody,
    Scene,
    Spring,
)

Array = NDArray[np.float64]
Poses = Mapping[str, Array]

WIDTH, LEAST, MOST, MARGIN = 760, 170, 460, 78
"""Width of the drawing, its least and greatest height, and the margin for labels, in pixels."""

STEPS, CLOSED, DIFFERENCE = 80, 1e-10, 1e-7
"""Newton steps, the residual at which the loops are closed, and the step of differences (m, rad)."""

LETTER, LINE = 6.6, 15
"""Width of a letter and height of a line of a label, in pixels."""

EDGE = 12
"""The margin beside everything drawn, in pixels."""

SYMBOL = 5
"""The unit of the symbols of joints, in pixels."""

INSTANTS = 101
"""Instants at which the direction of a force is looked for."""

STYLE = """\
  <style>
    text { font: 12px system-ui, sans-serif; fill: #1c2733; }
    .ground { fill: #ffffff; } .body { fill: #cfe3ec; stroke: #1f6f8b; stroke-width: 2; stroke-linejoin: round; }
    .rod { fill: none; stroke: #1f6f8b; stroke-width: 8; } .core { fill: none; stroke: #cfe3ec; stroke-width: 4; }
    .joint { fill: #ffffff; stroke: #1c2733; stroke-width: 1.6; } .weld { fill: #1c2733; }
    .fixed { fill: none; stroke: #5a6670; stroke-width: 1.4; } .drive { fill: none; stroke: #a8560f; stroke-width: 2; }
    .tip { fill: #a8560f; } .drives { fill: #a8560f; } .bodies { fill: #175d74; font-weight: 600; }
    .spring { fill: none; stroke: #3d7a3d; stroke-width: 1.6; } .springs { fill: #2d6a2d; }
    @media (prefers-color-scheme: dark) {
      text { fill: #e6edf3; } .ground { fill: #13171b; } .body { fill: #1c3644; stroke: #5fb6d4; }
      .rod { stroke: #5fb6d4; } .core { stroke: #1c3644; } .joint { fill: #13171b; stroke: #e6edf3; }
      .weld { fill: #e6edf3; } .fixed { stroke: #9ba7b1; } .drive { stroke: #e0a564; }
      .tip, .drives { fill: #e0a564; } .bodies { fill: #7fc7de; } .spring { stroke: #84cf98; }
      .springs { fill: #84cf98; }
    }
  </style>"""


def initial_poses(scene: Scene) -> dict[str, Array]:
    """(x, y, angle) of each undeformed body at t = 0, in m and rad.

    Newton's method starts from the initial guesses of the specification and closes the joints and drives. Where it
    finds no closed configuration, the poses are those of the guesses.
    """
    names = [body.name for body in scene.bodies]
    guess = np.array([[*body.start.position, body.start.angle] for body in scene.bodies], dtype=float).reshape(-1)

    def residual(values: Array) -> Array:
        poses = _by_name(names, values)
        return np.array([r for joint in scene.joints for r in _residuals(scene, joint, poses)])

    values = guess.copy()
    for _ in range(STEPS):
        error = residual(values)
        if not error.size or np.abs(error).max() < CLOSED:
            return _by_name(names, values)
        columns = [(residual(values + unit) - error) / DIFFERENCE for unit in DIFFERENCE * np.eye(len(values))]
        values = values - np.linalg.lstsq(np.array(columns).T, error, rcond=1e-6)[0]
    return _by_name(names, values if np.abs(residual(values)).max() < 1e3 * CLOSED else guess)


def _by_name(names: list[str], values: Array) -> dict[str, Array]:
    poses = {name: values[3 * k : 3 * k + 3] for k, name in enumerate(names)}
    return {GROUND: np.zeros(3), **poses}


def position(scene: Scene, place: MarkerRef, poses: Poses) -> Array:
    """(2,): a marker in the inertial frame, with rods undeformed, in m."""
    body = next((b for b in scene.bodies if b.name == place.body), None)
    if isinstance(body, BeamBody):
        at = next(m.at for m in body.beam.markers if m.name == place.marker)
        point = np.array([float(at) * si_value(body.beam.length) / 2, 0.0])
    else:
        point = body_coordinates(scene, place)
    return _placed(poses[place.body], point)


def _placed(pose: Array, point: Array) -> Array:
    moved: Array = transformed(pose[None, :], point)[0]
    return moved


def _residuals(scene: Scene, joint: Joint, poses: Poses) -> Iterator[float]:
    """The constraints of a joint and its drive at t = 0, from the equations of its type."""
    joint_type = JOINTS[joint.kind]
    relative = RelativeMotion(
        *(_still(position(scene, end, poses), poses[end.body][2]) for end in (joint.first, joint.second))
    )
    if isinstance(joint, CustomJoint):
        joint = replace(
            joint, values={k: si_value(v) if isinstance(v, Parameter) else v for k, v in joint.values.items()}
        )
    equations = joint_type.equations(joint, relative)
    known = {definition.symbol: definition.expr for definition in equations.definitions}
    for multiplier, (residual, _, _) in zip(joint_type.multipliers, equations.residuals, strict=True):
        value = float(sp.sympify(residual).xreplace(known))
        yield _angle(value) if multiplier.unit == "rad" else value
    drive = next((d for d in scene.drives if d.joint == joint.name), None)
    if drive and joint_type.driven and equations.driven:
        value = float(sp.sympify(equations.driven[0]).xreplace(known)) - float(drive_values(drive, np.zeros(1))[0])
        yield _angle(value) if joint_type.driven.unit == "rad" else value


def _still(at: Array, rotation: float) -> PointMotion:
    """A marker at rest."""
    return replace(fixed_point(sp.Matrix(at)), rotation=sp.Float(rotation))


def _axis(joint: Joint, pose: Array) -> Array:
    axis = np.array([float(a) for a in joint.axis])
    rotated = _placed(np.array([0.0, 0.0, pose[2]]), axis / np.hypot(*axis))
    return rotated


def _angle(value: float) -> float:
    """An angle between -pi and pi."""
    return math.remainder(float(value), 2 * math.pi)


Box = tuple[float, float, float, float]


@dataclass
class _Drawing:
    """Lines of SVG in pixels, and the boxes that labels stay out of."""

    scale: float
    low: Array
    left: float
    bottom: float
    lines: list[str] = field(default_factory=list)
    taken: list[Box] = field(default_factory=list)
    labels: list[tuple[float, float, str, str]] = field(default_factory=list)

    def at(self, point: Array) -> tuple[float, float]:
        """A point of the inertial frame in pixels."""
        x, y = (point - self.low) * self.scale
        return round(self.left + float(x), 1), round(self.bottom - float(y), 1)

    def label(self, x: float, y: float, text: str, kind: str) -> None:
        """A label next to a point; its position is chosen when all labels are known."""
        self.labels.append((x, y, text, kind))

    def path(self, kind: str, points: list[tuple[float, float]], closed: bool = False) -> None:
        """A line through points."""
        text = " ".join(f"{x:g},{y:g}" for x, y in points)
        self.lines.append(f'  <{"polygon" if closed else "polyline"} class="{kind}" points="{text}"/>')

    def place_labels(self, width: float, height: float) -> None:
        """Each label where it covers least: above, below, beside, or further away."""
        for x, y, text, kind in self.labels:
            wide = LETTER * len(text)
            boxes = [
                (x + dx * (wide / 2 + gap) - wide / 2, y + dy * (LINE / 2 + gap) - LINE / 2, wide, float(LINE))
                for gap in (9, 24, 40)
                for dx, dy in ((0, -1), (0, 1), (1, 0), (-1, 0), (1, -1), (-1, -1), (1, 1), (-1, 1))
            ]
            best = min(boxes, key=lambda box: self._cost(box, x, y, width, height))
            self.taken.append(best)
            middle, base = best[0] + wide / 2, best[1] + LINE - 4
            self.lines.append(
                f'  <text class="{kind}" x="{middle:g}" y="{base:g}" text-anchor="middle">{escape(text)}</text>'
            )

    def extent(self) -> tuple[int, int]:
        """The left and the right edge of what is drawn, with a margin, so that narrow screens show it large."""
        left = min((box[0] for box in self.taken), default=0.0)
        right = max((box[0] + box[2] for box in self.taken), default=float(WIDTH))
        return max(0, math.floor(left) - EDGE), min(WIDTH, math.ceil(right) + EDGE)

    def _cost(self, box: Box, x: float, y: float, width: float, height: float) -> float:
        inside = box[0] >= 2 and box[1] >= 2 and box[0] + box[2] <= width - 2 and box[1] + box[3] <= height - 2
        covered = sum(_overlap(box, other) for other in self.taken)
        away = math.hypot(box[0] + box[2] / 2 - x, box[1] + box[3] / 2 - y)
        return covered + 0.2 * away + (0 if inside else 1e4)


def _overlap(a: Box, b: Box) -> float:
    across = min(a[0] + a[2], b[0] + b[2]) - max(a[0], b[0])
    along = min(a[1] + a[3], b[1] + b[3]) - max(a[1], b[1])
    return across * along if across > 0 and along > 0 else 0.0


def mechanism_picture(scene: Scene) -> str:
    """The mechanism as SVG, to scale, in its initial configuration with rods undeformed."""
    poses = initial_poses(scene)
    places = [MarkerRef(GROUND, p.name) for p in scene.ground]
    places += [MarkerRef(b.name, m.name) for b in scene.bodies for m in b.markers]
    points = np.array([position(scene, place, poses) for place in places] or [np.zeros(2)])
    low, high = points.min(axis=0), points.max(axis=0)
    span = np.maximum(high - low, 1e-12)
    scale = float(min((WIDTH - 2 * MARGIN) / span[0], (MOST - 2 * MARGIN) / span[1]))
    height = round(max(LEAST, float(span[1]) * scale + 2 * MARGIN))
    left = (WIDTH - float(high[0] - low[0]) * scale) / 2
    bottom = (height + float(high[1] - low[1]) * scale) / 2
    drawing = _Drawing(scale, low, left, bottom)
    for place in places:
        x, y = drawing.at(position(scene, place, poses))
        drawing.taken.append((x - 9, y - 9, 18, 18))
    for body in scene.bodies:
        if isinstance(body, BeamBody):
            _rod(drawing, body, poses)
        else:
            _rigid(drawing, body, poses)
    _supports(drawing, scene)
    for joint in scene.joints:
        _joint(drawing, scene, joint, poses)
    _loads(drawing, scene, poses)
    drawing.place_labels(WIDTH, height)
    start, stop = drawing.extent()
    view = f'viewBox="{start} 0 {stop - start} {height}" width="{stop - start}"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {view} role="img">'
    ground = f'  <rect class="ground" x="{start}" width="{stop - start}" height="{height}"/>'
    title = f"  <title>{escape(scene.name)} at t = 0</title>"
    return "\n".join([head, f"  <!-- {MARK} -->", title, STYLE, ground, *drawing.lines, "</svg>\n"])


def _rod(drawing: _Drawing, body: BeamBody, poses: Poses) -> None:
    """A band along the axis, cut where the rod is cut into beams."""
    half = si_value(body.beam.length) / 2
    pose = poses[body.name]
    start, end = (drawing.at(_placed(pose, np.array([x, 0.0]))) for x in (-half, half))
    drawing.path("rod", [start, end])
    for k in range(body.pieces):
        ends = [start[i] + (end[i] - start[i]) * (k + side) / body.pieces for side in (0, 1) for i in (0, 1)]
        along = np.array([ends[2] - ends[0], ends[3] - ends[1]])
        inset = 2 * along / max(float(np.hypot(*along)), 1e-9)
        drawing.path("core", [(ends[0] + inset[0], ends[1] + inset[1]), (ends[2] - inset[0], ends[3] - inset[1])])
    _along(drawing, start, end)
    drawing.label((start[0] + end[0]) / 2, (start[1] + end[1]) / 2, body.name, "bodies")


def _rigid(drawing: _Drawing, body: RigidBody | CustomBody, poses: Poses) -> None:
    """The hull of the markers; a bar where there are two, a block where there is one."""
    pose = poses[body.name]
    corners = [drawing.at(_placed(pose, np.array(point))) for point in outline(body)]
    if len(corners) == 1:
        ((x, y),) = corners
        drawing.lines.append(f'  <rect class="body" x="{x - 16:g}" y="{y - 10:g}" width="32" height="20" rx="3"/>')
        drawing.taken.append((x - 18, y - 12, 36, 24))
    elif len(corners) == 2:
        start, end = np.array(corners[0]), np.array(corners[1])
        across = np.array([start[1] - end[1], end[0] - start[0]])
        across = 6 * across / max(float(np.hypot(*across)), 1e-9)
        drawing.path("body", [tuple(p) for p in (start + across, end + across, end - across, start - across)], True)
        _along(drawing, corners[0], corners[1])
    elif corners:
        drawing.path("body", corners, True)
        for first, second in zip(corners, (*corners[1:], corners[0]), strict=True):
            _along(drawing, first, second)
    if corners:
        x, y = (sum(c[i] for c in corners) / len(corners) for i in (0, 1))
        drawing.label(x, y, body.name, "bodies")


def _along(drawing: _Drawing, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Labels keep off the line from start to end."""
    for k in range(13):
        x, y = (start[i] + (end[i] - start[i]) * k / 12 for i in (0, 1))
        drawing.taken.append((x - 6, y - 6, 12, 12))


def _supports(drawing: _Drawing, scene: Scene) -> None:
    """A hatched triangle at each point of the ground that carries a joint or a spring."""
    connections: tuple[Joint | Spring, ...] = (*scene.joints, *scene.springs)
    ends = [end for item in connections for end in (item.first, item.second)]
    for marker in sorted({end.marker for end in ends if end.body == GROUND}):
        x, y = drawing.at(body_coordinates(scene, MarkerRef(GROUND, marker)))
        drawing.path("fixed", [(x, y), (x - 9, y + 15), (x + 9, y + 15)], True)
        for k in range(-10, 11, 5):
            drawing.path("fixed", [(x + k, y + 15), (x + k - 4, y + 20)])
        drawing.taken.append((x - 14, y, 28, 20))


def _joint(drawing: _Drawing, scene: Scene, joint: Joint, poses: Poses) -> None:
    x, y = drawing.at(position(scene, joint.second, poses))
    symbol = JOINTS[joint.kind].drawing
    if symbol.guide:
        along = _axis(joint, poses[joint.first.body]) * (1, -1)
        across = np.array([-along[1], along[0]])
        for side in (14, -14):
            ends = [np.array([x, y]) + side * across + way * along for way in (-38, 38)]
            drawing.path("fixed", [tuple(np.round(p, 1)) for p in ends])
            _along(drawing, (float(ends[0][0]), float(ends[0][1])), (float(ends[1][0]), float(ends[1][1])))
    for (cx, cy), radius in symbol.circles:
        centre = f'cx="{x + SYMBOL * cx:g}" cy="{y - SYMBOL * cy:g}"'
        drawing.lines.append(f'  <circle class="joint" {centre} r="{SYMBOL * radius:g}"/>')
    for points in symbol.lines:
        kind = "weld" if points[0] == points[-1] else "fixed"
        drawing.path(kind, [(x + SYMBOL * px, y - SYMBOL * py) for px, py in points])
    drawing.label(x, y, joint.name, "joints")
    for drive in scene.drives:
        if drive.joint == joint.name:
            _arrow(drawing, x, y, _axis(joint, poses[joint.first.body]) if symbol.guide else None)
            drawing.label(x, y, drive.name, "drives")


def _arrow(drawing: _Drawing, x: float, y: float, along: Array | None) -> None:
    """An arc around a driven rotation, or a straight arrow along a driven displacement."""
    if along is not None:
        _force(drawing, x, y, along)
        return
    drawing.lines.append(f'  <path class="drive" d="M{x + 17:g} {y + 3:g} A17 17 0 1 0 {x - 5:g} {y + 16:g}"/>')
    drawing.path("tip", [(x + 3, y + 17), (x - 6, y + 11), (x - 7, y + 21)], True)
    drawing.taken.append((x - 20, y - 20, 40, 40))


def _force(drawing: _Drawing, x: float, y: float, along: Array) -> None:
    """An arrow that ends 40 pixels from its point."""
    way = along * (1, -1) / max(float(np.hypot(*along)), 1e-12)
    across = np.array([-way[1], way[0]])
    start, tip = np.array([x, y]), np.array([x, y]) + 42 * way
    drawing.path("drive", [tuple(np.round(p, 1)) for p in (start, tip)])
    drawing.path("tip", [tuple(np.round(p, 1)) for p in (tip + 8 * way, tip + 4 * across, tip - 4 * across)], True)
    _along(drawing, tuple(start), tuple(tip))


def _loads(drawing: _Drawing, scene: Scene, poses: Poses) -> None:
    """Forces and torques at their points, springs between theirs."""
    for force in scene.forces:
        x, y = drawing.at(position(scene, force.at, poses))
        way = _greatest(scene, force)
        _force(drawing, x, y, way)
        drawing.label(x + 42 * float(way[0]), y - 42 * float(way[1]), force.name, "drives")
    for torque in scene.torques:
        x, y = drawing.at(position(scene, torque.at, poses))
        _arrow(drawing, x, y, None)
        drawing.label(x, y, torque.name, "drives")
    for spring in scene.springs:
        ends = [drawing.at(position(scene, end, poses)) for end in (spring.first, spring.second)]
        drawing.path("spring", _zigzag(*(np.array(end) for end in ends)))
        _along(drawing, ends[0], ends[1])
        drawing.label((ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2, spring.name, "springs")


def _greatest(scene: Scene, force: Force) -> Array:
    """The direction of a force at the instant at which it is greatest; along e1 if it is always zero."""
    t = np.linspace(0.0, scene.simulation.duration if scene.simulation else 1.0, INSTANTS)
    values = np.array([np.broadcast_to(function_values(component, t), t.shape) for component in force.components])
    sizes = np.hypot(*values)
    k = int(sizes.argmax())
    direction: Array = values[:, k] / sizes[k] if sizes[k] else np.array([1.0, 0.0])
    return direction


def _zigzag(start: Array, end: Array) -> list[tuple[float, float]]:
    way = end - start
    across = np.array([-way[1], way[0]]) / max(float(np.hypot(*way)), 1e-9)
    inner = [start + way * (0.2 + 0.6 * k / 10) + across * (0 if k in (0, 10) else 6 * (-1) ** k) for k in range(11)]
    return [(round(float(p[0]), 1), round(float(p[1]), 1)) for p in (start, *inner, end)]
