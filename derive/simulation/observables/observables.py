"""What is to be seen of a motion: where places are, what drives prescribe, what plots show, and how far off it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from derive.runtime.native import NativeScene
from derive.spec.model.body import Parameter, Quantity
from derive.spec.model.scene import (
    GROUND,
    Deflection,
    Drive,
    MarkerRef,
    PointMarker,
    ReferenceCurve,
    RigidBody,
    Scene,
    TimeFunction,
)

Array = NDArray[np.float64]

OPERATIONS: dict[str, Callable[..., Array]] = {
    "add": np.add,
    "sub": np.subtract,
    "mul": np.multiply,
    "div": np.divide,
    "pow": np.power,
    "neg": np.negative,
    "sin": np.sin,
    "cos": np.cos,
    "sqrt": np.sqrt,
}


@dataclass(frozen=True, eq=False)
class Motion:
    """A scene in motion: t (n,) in s, q (n, nq) and v (n, nv) at these instants, in SI units; k is that of setup."""

    scene: Scene
    native: NativeScene
    k: Array
    t: Array
    q: Array
    v: Array

    @cached_property
    def poses(self) -> Array:
        """(n, bodies, 3): position (m) and rotation (rad) of each body, in the order of `native.bodies`."""
        states = zip(self.t, self.q, strict=True)
        return np.array([self.native.poses(float(t), q, self.k) for t, q in states])

    def pose(self, body: str) -> Array:
        """(n, 3): position and rotation of a body, or of a piece of one."""
        found: Array = self.poses[:, self.native.bodies.index(body)]
        return found


def number(quantity: Quantity) -> float:
    """A quantity in SI units; of a parameter its default."""
    return quantity.default if isinstance(quantity, Parameter) else float(quantity)


def points(scene: Scene, body: str) -> tuple[PointMarker, ...]:
    """The material points of a rigid body or of the ground."""
    if body == GROUND:
        return scene.ground
    found = next(b for b in scene.bodies if b.name == body)
    return found.markers if isinstance(found, RigidBody) else ()


def local(scene: Scene, place: MarkerRef) -> Array:
    """(2,): a place of a rigid body or of the ground, in the base of that body, m."""
    point = next(p for p in points(scene, place.body) if p.name == place.marker)
    return np.array([number(point.x), number(point.y)])


def positions(motion: Motion, place: MarkerRef) -> Array:
    """(n, 2): where a place is, in the inertial base, m."""
    native = motion.native
    if place.body == GROUND:
        return np.tile(local(motion.scene, place), (len(motion.t), 1))
    body = next(b for b in motion.scene.bodies if b.name == place.body)
    if isinstance(body, RigidBody):
        return placed(motion.pose(body.name), local(motion.scene, place))
    name, states = f"{place.body}_{place.marker}", zip(motion.q, motion.v, strict=True)
    found: Array = np.array([native.marker(name, q, v, motion.k)[0] for q, v in states])
    return found


def placed(pose: Array, x: Array) -> Array:
    """c + Q(phi) x for each row (c1, c2, phi) of `pose`; x is one point (2,), or one for each row (n, 2)."""
    cosine, sine = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    x1, x2 = x.T
    turned: Array = np.stack([cosine * x1 - sine * x2, sine * x1 + cosine * x2], axis=1)
    return pose[:, :2] + turned


def deflection(motion: Motion, quantity: Deflection) -> Array:
    """(n,): the distance of a place from a chord, to its left, over `over`."""
    start, end = positions(motion, quantity.start), positions(motion, quantity.end)
    chord, arm = end - start, positions(motion, quantity.marker) - start
    area = chord[:, 0] * arm[:, 1] - chord[:, 1] * arm[:, 0]
    distance: Array = area / np.hypot(*chord.T)
    return distance / quantity.over


def driven(drive: Drive, t: Array) -> Array:
    """(n,): the prescribed rotation (rad) or displacement (m) of a drive at the instants t."""
    if drive.motion is not None:
        return np.broadcast_to(evaluate(drive.motion, t), t.shape)
    assert drive.speed is not None
    return number(drive.speed) * t + float(drive.offset)


def drive_unit(scene: Scene, drive: Drive) -> str:
    """rad of a rotation, m of a displacement."""
    kind = next(joint.kind for joint in scene.joints if joint.name == drive.joint)
    return "m" if kind == "translational" else "rad"


def evaluate(function: TimeFunction, t: Array) -> Array:
    """A function of time at the instants t."""
    if function.kind == "number":
        return np.asarray(float(function.value))
    if function.kind == "t":
        return t
    return OPERATIONS[function.kind](*(evaluate(a, t) for a in function.args))


def deviation(x: Array, y: Array, reference: ReferenceCurve) -> tuple[Array, Array] | None:
    """x, and y(x) less its reference over the reference's peak, where both are there.

    Between its values y is a cubic spline. None where x turns back, or where they have nothing in common.
    """
    if len(x) < 2 or not (np.all(np.diff(x) > 0) or np.all(np.diff(x) < 0)):
        return None
    order = slice(None, None, 1 if x[1] > x[0] else -1)
    at, there = curve(reference.rows)
    slack = 1e-9 * (x.max() - x.min())
    common = (at >= x.min() - slack) & (at <= x.max() + slack)
    peak = np.abs(there).max(initial=0.0)
    if not common.any() or peak == 0:
        return None
    between: Array = CubicSpline(x[order], y[order])(at[common])
    return at[common], (between - there[common]) / peak


def curve(rows: Sequence[tuple[float, float]]) -> tuple[Array, Array]:
    """Rows of x and y as two vectors."""
    columns = np.array(rows, dtype=np.float64).reshape(-1, 2).T
    return columns[0], columns[1]
