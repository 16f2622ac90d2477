"""The data of the player of a scene in space: the bodies with their markers, edges and motion, as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, pairwise

import numpy as np

from derive.simulation.configurations import quaternion_of
from derive.simulation.observables.motion import Array, SceneMotion, si_value
from derive.simulation.observables.player_data import RESOLUTION, Plain, channel, frames, rounded, speeds
from derive.spec.model.markers import GROUND
from derive.spec.model.spatial_scene import FrameMarker, SpatialRigidBody, SpatialScene

FEW = 6
"""The largest number of markers between all of which edges are drawn; otherwise they go to the centre of mass."""


def spatial_scene_player_data(scene: SpatialScene, motion: SceneMotion) -> Plain:
    """The content of the page of a motion: lengths in m, times in s."""
    drawings = {body.name: _drawing(body.markers, _centre(body)) for body in scene.bodies}
    if scene.ground:
        drawings[GROUND] = _drawing(scene.ground, None)
    width = sum(7 for _ in drawings)
    chosen = frames(len(motion.t), 1 + width)
    t = motion.t[chosen]
    still = np.tile(np.concatenate([np.zeros(3), np.eye(3).ravel()]), (len(t), 1))
    poses = {name: still if name == GROUND else motion.pose(name)[chosen] for name in drawings}
    points = np.vstack(
        [pose[:, :3] + pose[:, 3:].reshape(-1, 3, 3) @ x for name, pose in poses.items() for x in drawings[name].x]
    )
    low, high = points.min(axis=0), points.max(axis=0)
    reach = float(np.linalg.norm(high - low)) / 2 or 1.0
    step = rounded(RESOLUTION * reach)
    return {
        "name": scene.name,
        "time": channel(t, 1e-6 * float(t[-1] - t[0]) or 1.0),
        "bodies": [
            {
                "nodes": np.vectorize(rounded, otypes=[float])(drawings[name].x).tolist(),
                "shapes": [],
                "edges": drawings[name].edges,
                "markers": drawings[name].markers,
                "radius": rounded(0.4 * reach),
                "position": [channel(c, step) for c in pose[:, :3].T],
                "quaternion": [channel(e, RESOLUTION) for e in quaternions(pose[:, 3:]).T],
                "amplitudes": [],
            }
            for name, pose in poses.items()
        ],
        "radius": rounded(reach),
        "reach": rounded(reach),
        "centre": [rounded(float(x)) for x in (low + high) / 2],
        "speeds": speeds(float(t[-1] - t[0])),
    }


def quaternions(rotations: Array) -> Array:
    """The quaternions (n, 4) of rotation tensors by rows (n, 9), next to each other without jumps of the sign."""
    result = np.array([quaternion_of(Q.reshape(3, 3)) for Q in rotations])
    signs = np.cumprod([1.0, *(-1.0 if a @ b < 0 else 1.0 for a, b in pairwise(result))])
    return np.asarray(result * signs[:, None])


class _Drawing:
    """Points x (n, 3), m, in the frame of a body, with edges between them and the names of markers."""

    def __init__(self, x: Array, edges: list[list[int]], markers: list[Plain]) -> None:
        self.x, self.edges, self.markers = x, edges, markers


def _drawing(markers: Sequence[FrameMarker], centre: Array | None) -> _Drawing:
    points = [np.array([si_value(x) for x in m.position]) for m in markers]
    named: list[Plain] = [{"name": m.name, "node": i} for i, m in enumerate(markers)]
    if centre is None:
        return _Drawing(np.array(points), [], named)
    if len(points) > FEW or len(points) < 2:
        edges = [[i, len(points)] for i in range(len(points))]
        return _Drawing(np.array([*points, centre]), edges, named)
    return _Drawing(np.array([*points, centre]), [list(pair) for pair in combinations(range(len(points)), 2)], named)


def _centre(body: SpatialRigidBody) -> Array:
    return np.array([si_value(x) for x in body.centre])
