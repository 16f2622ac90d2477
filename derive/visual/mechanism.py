"""A drawing of a mechanism at t = 0: bodies, joints, drives, forces and springs with their names, as SVG."""

from __future__ import annotations

from html import escape

import numpy as np

from derive.artifacts import MARK
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.simulation.observables.motion import body_coordinates, function_values, outline, si_value
from derive.spec.model.forces import CustomForce, Force
from derive.spec.model.joints import Joint
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.planar_bodies import BeamBody, CustomBody, RigidBody
from derive.spec.model.scene import Scene
from derive.spec.model.time_function import TimeFunction
from derive.visual.labelled_drawing import LabelledDrawing
from derive.visual.undeformed_poses import Array, Poses, initial_poses, position, transformed_point

WIDTH, LEAST, MOST, MARGIN = 760, 170, 460, 78
"""Width of the drawing, its least and greatest height, and the margin for labels, in pixels."""

SYMBOL = 5
"""The unit of the symbols of joints, in pixels."""

MASS = 9
"""The radius of a mass that is attached to a rod, in pixels."""

INSTANTS = 101
"""The number of instants at which the magnitude of a force is sampled to find its direction."""


STYLE = """\
  <style>
    text { font: 12px system-ui, 'DejaVu Sans', sans-serif; fill: #1c2733; }
    .ground { fill: #ffffff; } .body { fill: #cfe3ec; stroke: #1f6f8b; stroke-width: 2; stroke-linejoin: round; }
    .rod { fill: none; stroke: #1f6f8b; stroke-width: 8; } .core { fill: none; stroke: #cfe3ec; stroke-width: 4; }
    .mass { fill: #1f6f8b; }
    .joint { fill: #ffffff; stroke: #1c2733; stroke-width: 1.6; } .weld { fill: #1c2733; }
    .fixed { fill: none; stroke: #5a6670; stroke-width: 1.4; } .drive { fill: none; stroke: #a8560f; stroke-width: 2; }
    .tip { fill: #a8560f; } .drives { fill: #a8560f; } .bodies { fill: #175d74; font-weight: 600; }
    .spring { fill: none; stroke: #3d7a3d; stroke-width: 1.6; } .springs { fill: #2d6a2d; }
    @media (prefers-color-scheme: dark) {
      text { fill: #e6edf3; } .ground { fill: #13171b; } .body { fill: #1c3644; stroke: #5fb6d4; }
      .rod { stroke: #5fb6d4; } .core { stroke: #1c3644; } .mass { fill: #5fb6d4; }
      .joint { fill: #13171b; stroke: #e6edf3; }
      .weld { fill: #e6edf3; } .fixed { stroke: #9ba7b1; } .drive { stroke: #e0a564; }
      .tip, .drives { fill: #e0a564; } .bodies { fill: #7fc7de; } .spring { stroke: #84cf98; }
      .springs { fill: #84cf98; }
    }
  </style>"""


def mechanism_picture(scene: Scene) -> str:
    """The mechanism as SVG, to scale, in its initial configuration with rods undeformed."""
    poses = initial_poses(scene)
    markers = [MarkerRef(GROUND, p.name) for p in scene.ground]
    markers += [MarkerRef(b.name, m.name) for b in scene.bodies for m in b.markers]
    points = np.array([position(scene, marker, poses) for marker in markers] or [np.zeros(2)])
    low, high = points.min(axis=0), points.max(axis=0)
    span = np.maximum(high - low, 1e-12)
    scale = float(min((WIDTH - 2 * MARGIN) / span[0], (MOST - 2 * MARGIN) / span[1]))
    height = round(max(LEAST, float(span[1]) * scale + 2 * MARGIN))
    left = (WIDTH - float(high[0] - low[0]) * scale) / 2
    bottom = (height + float(high[1] - low[1]) * scale) / 2
    drawing = LabelledDrawing(scale, low, left, bottom, WIDTH)
    for marker in markers:
        x, y = drawing.at(position(scene, marker, poses))
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
    drawing.place_labels(height)
    start, stop = drawing.extent()
    view = f'viewBox="{start} 0 {stop - start} {height}" width="{stop - start}"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {view} role="img">'
    ground = f'  <rect class="ground" x="{start}" width="{stop - start}" height="{height}"/>'
    title = f"  <title>{escape(scene.name)} at t = 0</title>"
    return "\n".join([head, f"  <!-- {MARK} -->", title, STYLE, ground, *drawing.lines, "</svg>\n"])


def _rod(drawing: LabelledDrawing, body: BeamBody, poses: Poses) -> None:
    """Draw a rod as a band along its axis, divided where the rod is divided into beams, and its attached masses."""
    half = si_value(body.beam.length) / 2
    pose = poses[body.name]
    start, end = (drawing.at(transformed_point(pose, np.array([x, 0.0]))) for x in (-half, half))
    drawing.path("rod", [start, end])
    for k in range(body.pieces):
        ends = [start[i] + (end[i] - start[i]) * (k + side) / body.pieces for side in (0, 1) for i in (0, 1)]
        along = np.array([ends[2] - ends[0], ends[3] - ends[1]])
        inset = 2 * along / max(float(np.hypot(*along)), 1e-9)
        drawing.path("core", [(ends[0] + inset[0], ends[1] + inset[1]), (ends[2] - inset[0], ends[3] - inset[1])])
    _along(drawing, start, end)
    drawing.label((start[0] + end[0]) / 2, (start[1] + end[1]) / 2, body.name, "bodies")
    for mass in body.beam.masses:
        x, y = drawing.at(transformed_point(pose, np.array([float(mass.at) * half, 0.0])))
        drawing.lines.append(f'  <circle class="mass" cx="{x:g}" cy="{y:g}" r="{MASS}"/>')
        drawing.taken.append((x - MASS, y - MASS, 2 * MASS, 2 * MASS))
        drawing.label(x, y, mass.name, "bodies")


def _rigid(drawing: LabelledDrawing, body: RigidBody | CustomBody, poses: Poses) -> None:
    """Draw the hull of the markers of a rigid body; a bar if it has two, a block if it has one."""
    pose = poses[body.name]
    corners = [drawing.at(transformed_point(pose, np.array(point))) for point in outline(body)]
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


def _along(drawing: LabelledDrawing, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Make labels avoid the line from start to end."""
    for k in range(13):
        x, y = (start[i] + (end[i] - start[i]) * k / 12 for i in (0, 1))
        drawing.taken.append((x - 6, y - 6, 12, 12))


def _supports(drawing: LabelledDrawing, scene: Scene) -> None:
    """Draw a hatched triangle at each point of the ground that carries a joint or a spring."""
    ends = [end for joint in scene.joints for end in (joint.first, joint.second)]
    ends += [end for spring in scene.springs for end in spring.markers]
    for marker in sorted({end.marker for end in ends if end.body == GROUND}):
        x, y = drawing.at(body_coordinates(scene, MarkerRef(GROUND, marker)))
        drawing.path("fixed", [(x, y), (x - 9, y + 15), (x + 9, y + 15)], True)
        for k in range(-10, 11, 5):
            drawing.path("fixed", [(x + k, y + 15), (x + k - 4, y + 20)])
        drawing.taken.append((x - 14, y, 28, 20))


def _joint(drawing: LabelledDrawing, scene: Scene, joint: Joint, poses: Poses) -> None:
    x, y = drawing.at(position(scene, joint.second, poses))
    symbol = JOINTS[joint.kind].drawing
    if symbol.guide:
        along = _axis(joint, poses[joint.first.body]) * (1, -1)
        across = np.array([-along[1], along[0]])
        for side in (14, -14):
            ends = [np.array([x, y]) + side * across + distance * along for distance in (-38, 38)]
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


def _axis(joint: Joint, pose: Array) -> Array:
    """The unit vector (2,) along a guide, in the inertial frame."""
    axis = np.array([float(a) for a in joint.axis])
    rotated = transformed_point(np.array([0.0, 0.0, pose[2]]), axis / np.hypot(*axis))
    return rotated


def _arrow(drawing: LabelledDrawing, x: float, y: float, along: Array | None) -> None:
    """Draw an arc around a driven rotation, or a straight arrow along a driven displacement."""
    if along is not None:
        _force(drawing, x, y, along)
        return
    drawing.lines.append(f'  <path class="drive" d="M{x + 17:g} {y + 3:g} A17 17 0 1 0 {x - 5:g} {y + 16:g}"/>')
    drawing.path("tip", [(x + 3, y + 17), (x - 6, y + 11), (x - 7, y + 21)], True)
    drawing.taken.append((x - 20, y - 20, 40, 40))


def _force(drawing: LabelledDrawing, x: float, y: float, along: Array) -> None:
    """Draw the arrow of a force, which ends 40 pixels from its point."""
    direction = along * (1, -1) / max(float(np.hypot(*along)), 1e-12)
    across = np.array([-direction[1], direction[0]])
    start, tip = np.array([x, y]), np.array([x, y]) + 42 * direction
    drawing.path("drive", [tuple(np.round(p, 1)) for p in (start, tip)])
    drawing.path(
        "tip", [tuple(np.round(p, 1)) for p in (tip + 8 * direction, tip + 4 * across, tip - 4 * across)], True
    )
    _along(drawing, tuple(start), tuple(tip))


def _loads(drawing: LabelledDrawing, scene: Scene, poses: Poses) -> None:
    """Draw forces and torques at their points, and springs between their ends."""
    for force in scene.forces:
        x, y = drawing.at(position(scene, force.markers[0], poses))
        if isinstance(force, CustomForce):  # its direction follows from the motion
            drawing.lines.append(f'  <circle class="drive" cx="{x:g}" cy="{y:g}" r="12"/>')
            drawing.label(x, y, force.name, "drives")
            continue
        direction = _greatest(scene, force)
        if force.frame == "body":
            direction = transformed_point(poses[force.at.body] * (0, 0, 1), direction)
        _force(drawing, x, y, direction)
        drawing.label(x + 42 * float(direction[0]), y - 42 * float(direction[1]), force.name, "drives")
    for torque in scene.torques:
        x, y = drawing.at(position(scene, torque.markers[0], poses))
        _arrow(drawing, x, y, None)
        drawing.label(x, y, torque.name, "drives")
    for spring in scene.springs:
        ends = [drawing.at(position(scene, end, poses)) for end in spring.markers]
        drawing.path("spring", _zigzag(*(np.array(end) for end in ends)))
        _along(drawing, ends[0], ends[1])
        drawing.label((ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2, spring.name, "springs")


def _greatest(scene: Scene, force: Force) -> Array:
    """The direction of a force at the instant at which it is greatest; along e1 if it is always zero."""
    t = np.linspace(0.0, scene.simulation.duration if scene.simulation else 1.0, INSTANTS)
    values = np.array([_values(component, t) for component in force.components])
    sizes = np.hypot(*values)
    k = int(sizes.argmax())
    direction: Array = values[:, k] / sizes[k] if sizes[k] else np.array([1.0, 0.0])
    return direction


def _values(component: TimeFunction, t: Array) -> Array:
    """A component at the times t; 1, if it is a run-time input."""
    return np.ones_like(t) if component.kind == "input" else function_values(component, t)


def _zigzag(start: Array, end: Array) -> list[tuple[float, float]]:
    direction = end - start
    across = np.array([-direction[1], direction[0]]) / max(float(np.hypot(*direction)), 1e-9)
    inner = [
        start + direction * (0.2 + 0.6 * k / 10) + across * (0 if k in (0, 10) else 6 * (-1) ** k) for k in range(11)
    ]
    return [(round(float(p[0]), 1), round(float(p[1]), 1)) for p in (start, *inner, end)]
