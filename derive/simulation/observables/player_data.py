"""The data of the player of a motion: everything that its page shows, as plain data in whole steps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.mechanics.bodies.beam_functions import BeamFunction
from derive.mechanics.multibody.forces.registry import FORCES
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.simulation.observables.axis_ticks import plain_numbers, ticks
from derive.simulation.observables.beams import (
    beam_bodies,
    beam_points,
    field_amplitudes,
    fields_of,
    half_length,
    piece_at,
    piece_names,
    shape_functions,
    shortening_functions,
)
from derive.simulation.observables.csv_writer import Column
from derive.simulation.observables.marker_positions import marker_positions
from derive.simulation.observables.motion import (
    Array,
    SceneMotion,
    body_coordinates,
    drive_unit,
    outline,
    planar,
    simulated_drive,
    transformed,
)
from derive.spec.model.joints import Joint
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene

Plain = dict[str, Any]

MAX_FRAMES, MAX_NUMBERS = 600, 40_000
"""The largest numbers of instants and of values of a page, which then has less than 300 kB."""

RESOLUTION = 2e-6
"""The step to which lengths are rounded, in sizes of the scene; angles in rad."""

POINT = 1e-12
"""m: markers that are never farther from each other than this are one point, which does not show where bodies are."""

TIME_TICKS, CURVE_TICKS = (5, 16), (3, 6)
"""The least and the largest number of ticks of the axes."""

SECONDS = 10.0
"""The approximate duration (s) of the motion at the default speed of a page."""


def player_data(motion: SceneMotion, curves: Sequence[Column], clock: Array | None = None) -> Plain:
    """The content of the page of a motion: lengths in m, angles in rad, times in s.

    curves: columns with a value for each instant, which the page draws over time below the scene. clock: the times
    (n,) of the page, if they are not those of the scene, such as for a displaced scene.
    """
    scene = planar(motion.scene)
    chosen = _instants(motion, len(curves) + len(scene.drives))
    shown = SceneMotion(scene, motion.native, motion.k, motion.t[chosen], motion.q[chosen], motion.v[chosen])
    markers = [MarkerRef(GROUND, p.name) for p in scene.ground]
    markers += [MarkerRef(b.name, m.name) for b in scene.bodies for m in b.markers]
    at = {marker: marker_positions(shown, marker) for marker in markers}
    beams = beam_bodies(scene)
    paths = [*at.values(), *(c for beam in beams for c in beam_points(shown, beam))]
    if not paths or np.ptp(np.concatenate(paths), axis=0).max() < POINT:
        paths += [shown.pose(body.name)[:, :2] for body in scene.bodies if not isinstance(body, BeamBody)]
    low, high = _view(paths)
    step = rounded(RESOLUTION * float(max(high - low)))
    time = shown.t if clock is None else clock[chosen]
    duration = float(time[-1] - time[0])
    middle = [i for i, p in enumerate(markers) if p.marker == "middle" and p.body in {beam.name for beam in beams}]
    return {
        "name": scene.name,
        "view": [*map(rounded, (*low, *high))],
        "time": clock_data(time),
        "rigid": [
            {"name": b.name, "outline": outline(b), "pose": _pose(shown, b.name, step)}
            for b in scene.bodies
            if not isinstance(b, BeamBody)
        ],
        "beams": [_beam(shown, beam, step) for beam in beams],
        "markers": [_marker(scene, marker) for marker in markers],
        "joints": [_joint(shown, joint, markers, at) for joint in scene.joints],
        "springs": [[markers.index(end) for end in s.markers] for s in scene.springs if FORCES[s.kind].along_line],
        "drives": [
            {
                "name": d.name,
                "unit": drive_unit(scene, d),
                "values": channel(simulated_drive(shown.native, d, shown.t), 1e-4),
            }
            for d in scene.drives
        ],
        "curves": curves_data(curves, chosen),
        "speeds": speeds(duration),
        "trace": (middle or [len(markers) - 1])[0],
    }


def clock_data(t: Array) -> Plain:
    """The times (n,), s, of a page, with the ticks of its axes."""
    return {**channel(t, 1e-6 * float(t[-1] - t[0]) or 1.0), "ticks": _ticks(t, *TIME_TICKS)}


def curves_data(curves: Sequence[Column], chosen: NDArray[np.intp]) -> list[Plain]:
    """Columns at the chosen instants of a page, which draws them over time."""
    return [_curve(replace(c, values=c.values[chosen])) for c in curves]


def _curve(column: Column) -> Plain:
    """A curve with the ticks of its axis; one that does not change has one tick."""
    step, span = 1e-4 * float(np.abs(column.values).max()), float(np.ptp(column.values))
    values = channel(column.values, min(step, 1e-3 * span) if span > step else step)
    shown = column.values[:1] if len(values["values"]) == 1 else column.values
    return {"name": column.name, "unit": column.unit, "values": values, "ticks": _ticks(shown, *CURVE_TICKS)}


def _ticks(values: Array, least: int, most: int) -> list[tuple[float, str]]:
    """Round values between the least and the largest one, with their texts: at least `least` or, of many, two."""
    low, high = float(values.min()), float(values.max())
    at = ticks(low, high, least)
    at = at if len(at) <= most else ticks(low, high, 2)
    return list(zip(at, plain_numbers(at), strict=True))


def speeds(duration: float) -> list[float]:
    """Seven speeds relative to real time, from slow to fast; a page plays for about SECONDS at the middle one."""
    default = math.log10(duration / SECONDS) if duration > 0 else 0.0
    ladder = [float(f"{m}e{e}") for e in range(math.floor(default) - 2, math.floor(default) + 3) for m in (1, 2, 5)]
    middle = min(range(3, len(ladder) - 3), key=lambda i: abs(math.log10(ladder[i]) - default))
    return ladder[middle - 3 : middle + 4]


def _instants(motion: SceneMotion, others: int) -> NDArray[np.intp]:
    """The indices of the instants that a page shows."""
    return frames(len(motion.t), 1 + others + 3 * motion.poses.shape[1] + motion.q.shape[1])


def frames(instants: int, channels: int) -> NDArray[np.intp]:
    """The indices of every instant, or of every second, third, ... one, and of the last, for a number of channels."""
    limit = max(2, min(MAX_FRAMES, MAX_NUMBERS // channels))
    stride = max(1, math.ceil((instants - 1) / (limit - 1)))
    return np.unique(np.append(np.arange(0, instants, stride), instants - 1))


def channel(values: Array, step: float) -> Plain:
    """Numbers as differences in whole steps; a single number if they do not change."""
    step = rounded(step) or 1.0
    whole = np.rint(np.asarray(values) / step).astype(np.int64)
    if np.all(whole == whole[0]):
        whole = whole[:1]
    return {"step": step, "values": np.diff(whole, prepend=0).tolist()}


def rounded(value: float) -> float:
    """The value with five significant digits."""
    return float(f"{value:.5g}")


def _view(paths: Sequence[Array]) -> tuple[Array, Array]:
    """The lower left and the upper right corner around all paths, with a margin, of a moderate aspect ratio."""
    low, high = (extreme(np.concatenate(paths), axis=0) for extreme in (np.min, np.max))
    size = float(max(high - low)) or 1.0
    margin = np.maximum(0.09 * size, (np.array([0.25, 0.4]) * size - (high - low)) / 2)
    return low - margin, high + margin


def _pose(motion: SceneMotion, name: str, step: float) -> list[Plain]:
    """The channels c1, c2, phi of a body or a piece of a beam."""
    c1, c2, phi = motion.pose(name).T
    return [channel(c1, step), channel(c2, step), channel(phi, RESOLUTION)]


def _beam(motion: SceneMotion, beam: BeamBody, step: float) -> Plain:
    """The displacements of a beam, the places of its masses, and the poses and amplitudes of its pieces.

    The amplitudes are those of `shapes`, then those of `stretching`. Pairs of shapes and pieces are counted from 0.
    """
    return {
        "name": beam.name,
        "half": half_length(beam),
        "shapes": [_drawn(shape) for shape in shape_functions(beam)],
        "stretching": [_drawn(field.of) for field in fields_of(beam)[len(shape_functions(beam)) :]],
        "shortening": [[i, j, _drawn(psi)] for i, j, psi in shortening_functions(beam)],
        "masses": [[*piece_at(beam, mass.at)] for mass in beam.beam.masses],
        "pieces": [
            {
                "pose": _pose(motion, name, step),
                "amplitudes": [channel(a, step) for a in field_amplitudes(motion, beam, name).T],
            }
            for name in piece_names(beam)
        ],
    }


def _drawn(function: BeamFunction) -> list[list[float]]:
    """The terms of a function of xi, as geometry.js reads them."""
    return [[t.power, rounded(t.cosine), rounded(t.sine), t.growth, t.frequency] for t in function.real_terms]


def _marker(scene: Scene, marker: MarkerRef) -> Plain:
    """A marker on its body: its coordinates (m), or the index of the piece of a beam and xi there."""
    beam = next((b for b in scene.bodies if b.name == marker.body and isinstance(b, BeamBody)), None)
    on = body_coordinates(scene, marker).tolist() if beam is None else _on_beam(beam, marker.marker)
    return {"body": marker.body, "marker": marker.marker, "on": on}


def _on_beam(beam: BeamBody, marker: str) -> list[float]:
    return [*piece_at(beam, next(m.at for m in beam.beam.markers if m.name == marker))]


def _joint(motion: SceneMotion, joint: Joint, markers: list[MarkerRef], at: dict[MarkerRef, Array]) -> Plain:
    """The markers and the symbol of a joint; of a guide its axis, and the range of the second marker along it."""
    drawing = JOINTS[joint.kind].drawing
    data: Plain = {
        "first": markers.index(joint.first),
        "second": markers.index(joint.second),
        "lines": drawing.lines,
        "circles": drawing.circles,
    }
    if drawing.guide:
        axis = np.array([float(a) for a in joint.axis])
        axis /= np.hypot(*axis)
        on_ground = joint.first.body == GROUND
        phi = np.zeros(len(motion.t)) if on_ground else motion.pose(joint.first.body)[:, 2]
        axes = transformed(np.stack([0 * phi, 0 * phi, phi], axis=1), axis)
        along_axis = np.sum((at[joint.second] - at[joint.first]) * axes, axis=1)
        data |= {"axis": axis.tolist(), "range": [rounded(along_axis.min()), rounded(along_axis.max())]}
    return data
