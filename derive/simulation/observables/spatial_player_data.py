"""The data of the player of bodies in space: surfaces, modes and motion, as plain data in whole steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from derive.reduction.body import prepare
from derive.reduction.modal_stresses import modal_stresses
from derive.simulation.free_body import POSE, FreeBody
from derive.simulation.observables.body_surface import Surface, surface
from derive.simulation.observables.csv_writer import Column
from derive.simulation.observables.mesh_surface import coarsened, mesh_surface
from derive.simulation.observables.motion import Array
from derive.simulation.observables.player_data import (
    RESOLUTION,
    Plain,
    channel,
    clock_data,
    curves_data,
    frames,
    rounded,
    speeds,
)
from derive.simulation.observables.visual_surfaces import BOX_FACES, VisualSurface, box
from derive.solids.stresses import von_mises
from derive.spec.model.body import NodalBody

MAX_NODES, MAX_MESH_NODES = 1000, 3000
"""A body whose surface, as guessed or by its elements, has more nodes is drawn as the box around it."""

STRESS_STEPS = 5000
"""The steps of the largest stress of a mode to which its stresses are rounded."""

BOX_EDGES = tuple((i, i | 1 << axis) for i in range(8) for axis in range(3) if not i >> axis & 1)
"""The edges of a box by its corners, in the order of BOX_FACES."""


@dataclass(frozen=True, eq=False)
class DrawnBody:
    """The drawing of a body: points x (n, 3), m, in its frame, the modes there, phi (N, n, 3), and its surface.

    radius: of the body about the origin of its frame, m. markers: the names and the points of markers. links: pairs of
    points that a thick line connects, such as the markers of a rigid body. smooth: whether faces have no drawn edges.
    triangles: how many faces are those of meshes, and how many triangles the files of these have. nodes: the nodes of a
    finite-element body that the first points are. stresses (N, nodes, 6), Pa/m: those of the modes there, if known.
    """

    name: str
    x: Array
    phi: Array
    surface: Surface
    radius: float
    markers: tuple[tuple[str, int], ...] = ()
    links: tuple[tuple[int, int], ...] = ()
    smooth: bool = False
    triangles: tuple[int, int] = (0, 0)
    nodes: tuple[int, ...] = ()
    stresses: Array | None = None


@dataclass(frozen=True)
class Tie:
    """A line between two markers: a spring, or a distance that a joint keeps.

    ends: for each end the number of a body, -1 for the ground, and the number of a marker of it.
    """

    spring: bool
    ends: tuple[tuple[int, int], tuple[int, int]]


@dataclass(frozen=True, eq=False)
class BodyPath:
    """The motion of the frame of a body: positions c (n, 3), m, unit quaternions (n, 4), and amplitudes (n, N), m."""

    position: Array
    quaternion: Array
    amplitudes: Array


def path_of(q: Array) -> BodyPath:
    """The motion of a body whose coordinates (n, nq) are its own: position, quaternion, amplitudes."""
    own = FreeBody(q.shape[1] - POSE)
    return BodyPath(q[:, own.position], q[:, own.quaternion], q[:, own.amplitudes])


def drawn_body(body: NodalBody) -> DrawnBody:
    """The surface of a body of nodes with its markers: that of its elements if the files have them, and otherwise a
    guess. A guess with more than MAX_NODES is replaced by the box around it, whose corners move as the nearest nodes.
    """
    own = slice(len(body.data.positions))  # without the point masses of a body that is given by moments
    shapes = prepare(body).shapes
    shapes = replace(shapes, x=shapes.x[own], phi=shapes.phi[:, own])
    radius = float(np.linalg.norm(shapes.x, axis=1).max()) or 1.0
    whole = _surface(body, shapes.x)
    marked = [marker.node for marker in body.markers]
    nodes: tuple[int, ...] = ()
    if len(whole.nodes) > (MAX_MESH_NODES if body.data.mesh and body.data.mesh.elements else MAX_NODES):
        corners = box(shapes.x.min(axis=0), shapes.x.max(axis=0))
        shown = [*cKDTree(shapes.x).query(corners)[1], *marked]
        x, drawn = np.concatenate([corners, shapes.x[marked]]), Surface(BOX_FACES, BOX_EDGES)
    else:
        shown = [*(whole.nodes or range(len(shapes.x))), *marked]
        x, number = shapes.x[shown], {node: i for i, node in enumerate(whole.nodes)}
        faces = tuple(tuple(number[node] for node in face) for face in whole.faces)
        drawn = Surface(faces, tuple((number[i], number[j]) for i, j in whole.edges))
        nodes = tuple(whole.nodes)
    first = len(shown) - len(marked)
    markers = tuple((marker.name, first + i) for i, marker in enumerate(body.markers))
    return DrawnBody(body.name, x, shapes.phi[:, shown], drawn, radius, markers, nodes=nodes)


def with_stresses(drawn: DrawnBody, body: NodalBody) -> DrawnBody:
    """The drawing of a body of nodes with the stresses of its modes, where the files have what these need."""
    if not (drawn.nodes and body.data.has_stresses and len(drawn.phi)):
        return drawn
    return replace(drawn, stresses=modal_stresses(body)[:, list(drawn.nodes)])


def _surface(body: NodalBody, x: Array) -> Surface:
    """The surface of the elements of a body, with fewer nodes where there are many; without elements a guess."""
    mesh = body.data.mesh
    if mesh is None or not mesh.elements:
        return surface(x)
    whole = mesh_surface(mesh.elements)
    if len(whole.nodes) > MAX_NODES:
        whole = mesh_surface(mesh.elements, middles=False)
    return whole if len(whole.nodes) <= MAX_NODES else coarsened(whole, x, MAX_NODES)


def beam_drawing(name: str, x: Array, phi: Array) -> DrawnBody:
    """A beam by the corners x (4 n, 3), m, of n square sections from its left to its right end, and its modes there."""
    starts = range(0, len(x) - 4, 4)
    sides = [(s + i, s + (i + 1) % 4, s + 4 + (i + 1) % 4, s + 4 + i) for s in starts for i in range(4)]
    faces = ((0, 1, 2, 3), *sides, tuple(range(len(x) - 4, len(x))))
    ends = [(s + i, s + (i + 1) % 4) for s in (0, len(x) - 4) for i in range(4)]
    edges = (*ends, *((s + i, s + 4 + i) for s in starts for i in range(4)))
    return DrawnBody(name, x, phi, Surface(faces, edges), float(np.linalg.norm(x, axis=1).max()))


def rigid_drawing(
    name: str, mass: float, centre: Array, inertia: Array, markers: Sequence[tuple[str, Array]]
) -> DrawnBody:
    """A rigid body as the homogeneous box of its mass (kg) and inertia tensor (3, 3) about its centre, kg m^2, with
    lines from its centre (3,), m, to its markers (3,); without mass the lines alone."""
    points = np.array([x for _, x in markers]).reshape(-1, 3)
    if mass > 0:
        moments, axes = np.linalg.eigh(inertia)
        half = np.sqrt(np.maximum(moments.sum() - 2 * moments, 0) * 1.5 / mass)
        x = np.concatenate([centre + box(-half, half) @ axes.T, [centre], points])
        drawn, first = Surface(BOX_FACES, BOX_EDGES), 9
        links = tuple((8, first + i) for i in range(len(points)))
    else:
        x, drawn, first = points, Surface((), ()), 0
        links = tuple(pairwise(range(len(points))))
    radius = float(np.linalg.norm(x, axis=1).max()) if len(x) else 0.0
    named = tuple((marker, first + i) for i, (marker, _) in enumerate(markers))
    return DrawnBody(name, x, np.zeros((0, len(x), 3)), drawn, radius or 1.0, named, links)


def visual_drawing(name: str, visuals: VisualSurface, markers: Sequence[tuple[str, Array]]) -> DrawnBody:
    """A rigid body as its visuals and its markers (3,)."""
    x = np.concatenate([visuals.x, np.array([x for _, x in markers]).reshape(-1, 3)])
    radius = float(np.linalg.norm(x, axis=1).max()) or 1.0
    named = tuple((marker, len(visuals.x) + i) for i, (marker, _) in enumerate(markers))
    phi = np.zeros((0, len(x), 3))
    return DrawnBody(name, x, phi, Surface(visuals.faces, ()), radius, named, smooth=True, triangles=visuals.triangles)


def spatial_player_data(body: NodalBody, t: Array, q: Array, curves: Sequence[Column] = ()) -> Plain:
    """The content of the page of the motion q (n, nq) of a body at the times t (n,): lengths in m, times in s.

    curves: columns with a value for each instant, which the page draws over time.
    """
    drawn, paths = [with_stresses(drawn_body(body), body)], [path_of(q)]
    return {
        "name": body.name,
        **bodies_data(drawn),
        **bodies_motion_data(drawn, t, paths),
        "curves": curves_data(curves, shown_frames(t, paths)),
    }


def bodies_data(
    bodies: Sequence[DrawnBody], ground: Sequence[tuple[str, Array]] = (), ties: Sequence[Tie] = ()
) -> Plain:
    """The part of the content of a page that does not depend on the motion.

    ground: names and places (3,), m, of the markers of the ground. ties: the lines between markers.
    """
    return {
        "bodies": [
            {
                "name": body.name,
                "nodes": _rounded(body.x),
                "shapes": [_rounded(mode) for mode in body.phi],
                "faces": body.surface.faces,
                "edges": body.surface.edges,
                "links": body.links,
                "smooth": body.smooth,
                "markers": [{"name": name, "node": node} for name, node in body.markers],
                "stresses": [] if body.stresses is None else [_in_steps(mode) for mode in body.stresses],
            }
            for body in bodies
        ],
        "ground": [{"name": name, "at": _rounded(at)} for name, at in ground],
        "ties": [{"spring": tie.spring, "ends": tie.ends} for tie in ties],
        "radius": rounded(max(body.radius for body in bodies)),
        "triangles": [sum(body.triangles[i] for body in bodies) for i in range(2)],
    }


def bodies_motion_data(
    bodies: Sequence[DrawnBody], t: Array, paths: Sequence[BodyPath], measured: bool = True
) -> Plain:
    """The part of the content of a page that is the motion of bodies at the times t (n,), s.

    measured: whether amplitudes have a meaning, so that the page states the largest displacement by deformation.
    """
    chosen = shown_frames(t, paths)
    t = t[chosen]
    shown = [BodyPath(p.position[chosen], p.quaternion[chosen], p.amplitudes[chosen]) for p in paths]
    points = np.concatenate([_points(body, path) for body, path in zip(bodies, shown, strict=True)])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    reach = float(np.linalg.norm(points - middle, axis=1).max()) or 1.0
    largest = max(_largest_displacement(body, path) for body, path in zip(bodies, shown, strict=True))
    return {
        "time": clock_data(t),
        "paths": [_path_data(path, rounded(RESOLUTION * reach)) for path in shown],
        "reach": rounded(reach),
        "centre": _rounded(middle),
        "displacement": rounded(largest),
        "stress": rounded(max(_largest_stress(body, path) for body, path in zip(bodies, shown, strict=True))),
        "measured": measured,
        "speeds": speeds(float(t[-1] - t[0])),
    }


def shown_frames(t: Array, paths: Sequence[BodyPath]) -> NDArray[np.intp]:
    """The instants of the times t (n,) that a page shows."""
    return frames(len(t), 1 + sum(7 + path.amplitudes.shape[1] for path in paths))


def _path_data(path: BodyPath, step: float) -> Plain:
    return {
        "position": [channel(c, step) for c in path.position.T],
        "quaternion": [channel(e, RESOLUTION) for e in path.quaternion.T],
        "amplitudes": [channel(a, 1e-5 * float(np.abs(a).max())) for a in path.amplitudes.T],
    }


def placed(body: DrawnBody, path: BodyPath) -> Array:
    """The places (n, points, 3), m, of the points of a deformed body in all instants."""
    return turned(path, body.x + np.tensordot(path.amplitudes, body.phi, axes=1))


def _points(body: DrawnBody, path: BodyPath) -> Array:
    """The places (places, 3), m, of the points of an undeformed body, and of its origin, in all instants.

    Of a body of many points these are the corners of the box around it.
    """
    x = np.concatenate([body.x, np.zeros((1, 3))])
    x = box(x.min(axis=0), x.max(axis=0)) if len(x) > MAX_NODES else x
    return turned(path, x).reshape(-1, 3)


def turned(path: BodyPath, x: Array) -> Array:
    """The places (n, points, 3), m, of points x (points, 3) or (n, points, 3), m, of a body frame."""
    e0, e = path.quaternion[:, None, :1], path.quaternion[:, None, 1:]
    turned: Array = path.position[:, None] + x + 2 * np.cross(e, np.cross(e, x) + e0 * x)
    return turned


def _largest_displacement(body: DrawnBody, path: BodyPath) -> float:
    """The largest displacement by deformation, m, of the points of a body in all instants."""
    if not path.amplitudes.shape[1] or not len(body.x):
        return 0.0
    moved = np.tensordot(path.amplitudes, body.phi, axes=1)
    return float(np.linalg.norm(moved, axis=2).max())


def _largest_stress(body: DrawnBody, path: BodyPath) -> float:
    """The largest stress of von Mises, Pa, at the points of a body in all instants; zero where it is not known."""
    if body.stresses is None:
        return 0.0
    instants = (np.tensordot(amplitudes, body.stresses, axes=1) for amplitudes in path.amplitudes)
    return max(float(von_mises(stresses).max()) for stresses in instants)


def _in_steps(stresses: Array) -> Plain:
    """The stresses (nodes, 6) of a mode as whole steps."""
    step = float(np.abs(stresses).max()) / STRESS_STEPS or 1.0
    return {"step": rounded(step), "values": np.rint(stresses / rounded(step)).astype(int).ravel().tolist()}


def _rounded(values: Array) -> Any:
    """Numbers with five significant digits."""
    return np.vectorize(rounded, otypes=[float])(values).tolist()
