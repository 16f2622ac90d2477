"""Rotational springs whose markers turn by more than half a turn, which nothing counts: their torque would jump."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS, Freedom
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.configurations import displaced
from derive.simulation.errors import SimulationError
from derive.simulation.space.joint_targets import is_constraint
from derive.simulation.space.marker_frames import frame_of
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.spatial_forces import SpatialSpring
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

SEEN = 1.5
"""rad: rotations between two rows up to which their rates tell on which side they are of half a turn."""
AGREE = 0.5
"""rad: the largest distance of a rotation from the one that these rates foretell."""
DIFFERENCE = 1e-6
"""s: the step of the differences that give the rates of rotations."""


class HalfTurn(SimulationError):
    """A rotational spring whose markers have turned by more than half a turn at t (s), which nothing counts.

    start: the initial angle (rad) of the joint of its markers, if it is that which is beyond half a turn.
    """

    def __init__(self, spring: str, t: float, start: float | None = None) -> None:
        self.spring, self.t = spring, t
        when = f"by t = {t:.9g} s" if start is None else f"at the start, by {start:g} rad,"
        effect = "jump" if start is None else "be another one"
        instead = "end the simulation before" if start is None else "start it within half a turn, with another `rest`"
        super().__init__(
            f"springs.{spring}: {when} its markers turn by more than half a turn, and rotations between them "
            f"are known from -pi to pi, so that its torque would {effect}. Turns are counted by a drive, by a screw "
            "joint, and by a joint to the ground or to a body with a prescribed motion where a rigid body keeps the "
            f"coordinates of the joint alone: put the spring between the two markers of such a joint, or {instead}."
        )


def half_turn_notes(
    scene: AnyScene, native: NativeScene, k: Vector, t: Vector, q: Matrix, v: Matrix
) -> tuple[str, ...]:
    """A note on each spring of which states do not tell whether it passes half a turn: q (n, nq), v (n, nv), t (n,), s.

    Raises HalfTurn if one does.
    """
    return tuple(_notes(scene, native, k, t, q, v)) if isinstance(scene, SpatialScene) else ()


def _notes(scene: SpatialScene, native: NativeScene, k: Vector, t: Vector, q: Matrix, v: Matrix) -> Iterator[str]:
    for spring in uncounted(scene, native):
        joint = scene.joint_between(spring.first, spring.second)
        start = joint.start.angle if joint else None
        if start is not None and abs(start) > math.pi:
            raise HalfTurn(spring.name, float(t[0]), start)
        angles, rates = _rotations(scene, native, k, spring, t, q, v)
        close = True  # rows, so that turns between them are seen
        for i in range(1, len(t)):
            step = t[i] - t[i - 1]
            foreseen = angles[i - 1] + (rates[i - 1] + rates[i]) / 2 * step
            turns = round((foreseen - angles[i]) / (2 * math.pi))
            missed = abs(foreseen - angles[i] - 2 * math.pi * turns)
            if max(abs(rates[i - 1]), abs(rates[i])) * step > SEEN or missed > AGREE:
                close = False
            elif turns:
                raise HalfTurn(spring.name, float(t[i]))
        if not close:
            yield (
                f"springs.{spring.name}: nothing counts the turns of its markers, and rows of the output are too far "
                "apart to tell whether they turn by more than half a turn, where its torque would jump; a smaller "
                "`output` tells"
            )


def uncounted(scene: SpatialScene, native: NativeScene) -> Iterator[SpatialSpring]:
    """The rotational springs whose turns nothing counts; a damper alone has no torque that could jump."""
    for spring in scene.springs:
        if spring.kind != "rotational" or spring.values["stiffness"] == 0:
            continue
        joint = scene.joint_between(spring.first, spring.second)
        if joint is not None:
            of = SPATIAL_JOINTS[joint.kind]
            axial = of.leaves(of.removed(joint), Freedom.ROTATION)
            turned = of.driven is Freedom.ROTATION and any(drive.joint == joint.name for drive in scene.drives)
            if axial and (of.is_screw or turned or not is_constraint(joint, native)):
                continue
        yield spring


def _rotations(
    scene: SpatialScene, native: NativeScene, k: Vector, spring: SpatialSpring, t: Vector, q: Matrix, v: Matrix
) -> tuple[Vector, Vector]:
    """The rotations (n,), rad, between the markers of a spring, from -pi to pi, and their rates (n,), rad/s."""

    def angle(time: float, at: Vector) -> float:
        poses = SpatialPoses(native, k, time, at, 1.0)
        first, second = (frame_of(scene, poses, marker).axes for marker in spring.markers)
        return math.atan2(first[:, 1] @ second[:, 0], first[:, 0] @ second[:, 0])

    angles, rates = np.empty(len(t)), np.empty(len(t))
    for i, (time, at, moving) in enumerate(zip(t.tolist(), q, v, strict=True)):
        angles[i] = angle(time, at)
        ends = [angle(time + h, displaced(native, at, h * moving)) for h in (DIFFERENCE, -DIFFERENCE)]
        rates[i] = math.remainder(ends[0] - ends[1], 2 * math.pi) / (2 * DIFFERENCE)
    return angles, rates
