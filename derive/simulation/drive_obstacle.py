"""Drives that a linkage cannot follow: whether its joints can be met, undeformed, wherever drives move it.

The drives are walked through what they prescribe over a run, from its initial state, and Newton's method closes the
joints in small steps. What has been passed once is not walked again, since a linkage without other freedom returns to
where it was.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice, pairwise

import numpy as np

from derive.enumerations import enumeration
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.prescribed_motion import drive_motion
from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import constraint_matrix, max_norm
from derive.simulation.configurations import difference, displaced, velocities_with
from derive.simulation.constraints.closest_state import (
    PERTURBATIONS,
    changed,
    closest_state,
    perturbed,
    unmet_constraints,
)
from derive.simulation.constraints.scaling import SINGULAR
from derive.simulation.observables.motion import drive_unit
from derive.spec.model.instances import joined
from derive.spec.model.joints import Joint
from derive.spec.model.markers import GROUND
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialJoint
from derive.spec.model.specification import AnyScene
from derive.spec.model.time_function import value_at

SAMPLES = 250
"""The number of times over a run at which the drives are evaluated."""
STEP = 0.15
"""rad, and part of the size of the scene: the steps in which drives are walked."""
TURN = 2 * math.pi + STEP
"""rad: a drive that has rotated by this has taken the linkage back to where it was, and can continue."""
MOST_STEPS = 400
"""The number of steps after which the walk ends, as it must not take long."""
HALVINGS = 8
"""The largest number of times that a step is halved where the joints are not met behind it."""
BEYOND = (0.03, 0.1, 0.3)
"""rad, and part of the size: the distances behind an obstacle at which the joints must be violated."""
GAP = 1e-3
"""Part of the size: the smallest violation of joints that makes an obstacle; rounded lengths may cause smaller ones."""
MET = 1e-7
"""Part of the size: joints that are violated by no more than this are met."""
NEAR = 1.0
"""rad: bodies that rotate by more in a step have jumped to another way of closing the linkage."""
NEWTON_STEPS = 10
BEGUN = 1e-3
"""rad, and part of the size: the least motion of drives before an obstacle; with less, rigid beams do not move."""


@dataclass(frozen=True)
class DriveObstacle:
    """The point of a motion where the joints of a linkage can no longer be met: the time (s), the drives with their
    values and units there, and the joints; rigid: what is taken as rigid in the search, "beams" or "bodies", or ""."""

    t: float
    drives: tuple[tuple[str, float, str], ...]
    joints: tuple[str, ...]
    rigid: str

    def __str__(self) -> str:
        where = " and ".join(f"{name} = {value:.5g} {unit}" for name, value, unit in self.drives)
        joints = f"the joint{'s' if len(self.joints) > 1 else ''} {enumeration(self.joints)}"
        return (
            f"the linkage cannot be turned through: beyond {where} (t = {self.t:.5g} s) {joints} cannot be met"
            f"{f' with rigid {self.rigid}' if self.rigid else ''}"
        )


def drive_obstacle(scene: AnyScene, native: NativeScene, k: Vector, q: Vector, size: float) -> DriveObstacle | None:
    """The first obstacle on the way of the drives over the simulation of a scene, if there is one.

    q (nq,): the initial configuration, whose deformations stay; size: that of the scene, m. Where no rigid motion
    begins at all, beams are there to be bent by their drives, and no obstacle is sought; nor where drives follow
    run-time inputs, whose functions are called once the integration needs them.
    """
    unknown = any(drive.motion is not None and drive.motion.kind == "input" for drive in scene.drives)
    if not scene.drives or unknown or not native.nlambda or not _has_loop(scene):
        return None
    try:
        return _Walk(scene, native, k, q, size).obstacle()
    except (ArithmeticError, ValueError):  # numbers that are not finite, on which the integration itself reports
        return None


@dataclass(frozen=True, eq=False)
class _Front:
    """The state that the walk of drives has reached: the time (s), their values u (drives,), the configuration q (nq,),
    and the change (nv,) of q per change of u on the way here."""

    t: float
    u: Vector
    q: Vector
    slope: Vector


class _Walk:
    """The walk of the drives of a scene, whose values u count angles in rad and lengths as parts of the size."""

    def __init__(self, scene: AnyScene, native: NativeScene, k: Vector, q: Vector, size: float) -> None:
        self.scene, self.native, self.k, self.start, self.size = scene, native, k, q, size
        self.units = [drive_unit(scene, drive) for drive in scene.drives]
        self.motions = [drive_motion(drive) for drive in scene.drives]
        self.scales = np.array([1.0 if unit == "rad" else size for unit in self.units])
        self.free = ~velocities_with(native, Role.AMPLITUDE)
        self.lengths = np.where(velocities_with(native, Role.ROTATION), 1.0, size)[self.free]
        G = constraint_matrix(native, 0.0, q, k)[:, self.free] * self.lengths
        self.movable = int(np.sum(self.free)) > np.linalg.matrix_rank(G, SINGULAR * np.abs(G).max(initial=1.0))

    def obstacle(self) -> DriveObstacle | None:
        """The first obstacle on the way; None as well where no rigid motion begins."""
        path = list(islice(self._path(), MOST_STEPS))
        if not path or not np.all(np.isfinite([u for _, u in path])):
            return None
        single = len(self.units) == 1
        first = self._values(np.zeros(1))[0]
        fronts: dict[int, _Front | None] = dict.fromkeys((1, -1), _Front(0.0, first, self.start, self._still()))
        for number, (time, u) in enumerate(path):
            # A single drive walks on where it has not been yet.
            sign = 1 if not single or u[0] > first[0] else -1
            front = fronts[sign]
            if front is None or single and sign * (u[0] - front.u[0]) <= 0.0:
                continue
            moved = self._moved(front, time, u) or self._passed(front, path[number:])
            if isinstance(moved, DriveObstacle):
                return moved
            fronts[sign] = moved
        return None

    def _still(self) -> Vector:
        """No change (nv,) of the configuration."""
        return np.zeros(self.native.nv)

    def _path(self) -> Iterator[tuple[float, Vector]]:
        """Times and values of the drives, from each to the next of which drives move by about a step at most.

        Between two of them a drive moves in one direction.
        """
        assert self.scene.simulation is not None
        times = np.linspace(0.0, self.scene.simulation.duration, SAMPLES + 1)
        values = self._values(times)
        last, low, high = values[0], values[0], values[0]
        for i, (before, after) in enumerate(pairwise(values)):
            count = math.ceil(max_norm(after - before) / STEP)
            if count > SAMPLES:
                return  # so fast that a drive turns through between two samples
            inner = np.linspace(times[i], times[i + 1], count + 1)[1:]
            yield from zip(inner[:-1].tolist(), self._values(inner[:-1]), strict=True)
            last = before if count > 1 else last
            ahead = values[i + 2] - after if i + 2 < len(values) else 0.0 * after
            if max_norm(after - last) + max_norm(ahead) > STEP or np.any(ahead * (after - before) <= 0.0):
                yield float(times[i + 1]), after
                last = after
            low, high = np.minimum(low, after), np.maximum(high, after)
            if len(low) == 1 and high[0] - low[0] > TURN:
                return

    def _values(self, times: Vector) -> Matrix:
        """The values u (n, drives) of the drives at times (n,), s."""
        rows = [[value_at(motion, t) for motion in self.motions] for t in times.tolist()]
        return np.asarray(np.array(rows).reshape(len(rows), len(self.scales)) / self.scales)

    def _moved(self, front: _Front, time: float, u: Vector) -> _Front | None:
        """The front at a later time, by Newton's method; None if it does not converge next to where the front is."""
        distance = float(np.linalg.norm(u - front.u))
        if distance == 0.0:
            return front
        q = displaced(self.native, front.q, distance * front.slope)
        for _ in range(NEWTON_STEPS):
            g = self.native.constraints(time, q, self.k)
            error = max_norm(g)
            if error <= MET * self.size:
                change = difference(self.native, front.q, q)
                if max_norm(change[self.free] / self.lengths) > NEAR:
                    return None
                return _Front(time, u, q, change / distance)
            if not error < self.size:
                return None
            rows = constraint_matrix(self.native, time, q, self.k)[:, self.free] * self.lengths
            q = changed(self.native, q, self.free, -self.lengths * np.linalg.lstsq(rows, g, rcond=SINGULAR)[0])
        return None

    def _passed(self, front: _Front, path: Sequence[tuple[float, Vector]]) -> _Front | DriveObstacle | None:
        """The front behind a point that Newton's method does not pass, or the obstacle that is there.

        None if the drives turn back before the joints miss each other by more than a small gap.
        """
        front = self._nearest(front, path[0][0])
        for distance in BEYOND:
            beyond = next(((t, u) for t, u in path if np.linalg.norm(u - front.u) >= distance), None)
            time, u = beyond or max(path, key=lambda at: float(np.linalg.norm(at[1] - front.u)))
            states = (closest_state(self.native, self.k, time, start, self.free) for start in self._starts(front.q))
            missed = []
            for state in states:
                if state.converged:
                    return _Front(time, u, state.q, self._still())
                missed.append(state)
            least = min(missed, key=lambda state: state.error)
            if least.error > GAP * self.size:
                return self._described(front, [name for name, _ in unmet_constraints(self.native, least.g)])
            if beyond is None:
                break
        return None

    def _nearest(self, front: _Front, end: float) -> _Front:
        """The last state next to which the joints can be met, before a time at which they cannot."""
        for _ in range(HALVINGS):
            middle = (front.t + end) / 2
            moved = self._moved(front, middle, self._values(np.array([middle]))[0])
            if moved is None:
                end = middle
            else:
                front = moved
        return front

    def _starts(self, q: Vector) -> Iterator[Vector]:
        """The configurations near which closed ones are sought: q, and ones beside it if the linkage can move."""
        yield q
        for angle in PERTURBATIONS if self.movable else ():
            yield perturbed(self.native, q, angle, self.free)

    def _described(self, front: _Front, unmet: Sequence[str]) -> DriveObstacle | None:
        if np.linalg.norm(front.u - self._values(np.zeros(1))[0]) < BEGUN:
            return None
        drives = zip(self.scene.drives, front.u * self.scales, self.units, strict=True)
        joints = [
            joint.name
            for joint in self.scene.joints
            if any(joined(joint.name, label) in unmet for label in _labels(joint))
        ]
        values = tuple((drive.name, float(value), unit) for drive, value, unit in drives)
        return DriveObstacle(front.t, values, tuple(joints), _taken_as_rigid(self.scene))


def _labels(joint: Joint | SpatialJoint) -> tuple[str, ...]:
    """The labels of the constraints of a joint."""
    if isinstance(joint, SpatialJoint):
        return tuple(row.label for row in SPATIAL_JOINTS[joint.kind].rows(joint))
    return tuple(row.label for row in JOINTS[joint.kind].removes)


def _taken_as_rigid(scene: AnyScene) -> str:
    """The word for the bodies of a scene that may deform; an empty text if all are rigid."""
    if any(isinstance(body, (BeamBody, SpatialBeam)) for body in scene.bodies):
        return "beams"
    return "bodies" if any(isinstance(body, FlexibleBody) for body in scene.bodies) else ""


def _has_loop(scene: AnyScene) -> bool:
    """Whether joints connect bodies in a loop; without a loop, each body follows those that it is connected to."""
    groups = {name: {name} for name in (GROUND, *(body.name for body in scene.bodies))}
    for joint in scene.joints:
        first, second = groups[joint.first.body], groups[joint.second.body]
        if first is second:
            return True
        first |= second
        groups.update(dict.fromkeys(second, first))
    return False
