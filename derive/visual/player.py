"""A page (HTML) that plays a motion: all it shows is in one island of JSON, computed here; it needs no network."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.artifacts import MARK
from derive.rendering import render
from derive.simulation.observables import rods
from derive.simulation.observables.csv_writer import Column
from derive.simulation.observables.observables import Motion, drive_unit, driven, local, number, placed, positions
from derive.spec.model.scene import GROUND, BeamBody, Joint, MarkerRef, RigidBody, Scene

Array = NDArray[np.float64]
Plain = dict[str, Any]

FRAMES, NUMBERS = 600, 40_000
"""The most instants of a page, and the most numbers: with them it has less than 300 kB."""

FINENESS = 2e-6
"""What lengths are rounded to, in sizes of the scene; angles to so many rad."""

SECONDS = 10.0
"""How long a page plays by default, about."""


def page(motion: Motion, curves: Sequence[Column]) -> str:
    """The text of the page; `curves`, one value an instant, are drawn over the time below the scene."""
    data = island(content(motion, curves))
    return render("player/player.html.jinja", {"mark": MARK, "title": escape(motion.scene.name), "motion": data})


def island(data: object) -> str:
    """JSON that can stand within a script element, whatever its texts are."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def content(motion: Motion, curves: Sequence[Column]) -> Plain:
    """All that the page knows, as plain data: lengths in m, angles in rad, times in s."""
    scene = motion.scene
    chosen = _instants(motion, len(curves) + len(scene.drives))
    seen = Motion(scene, motion.native, motion.k, motion.t[chosen], motion.q[chosen], motion.v[chosen])
    places = [MarkerRef(GROUND, p.name) for p in scene.ground]
    places += [MarkerRef(b.name, m.name) for b in scene.bodies for m in _markers(b)]
    at = {place: positions(seen, place) for place in places}
    beams = [b for b in scene.bodies if isinstance(b, BeamBody)]
    low, high = _view([*at.values(), *(c for rod in beams for c in rods.curve(seen, rod))])
    step = _nice(FINENESS * float(max(high - low)))
    duration = float(seen.t[-1] - seen.t[0])
    middle = [i for i, p in enumerate(places) if p.marker == "middle" and p.body in {rod.name for rod in beams}]
    return {
        "name": scene.name,
        "view": [*map(_nice, (*low, *high))],
        "time": _channel(seen.t, 1e-6 * duration or 1.0),
        "rigid": [
            {"name": b.name, "outline": outline(b), "pose": _pose(seen, b.name, step)}
            for b in scene.bodies
            if isinstance(b, RigidBody)
        ],
        "rods": [_rod(seen, rod, step) for rod in beams],
        "places": [_place(scene, place) for place in places],
        "joints": [_joint(seen, joint, places, at) for joint in scene.joints],
        "springs": [[places.index(s.first), places.index(s.second)] for s in scene.springs if s.kind == "linear"],
        "drives": [
            {"name": d.name, "unit": drive_unit(scene, d), "values": _channel(driven(d, seen.t), 1e-4)}
            for d in scene.drives
        ],
        "curves": [
            {"name": c.name, "unit": c.unit, "values": _channel(c.values[chosen], 1e-4 * float(np.abs(c.values).max()))}
            for c in curves
        ],
        "speeds": speeds(duration),
        "trace": (middle or [len(places) - 1])[0],
    }


def speeds(duration: float) -> list[float]:
    """Speeds of playing, in those of real time, from slow to fast; the one in the middle lasts about SECONDS."""
    wanted = math.log10(duration / SECONDS) if duration > 0 else 0.0
    ladder = [float(f"{m}e{e}") for e in range(math.floor(wanted) - 2, math.floor(wanted) + 3) for m in (1, 2, 5)]
    middle = min(range(3, len(ladder) - 3), key=lambda i: abs(math.log10(ladder[i]) - wanted))
    return ladder[middle - 3 : middle + 4]


def _instants(motion: Motion, others: int) -> NDArray[np.intp]:
    """Every instant, or every second, third, ... of them, and the last."""
    channels = 1 + others + 3 * motion.poses.shape[1] + motion.q.shape[1]
    most = max(2, min(FRAMES, NUMBERS // channels))
    stride = max(1, math.ceil((len(motion.t) - 1) / (most - 1)))
    return np.unique(np.append(np.arange(0, len(motion.t), stride), len(motion.t) - 1))


def _channel(values: Array, step: float) -> Plain:
    """Numbers as differences in whole steps; one alone if they do not change."""
    step = _nice(step) or 1.0
    rounded = np.rint(np.asarray(values) / step).astype(np.int64)
    if np.all(rounded == rounded[0]):
        rounded = rounded[:1]
    return {"step": step, "values": np.diff(rounded, prepend=0).tolist()}


def _nice(value: float) -> float:
    return float(f"{value:.5g}")


def _view(paths: Sequence[Array]) -> tuple[Array, Array]:
    """The lower left and the upper right corner of all that moves, with a margin; never much wider than high."""
    low, high = (extreme(np.concatenate(paths), axis=0) for extreme in (np.min, np.max))
    size = float(max(high - low)) or 1.0
    margin = np.maximum(0.09 * size, (np.array([0.25, 0.4]) * size - (high - low)) / 2)
    return low - margin, high + margin


def _pose(motion: Motion, name: str, step: float) -> list[Plain]:
    c1, c2, phi = motion.pose(name).T
    return [_channel(c1, step), _channel(c2, step), _channel(phi, FINENESS)]


def _rod(motion: Motion, rod: BeamBody, step: float) -> Plain:
    return {
        "name": rod.name,
        "half": rods.half_length(rod),
        "shapes": [[_nice(float(c)) for c in shape] for shape in rods.shapes(rod)],
        "pieces": [
            {
                "pose": _pose(motion, name, step),
                "amplitudes": [_channel(a, step) for a in rods.amplitudes(motion, rod, name).T],
            }
            for name in rods.pieces(rod)
        ],
    }


def _markers(body: RigidBody | BeamBody) -> Sequence[Any]:
    return body.markers if isinstance(body, RigidBody) else body.beam.markers


def _place(scene: Scene, place: MarkerRef) -> Plain:
    """Where a place is on its body: x and y, or the piece of a rod and xi there."""
    rod = next((b for b in scene.bodies if b.name == place.body and isinstance(b, BeamBody)), None)
    on = local(scene, place).tolist() if rod is None else _on(rod, place.marker)
    return {"body": place.body, "marker": place.marker, "on": on}


def _on(rod: BeamBody, marker: str) -> list[float]:
    return [*rods.piece(rod, next(m.at for m in rod.beam.markers if m.name == marker))]


def _joint(motion: Motion, joint: Joint, places: list[MarkerRef], at: dict[MarkerRef, Array]) -> Plain:
    """Its places; of a translational one its line, and how far the second place moves on it."""
    found: Plain = {"kind": joint.kind, "first": places.index(joint.first), "second": places.index(joint.second)}
    if joint.kind == "translational":
        axis = np.array([float(a) for a in joint.axis])
        axis /= np.hypot(*axis)
        on_ground = joint.first.body == GROUND
        phi = np.zeros(len(motion.t)) if on_ground else motion.pose(joint.first.body)[:, 2]
        along = placed(np.stack([0 * phi, 0 * phi, phi], axis=1), axis)
        way = np.sum((at[joint.second] - at[joint.first]) * along, axis=1)
        found |= {"axis": axis.tolist(), "way": [_nice(way.min()), _nice(way.max())]}
    return found


def outline(body: RigidBody) -> list[list[float]]:
    """The corners of the least convex polygon around the markers of a body, counter-clockwise; two make a line."""
    found = sorted({(number(m.x), number(m.y)) for m in body.markers})
    if len(found) < 3:
        return [list(p) for p in found]
    corners: list[tuple[float, float]] = []
    for way in (found, found[::-1]):
        chain: list[tuple[float, float]] = []
        for x, y in way:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], (x, y)) <= 0:
                chain.pop()
            chain.append((x, y))
        corners += chain[:-1]
    return [list(p) for p in corners]


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
