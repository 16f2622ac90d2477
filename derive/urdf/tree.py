"""The links of a robot as a tree: one root, one parent of each other link, and no cycles."""

from __future__ import annotations

from collections.abc import Mapping

from derive.errors import Problem, quoted
from derive.spec.parsing.faults import did_you_mean
from derive.urdf.robot import JointKind, Link, RobotJoint


def root_of_tree(links: Mapping[str, Link], joints: Mapping[str, RobotJoint], problems: list[Problem]) -> str:
    """The root of the tree; what makes it none goes to `problems`."""
    before = len(problems)
    above: dict[str, RobotJoint] = {}
    for joint in joints.values():
        path = f"joint {joint.name}"
        problems += (
            Problem(path, f"there is no link {quoted(name)}{did_you_mean(name, links)}", joint.line)
            for name in (joint.parent, joint.child)
            if name and name not in links
        )
        if joint.child in above:
            other = above[joint.child]
            message = (
                f"link {quoted(joint.child)} has a parent already, by joint {quoted(other.name)} in line {other.line}; "
                "a URDF is a tree, and closes no loops: add the joint that closes one to the specification"
            )
            problems.append(Problem(path, message, joint.line))
        above.setdefault(joint.child, joint)
    _check_mimics(joints, problems)
    roots = [name for name in links if name not in above]
    if len(roots) > 1:
        first, *others = roots
        text = f"a second root beside link {quoted(first)}; a joint has to connect them"
        problems += (Problem(f"link {name}", text, links[name].line) for name in others)
    if len(problems) == before:
        _check_cycles(links, above, problems)
    return roots[0] if roots else ""


def _check_cycles(links: Mapping[str, Link], above: Mapping[str, RobotJoint], problems: list[Problem]) -> None:
    known: set[str] = set()
    for start in links:
        way: list[str] = []
        name: str | None = start
        while name is not None and name not in known and name not in way:
            way.append(name)
            name = above[name].parent if name in above else None
        if name in way:
            cycle = [*way[way.index(name) :], name]
            message = f"the links {' -> '.join(map(quoted, reversed(cycle)))} make a cycle; a URDF is a tree"
            problems.append(Problem(f"link {name}", message, links[name].line))
        known.update(way)


def _check_mimics(joints: Mapping[str, RobotJoint], problems: list[Problem]) -> None:
    for name, joint in joints.items():
        if joint.mimic is None:
            continue
        path, leader = f"joint {joint.name}.mimic", joints.get(joint.mimic.joint)
        if leader is None:
            hint = did_you_mean(joint.mimic.joint, joints)
            problems.append(Problem(path, f"there is no joint {quoted(joint.mimic.joint)}{hint}", joint.line))
        elif name in _followed(joints, leader):
            problems.append(Problem(path, "the joint follows itself", joint.line))
        elif any(j.kind in (JointKind.FLOATING, JointKind.PLANAR) for j in (joint, leader)):
            kinds = f"these are {leader.kind.value} and {joint.kind.value}"
            problems.append(Problem(path, f"joints with several motions do not follow each other: {kinds}", joint.line))


def _followed(joints: Mapping[str, RobotJoint], joint: RobotJoint) -> set[str]:
    """The joint, that which it follows, that which this one follows, and so on."""
    names: set[str] = set()
    following: RobotJoint | None = joint
    while following is not None and following.name not in names:
        names.add(following.name)
        following = joints.get(following.mimic.joint) if following.mimic else None
    return names
