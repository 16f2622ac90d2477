"""A scene in motion: poses of bodies, prescribed motions of drives, deviations from references."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.prescribed_motion import drive_motion
from derive.runtime.native_scene import NativeScene
from derive.spec.files.splines import cubic_spline
from derive.spec.model.joints import Drive
from derive.spec.model.markers import GROUND, MarkerRef, PointMarker
from derive.spec.model.planar_bodies import BeamBody, CustomBody, RigidBody
from derive.spec.model.plots import ReferenceCurve
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.spec.model.time_function import TimeFunction, value_at

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SceneMotion:
    """A scene at the times t (n,), s: q (n, nq) and v (n, nv) in SI units, and the constants k (nk,) of `setup`.

    outputs (n, nout): those of the compiled scene, where they are known.
    """

    scene: AnyScene
    native: NativeScene
    k: Array
    t: Array
    q: Array
    v: Array
    outputs: Array | None = None

    @cached_property
    def poses(self) -> Array:
        """The poses of each body frame in `native.bodies`, (n, bodies, 3) or in space (n, bodies, 12)."""
        states = zip(self.t, self.q, strict=True)
        return np.array([self.native.poses(float(t), q, self.k) for t, q in states])

    def pose(self, body: str) -> Array:
        """The position and rotation (n, 3) of the frame of a body, or of a piece of a beam."""
        pose: Array = self.poses[:, self.native.bodies.index(body)]
        return pose


def planar(scene: AnyScene) -> Scene:
    """A scene that is in the plane."""
    assert isinstance(scene, Scene), "this is computed of planar scenes alone"
    return scene


def si_value(quantity: Quantity) -> float:
    """A quantity in SI units; the default of a parameter."""
    return quantity.default if isinstance(quantity, Parameter) else float(quantity)


def material_points(scene: Scene, body: str) -> tuple[PointMarker, ...]:
    """The markers of a rigid body or of the ground, given by coordinates; none of a beam."""
    if body == GROUND:
        return scene.ground
    owner = next(b for b in scene.bodies if b.name == body)
    return () if isinstance(owner, BeamBody) else owner.markers


def body_coordinates(scene: Scene, marker: MarkerRef) -> Array:
    """The coordinates (2,), m, of a marker of a rigid body or of the ground, in the frame of that body."""
    point = next(p for p in material_points(scene, marker.body) if p.name == marker.marker)
    return np.array([si_value(point.x), si_value(point.y)])


def outline(body: RigidBody | CustomBody) -> list[list[float]]:
    """The convex hull of the markers of a body, counter-clockwise; two markers make a line."""
    points = sorted({(si_value(m.x), si_value(m.y)) for m in body.markers})
    if len(points) < 3:
        return [list(p) for p in points]
    corners: list[tuple[float, float]] = []
    for ordered in (points, points[::-1]):
        chain: list[tuple[float, float]] = []
        for x, y in ordered:
            while len(chain) > 1 and _orientation(chain[-2], chain[-1], (x, y)) <= 0:
                chain.pop()
            chain.append((x, y))
        corners += chain[:-1]
    return [list(p) for p in corners]


def _orientation(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    """Twice the signed area of a triangle: positive if a, b, c are counter-clockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def transformed(pose: Array, x: Array) -> Array:
    """The points c + Q(phi) x (n, 2) of poses (c1, c2, phi) (n, 3); x: one point (2,), or one for each pose (n, 2)."""
    cosine, sine = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    x1, x2 = x.T
    rotated: Array = np.stack([cosine * x1 - sine * x2, sine * x1 + cosine * x2], axis=1)
    return pose[:, :2] + rotated


def drive_values(drive: Drive, t: Array) -> Array:
    """The prescribed rotations (n,), rad, or displacements, m, of a drive at the times t (n,), s."""
    return function_values(drive_motion(drive), t)


def simulated_drive(native: NativeScene, drive: Drive, t: Array) -> Array:
    """The prescribed rotations (n,), rad, or displacements, m, of a drive, which may follow an input of the scene."""
    if drive.motion is None or drive.motion.kind != "input":
        return drive_values(drive, t)
    index = native.inputs.index(drive.motion.name)
    return np.array([native.inputs_at(float(time))[index] for time in t])


def drive_unit(scene: AnyScene, drive: Drive) -> str:
    """The unit of a drive: rad of a rotation, m of a displacement."""
    kind = next(joint.kind for joint in scene.joints if joint.name == drive.joint)
    driven = (SPATIAL_JOINTS if isinstance(scene, SpatialScene) else JOINTS)[kind].driven
    assert driven is not None, "the specification refuses other drives"
    return driven.unit


def function_values(function: TimeFunction, t: Array) -> Array:
    """The values (n,) of a function of time at the times t (n,), s, with the defaults of its parameters."""
    return np.array([value_at(function, float(time)) for time in t])


def deviation(x: Array, y: Array, reference: ReferenceCurve) -> tuple[Array, Array] | None:
    """The common x (m,), and y(x) minus the reference (m,), divided by the peak of the reference.

    x, y: a curve (n,), interpolated by a cubic spline. None where x is not monotonic, has no point in common with
    the reference, or has steps too small for a spline.
    """
    if len(x) < 2 or not (np.all(np.diff(x) > 0) or np.all(np.diff(x) < 0)):
        return None
    order = slice(None, None, 1 if x[1] > x[0] else -1)
    reference_x, reference_y = reference_curve(reference.rows)
    slack = 1e-9 * (x.max() - x.min())
    common = (reference_x >= x.min() - slack) & (reference_x <= x.max() + slack)
    peak = np.abs(reference_y).max(initial=0.0)
    if not common.any() or peak == 0:
        return None
    try:
        spline = cubic_spline("", x[order].tolist(), y[order].tolist())
    except ArithmeticError:
        return None
    interpolated = np.array([spline(at) for at in reference_x[common].tolist()])
    return reference_x[common], (interpolated - reference_y[common]) / peak


def reference_curve(rows: Sequence[tuple[float, float]]) -> tuple[Array, Array]:
    """The columns x (n,) and y (n,) of the rows of a reference."""
    columns = np.array(rows, dtype=np.float64).reshape(-1, 2).T
    return columns[0], columns[1]
