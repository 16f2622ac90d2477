"""The trees of a scene in space: which joints between rigid bodies give coordinates, and which ones close loops.

A joint that removes n relative motions is n multipliers as a constraint. A spanning tree of largest total n leaves the
fewest multipliers.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush

from derive.mechanics.multibody.space.joint_elimination import SHARED
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.multibody.space.rows import DISPLACEMENTS, RELATIVE_MOTIONS, ROTATIONS
from derive.spec.model.markers import GROUND
from derive.spec.model.spatial_bodies import SpatialRigidBody
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene


@dataclass(frozen=True)
class Link:
    """A body of a tree; joint: that which gives its coordinates, None of a root, which keeps all of them."""

    body: str
    joint: SpatialJoint | None = None


def trees(scene: SpatialScene) -> tuple[Link, ...]:
    """The bodies of trees in which a body hangs on one that moves, those before others first.

    Bodies that hang on the ground or on prescribed motions alone are not among them, nor are any if the coordinates of
    the scene are absolute.
    """
    if scene.coordinates == "absolute":
        return ()
    rigid = (body for body in scene.bodies if isinstance(body, SpatialRigidBody))
    bodies = [body.name for body in rigid if body.markers and not body.keep_coordinates]
    ends = {*bodies, GROUND}
    joints = [j for j in scene.joints if {j.first.body, j.second.body} <= ends and removed_motions(j)]
    prescribed = _prescribed(joints, {drive.joint for drive in scene.drives})
    return tuple(link for group in _groups(bodies, joints, prescribed) for link in _spanning_tree(group, joints))


def supported_bodies(scene: SpatialScene) -> dict[str, str]:
    """The bodies whose coordinates are those of joints in trees, by the names of the joints."""
    return {link.joint.name: link.body for link in trees(scene) if link.joint}


def removed_motions(joint: SpatialJoint) -> int:
    """The number of relative motions that a joint removes, each of which takes a multiplier; 0 if it eliminates none."""
    joint_type = SPATIAL_JOINTS[joint.kind]
    free = joint_type.free(joint)
    if free is None or joint.closes_loop or joint.first.body == joint.second.body:
        return 0
    displacements = tuple(motion for motion in free if motion in DISPLACEMENTS)
    rotations = tuple(motion for motion in free if motion in ROTATIONS)
    shared = not displacements or not rotations or (rotations == ("rz",) and displacements in SHARED)
    if not shared:
        return 0  # along axes of the first marker, which turn against those of the second
    return len(RELATIVE_MOTIONS) - len(free) + joint_type.is_screw


def _prescribed(joints: Sequence[SpatialJoint], driven: set[str]) -> dict[str, bool]:
    """The ground and the bodies that joints hold to it or drives move, and whether they move."""
    result, waiting = {GROUND: False}, [GROUND]
    while waiting:
        at = waiting.pop()
        for joint in joints:
            ends = joint.first.body, joint.second.body
            for here, other in (ends, ends[::-1]):
                left = len(RELATIVE_MOTIONS) - removed_motions(joint)
                if here == at and other not in result and left == (joint.name in driven):
                    result[other] = result[at] or joint.name in driven
                    waiting.append(other)
    return result


def _groups(bodies: Sequence[str], joints: Sequence[SpatialJoint], prescribed: Mapping[str, bool]) -> list[list[str]]:
    """The bodies that joints connect to each other, if some of them hang on bodies that move.

    A drive that moves a body of such a group gives the body a coordinate: its drive is a constraint.
    """
    neighbours: dict[str, list[str]] = {body: [] for body in bodies}
    for joint in joints:
        ends = joint.first.body, joint.second.body
        for here, other in (ends, ends[::-1]):
            if here in neighbours and other in neighbours:
                neighbours[here].append(other)
    still = {body for body, moves in prescribed.items() if not moves}
    result, done = [], set()
    for body in bodies:
        if body in done or body in prescribed:
            continue
        group, waiting = [], [body]
        while waiting:
            at = waiting.pop()
            if at in group:
                continue
            group.append(at)
            waiting += [n for n in neighbours[at] if n not in prescribed]
        done |= {*group}
        if len(group) == 1:
            continue
        carriers = [b for b in bodies if b in prescribed and b not in still and _touches(b, group, neighbours, still)]
        result.append([b for b in bodies if b in group or b in carriers])
    return result


def _touches(body: str, group: Sequence[str], neighbours: Mapping[str, Sequence[str]], still: set[str]) -> bool:
    """Whether a body that drives move is connected to a group through such bodies."""
    seen, waiting = set(), [body]
    while waiting:
        at = waiting.pop()
        if at in group:
            return True
        if at in seen or at in still:
            continue
        seen.add(at)
        waiting += neighbours[at]
    return False


def _spanning_tree(group: Sequence[str], joints: Sequence[SpatialJoint]) -> list[Link]:
    """The links of a group, from what does not move if a joint connects it, else from its first body."""
    members = {*group}
    own = [(n, j) for n, j in enumerate(joints) if members & {j.first.body, j.second.body}]
    outside = {b for _, j in own for b in (j.first.body, j.second.body)} - members
    roots = sorted(outside) or [group[0]]
    links = [] if outside else [Link(group[0])]
    placed, frontier = {*roots}, []

    def add(body: str, depth: int) -> None:
        for number, joint in own:
            ends = joint.first.body, joint.second.body
            for here, other in (ends, ends[::-1]):
                if here == body and other in members:
                    heappush(frontier, (-removed_motions(joint), depth, number, other, joint.name))

    by_name = {joint.name: joint for _, joint in own}
    for root in roots:
        add(root, 0)
    while frontier:
        _, depth, _, other, name = heappop(frontier)
        if other in placed:
            continue
        placed.add(other)
        links.append(Link(other, by_name[name]))
        add(other, depth + 1)
    return links
