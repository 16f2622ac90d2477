"""The data of the player of a body in space: nodes, edges, modes and motion, as plain data in whole steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from derive.reduction.body import prepare
from derive.simulation.observables.motion import Array
from derive.simulation.observables.player_data import RESOLUTION, Plain, channel, frames, rounded, speeds
from derive.spec.model.body import NodalBody

MAX_NODES = 400
"""A body with more nodes is drawn as the box around them."""

NEIGHBOURS = 26
"""The number of nearest nodes to which edges are considered."""


@dataclass(frozen=True, eq=False)
class DrawnBody:
    """The drawing of a body: points x (n, 3), m, in its frame, the modes there, phi (N, n, 3), and edges (pairs).

    radius: of the body about the origin of its frame, m. markers: the names and the nodes of markers.
    """

    x: Array
    phi: Array
    edges: list[list[int]]
    radius: float
    markers: list[Plain]


def drawn_body(body: NodalBody) -> DrawnBody:
    """The nodes of a body with edges between neighbours; if there are more than MAX_NODES, the box around them, whose
    corners move as the nearest nodes."""
    shapes = prepare(body).shapes
    radius = float(np.linalg.norm(shapes.x, axis=1).max()) or 1.0
    if len(shapes.x) > MAX_NODES:
        return DrawnBody(*_box(shapes.x, shapes.phi), radius, [])
    markers: list[Plain] = [{"name": marker.name, "node": marker.node} for marker in body.markers]
    return DrawnBody(shapes.x, shapes.phi, neighbours(shapes.x), radius, markers)


def spatial_player_data(body: NodalBody, t: Array, q: Array) -> Plain:
    """The content of the page of the motion q (n, nq) of a body at the times t (n,): lengths in m, times in s."""
    drawn = drawn_body(body)
    return {"name": body.name, **body_data(drawn), **body_motion_data(drawn, t, q)}


def body_data(drawn: DrawnBody) -> Plain:
    """The part of the content of a page that does not depend on the motion."""
    return {
        "nodes": _rounded(drawn.x),
        "shapes": [_rounded(mode) for mode in drawn.phi],
        "edges": drawn.edges,
        "markers": drawn.markers,
        "radius": rounded(drawn.radius),
    }


def body_motion_data(drawn: DrawnBody, t: Array, q: Array) -> Plain:
    """The part of the content of a page that is the motion q (n, nq) at the times t (n,), s."""
    chosen = frames(len(t), 1 + q.shape[1])
    t, q = t[chosen], q[chosen]
    middle = (q[:, :3].min(axis=0) + q[:, :3].max(axis=0)) / 2
    reach = drawn.radius + float(np.linalg.norm(q[:, :3] - middle, axis=1).max())
    step = rounded(RESOLUTION * reach)
    return {
        "time": channel(t, 1e-6 * float(t[-1] - t[0]) or 1.0),
        "position": [channel(c, step) for c in q[:, :3].T],
        "quaternion": [channel(e, RESOLUTION) for e in q[:, 3:7].T],
        "amplitudes": [channel(a, 1e-5 * float(np.abs(a).max())) for a in q[:, 7:].T],
        "reach": rounded(reach),
        "centre": _rounded(middle),
        "speeds": speeds(float(t[-1] - t[0])),
    }


def neighbours(x: Array) -> list[list[int]]:
    """The edges of the Gabriel graph of nodes (n, 3): pairs with no other node in the sphere between them, or on it.

    For a grid these are the edges of its cells. Only the nearest nodes are considered.
    """
    if len(x) < 2:
        return []
    tree = cKDTree(x)
    distances, indices = tree.query(x, k=min(NEIGHBOURS + 1, len(x)))
    edges: list[list[int]] = []
    for i, (lengths, others) in enumerate(zip(distances, indices, strict=True)):
        for length, j in zip(lengths, others, strict=True):
            if i < j and length and len(tree.query_ball_point((x[i] + x[j]) / 2, length / 2 * (1 + 1e-6))) == 2:
                edges.append([i, int(j)])
    return edges


def _box(x: Array, phi: Array) -> tuple[Array, Array, list[list[int]]]:
    """The corners of the box around nodes, the modes there, and the edges of the box."""
    low, high = x.min(axis=0), x.max(axis=0)
    bits = np.array([[(corner >> axis) & 1 for axis in range(3)] for corner in range(8)])
    corners: Array = np.where(bits, high, low)
    nearest: NDArray[np.intp] = cKDTree(x).query(corners)[1]
    edges = [[i, i | 1 << axis] for i in range(8) for axis in range(3) if not i >> axis & 1]
    return corners, phi[:, nearest], edges


def _rounded(values: Array) -> Any:
    """Numbers with five significant digits."""
    return np.vectorize(rounded, otypes=[float])(values).tolist()
