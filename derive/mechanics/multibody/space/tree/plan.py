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

MOST_BODIES = 60
"""The largest number of bodies in trees that have relative coordinates if the specification leaves the choice."""


@dataclass(frozen=True)
class PlannedLink:
    """A body of a tree; joint: that which gives its coordinates, to the body or the ground `parent`.

    A root without joint keeps all coordinates.
    """

    body: str
    joint: SpatialJoint | None = None
    parent: str = ""


def trees(scene: SpatialScene) -> tuple[PlannedLink, ...]:
    """The bodies of trees in which a body hangs on one that moves, those before others first.

    Bodies that hang on the ground or on prescribed motions alone are not among them, nor are any if the coordinates of
    the scene are absolute.
    """
    if scene.coordinates == "absolute" or (scene.coordinates == "auto" and scene.lowering == "instances"):
        return ()
    links = _trees(scene)
    return links if scene.coordinates == "relative" or len(links) <= MOST_BODIES else ()


def _trees(scene: SpatialScene) -> tuple[PlannedLink, ...]:
    rigid = (body for body in scene.bodies if isinstance(body, SpatialRigidBody))
    bodies = [body.name for body in rigid if body.markers and not body.keep_coordinates]
    ends = {*bodies, GROUND}
    joints = [j for j in scene.joints if {j.first.body, j.second.body} <= ends and removed_motions(j)]
    prescribed = _prescribed(joints, {drive.joint for drive in scene.drives})
    groups = _groups(bodies, joints, prescribed)
    return tuple(link for group in groups for link in _carried(_links(group, joints, prescribed), prescribed))


def supported_bodies(scene: SpatialScene) -> dict[str, str]:
    """The bodies whose coordinates are those of joints in trees, by the names of the joints."""
    return {link.joint.name: link.body for link in trees(scene) if link.joint}


def removed_motions(joint: SpatialJoint) -> int:
    """The number of relative motions that a joint removes, each of which takes a multiplier; 0 if it has to be one."""
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
    """The bodies whose motion is not prescribed and that joints connect to each other, two or more."""
    neighbours: dict[str, list[str]] = {body: [] for body in bodies if body not in prescribed}
    for joint in joints:
        ends = joint.first.body, joint.second.body
        for here, other in (ends, ends[::-1]):
            if here in neighbours and other in neighbours:
                neighbours[here].append(other)
    result, done = [], set[str]()
    for body in neighbours:
        group, waiting = [], [body]
        while waiting:
            if (at := waiting.pop()) not in done:
                done.add(at)
                group.append(at)
                waiting += neighbours[at]
        if len(group) > 1:
            result.append([b for b in bodies if b in group])
    return result


def _links(group: Sequence[str], joints: Sequence[SpatialJoint], prescribed: Mapping[str, bool]) -> list[PlannedLink]:
    """The links of a group.

    The mass matrix would depend on the time where a body hangs on one behind a motion that drives prescribe. The bodies
    that these drives move are then links too, with coordinates, and the drives are constraints.
    """
    members = [*group]
    while True:
        links = _spanning_tree(members, joints)
        parents = {link.body: link.parent for link in links if link.joint}
        behind = {parents[of] for of in parents.values() if of in parents}
        driven = [body for body, moves in prescribed.items() if moves and body in behind and body not in members]
        if not driven:
            return links
        members = [*driven, *members]


def _carried(links: Sequence[PlannedLink], prescribed: Mapping[str, bool]) -> list[PlannedLink]:
    """The links but for those that carry nothing and hang on what is prescribed."""
    carriers = {link.parent for link in links}
    return [link for link in links if link.body in carriers or (link.parent and link.parent not in prescribed)]


def _spanning_tree(members: Sequence[str], joints: Sequence[SpatialJoint]) -> list[PlannedLink]:
    """The links of bodies, from what is prescribed if a joint connects it, else from the first of them.

    Of joints that remove equally many motions those nearer to the root come first, so that trees are not deep.
    """
    own = [(number, j) for number, j in enumerate(joints) if {*members} & {j.first.body, j.second.body}]
    by_name = {joint.name: joint for _, joint in own}
    roots = sorted({body for _, j in own for body in (j.first.body, j.second.body)} - {*members})
    links = [] if roots else [PlannedLink(members[0])]
    placed = {*(roots or members[:1])}
    frontier: list[tuple[int, int, int, str, str, str]] = []

    def add(body: str, depth: int) -> None:
        for number, joint in own:
            ends = joint.first.body, joint.second.body
            for here, other in (ends, ends[::-1]):
                if here == body and other in members:
                    heappush(frontier, (-removed_motions(joint), depth, number, here, other, joint.name))

    for root in sorted(placed):
        add(root, 0)
    while frontier:
        _, depth, _, parent, other, name = heappop(frontier)
        if other not in placed:
            placed.add(other)
            links.append(PlannedLink(other, by_name[name], parent))
            add(other, depth + 1)
    return links
