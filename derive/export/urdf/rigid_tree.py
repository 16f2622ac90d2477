"""A scene in space as a tree of rigid links: which joint carries each body, seen from the ground."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from derive.errors import Problem, SpecError
from derive.simulation.space.marker_frames import own_frame
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.spatial_bodies import SpatialRigidBody
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene
from derive.spec.model.specification import Specification
from derive.urdf.robot import HERE, JointKind, Placement

KINDS = {
    "revolute": JointKind.CONTINUOUS,
    "prismatic": JointKind.PRISMATIC,
    "planar": JointKind.PLANAR,
    "fixed": JointKind.FIXED,
}
"""The types of joints of a URDF, by the kinds of joints of scenes that they correspond to."""


@dataclass(frozen=True, eq=False)
class Branch:
    """A body of the tree behind the one that carries it.

    joint: what connects them; None of a free body. sign: 1 where the body is the second one of the joint, otherwise -1.
    on: the marker that carries it. frame: the frame of the link in that of the body, in which the joint is its origin.
    """

    body: SpatialRigidBody
    joint: SpatialJoint | None
    sign: int
    on: MarkerRef | None
    frame: Placement

    @property
    def carrier(self) -> str:
        """The name of the body that carries it, or of the ground."""
        return self.on.body if self.on else GROUND


def rigid_tree(spec: Specification) -> tuple[Branch, ...]:
    """The bodies of a scene, each behind the one that carries it. Raises SpecError with all that a URDF cannot have."""
    if not isinstance(spec, SpatialScene):
        raise SpecError((Problem("", "a URDF describes rigid bodies in space, and this is no scene of such"),))
    problems = list(_problems(spec))
    bodies = {body.name: body for body in spec.bodies if isinstance(body, SpatialRigidBody)}
    used: set[str] = set()
    result: list[Branch] = []
    for start in (GROUND, *bodies):
        if start in bodies and not any(branch.body.name == start for branch in result):
            result.append(Branch(bodies[start], None, 1, None, HERE))
        reached = [start] if start == GROUND or start in bodies else []
        for name in reached:  # grows at its end
            for branch in _behind(spec, bodies, name, used):
                if any(known.body.name == branch.body.name for known in result):
                    text = f"it closes a loop at the body {branch.body.name}; a URDF is a tree"
                    problems.append(Problem(f"joints.{branch.joint.name if branch.joint else ''}", text))
                    continue
                result.append(branch)
                reached.append(branch.body.name)
    if problems:
        raise SpecError(tuple(problems))
    return tuple(result)


def _behind(scene: SpatialScene, bodies: dict[str, SpatialRigidBody], name: str, used: set[str]) -> Iterator[Branch]:
    """The bodies that joints not yet used carry on a body or on the ground."""
    for joint in scene.joints:
        for on, own, sign in ((joint.first, joint.second, 1), (joint.second, joint.first, -1)):
            if joint.name not in used and joint.kind in KINDS and on.body == name and own.body in bodies:
                used.add(joint.name)
                frame = own_frame(next(m for m in bodies[own.body].markers if m.name == own.marker))
                yield Branch(bodies[own.body], joint, sign, on, Placement(frame.position, frame.axes))


def _problems(scene: SpatialScene) -> Iterator[Problem]:
    for body in scene.bodies:
        if not isinstance(body, SpatialRigidBody):
            yield Problem(f"bodies.{body.name}", "this body is flexible; the links of a URDF are rigid")
        elif (body.mass is None) != (body.inertia is None):
            yield Problem(f"bodies.{body.name}", "a link of a URDF has mass and inertia, or neither")
    for joint in scene.joints:
        if joint.kind not in KINDS:
            known = ", ".join(KINDS)
            yield Problem(f"joints.{joint.name}.kind", f"a URDF has no {joint.kind} joints; it has these: {known}")
    for drive in scene.drives:
        yield Problem(f"drives.{drive.name}", "a URDF prescribes no motion; leave the drive out")


def placement_in_link(branch: Branch, inner: Placement) -> Placement:
    """A placement in the frame of the link, of one in the frame of the body."""
    rotation = branch.frame.rotation.T
    moved = rotation @ (inner.position - branch.frame.position)
    return Placement(np.asarray(moved), np.asarray(rotation @ inner.rotation))
