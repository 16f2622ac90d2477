"""The specification of a robot: a scene in space of rigid bodies as TOML, with notes on what its URDF has besides."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from derive.errors import Problem, SpecError, printable, quoted
from derive.short_text import counted
from derive.spec.checks.name_clashes import OWN_MARKERS
from derive.spec.model.instances import identifier
from derive.spec.model.markers import GROUND
from derive.spec.parsing.names import free_name
from derive.urdf.body_masses import BodyMasses
from derive.urdf.left_out import left_out
from derive.urdf.rigid_bodies import LinkPart, RobotBody, joints_on, rigid_bodies
from derive.urdf.robot import HERE, JointKind, Placement, Robot, RobotJoint
from derive.urdf.texts import axes_along, axes_text, frame_text, list_text, number_text
from derive.urdf.visuals import WrittenVisuals

Base = Literal["fixed", "free"]
"""How the root of a robot is held: fixed to the ground, or free."""

KINDS = {
    JointKind.REVOLUTE: "revolute",
    JointKind.CONTINUOUS: "revolute",
    JointKind.PRISMATIC: "prismatic",
    JointKind.PLANAR: "planar",
}
"""The kinds of joints in scenes; bodies behind floating joints have none."""

OWN_MARKER = "joint"
"""The marker at which the joint that moves a body acts on it."""


@dataclass(frozen=True)
class WrittenScene:
    """The TOML text of a scene, its size in words, and lines on what is left out of the robot, renamed or fixed."""

    name: str
    doc: str
    text: str
    notes: tuple[str, ...]


def written_scene(
    robot: Robot,
    base: Base = "fixed",
    source: str | None = None,
    folder: str | os.PathLike[str] = ".",
    repair_inertia: bool = False,
) -> WrittenScene:
    """The scene of a robot whose root is fixed to the ground or free.

    The frame of a body is that of its first link; a body consists of the links that fixed joints connect. The z axis of
    the markers of a joint is its axis. Each joint with a single motion has an input, its torque or force, and an
    output, its position. `source` is the file that errors show, beside which meshes are; `folder` is that of the
    specification, to which their paths are relative. With `repair_inertia`, a tensor of inertia that no body has is
    replaced by the nearest one, with a note. Raises SpecError where a body moves without mass or has such a tensor.
    """
    return _Writer(robot, base, source, Path(folder), repair_inertia).scene()


class _Writer:
    """Collects the tables of a scene and the notes on them."""

    def __init__(self, robot: Robot, base: Base, source: str | None, folder: Path, repair_inertia: bool) -> None:
        self.robot, self.base, self.source = robot, base, source
        self.visuals = WrittenVisuals(Path(source or ".").parent, folder)
        self.bodies = rigid_bodies(robot)
        self.masses = BodyMasses(robot, self.bodies, repair_inertia)
        self.locked = robot.locked
        self.notes: list[str] = []
        self.taken: set[str] = {"ground", "scene"}
        self.renamed: list[str] = []
        self.links = {body.name: self.name(body.name) for body in self.bodies[self.held :]}
        self.joints = {body.joint.name: self.name(body.joint.name) for body in self.bodies if body.joint}
        self.carriers = {part.link.name: (body, part) for body in self.bodies for part in body.parts}
        self.taken_by_markers: set[str] = set()
        self.first_markers = {
            joint.name: self.marker_name(body, self.joints[joint.name])
            for body in self.bodies
            for joint, _ in joints_on(self.robot, body)
        }

    @property
    def held(self) -> int:
        """The number of bodies that are part of the ground."""
        return int(self.base == "fixed")

    def name(self, text: str) -> str:
        """A name that scenes allow and no other element has."""
        name = free_name(text, self.taken)
        self.taken.add(name.lower())
        if name != text:
            self.renamed.append(f"{quoted(text)} -> {name}")
        return name

    def scene_name(self, body: RobotBody) -> str:
        """The name by which markers of a body are referred to."""
        return self.links.get(body.name, GROUND)

    def marker_name(self, body: RobotBody, text: str) -> str:
        """A name that no other marker has, also not together with the name of its body."""
        owner = self.scene_name(body)
        name, taken = text, {*OWN_MARKERS, OWN_MARKER}
        while identifier(owner, name := free_name(text, taken)).lower() in self.taken_by_markers:
            taken.add(name.lower())
        self.taken_by_markers.add(identifier(owner, name).lower())
        return name

    def scene(self) -> WrittenScene:
        """All tables, in the order of a specification."""
        self.check_masses()
        name = self.name(self.robot.name)
        tables = [*self.ground(), *self.body_tables(), *self.joint_tables(), *self.ports()]
        if self.renamed:
            self.notes.append(f"renamed: {', '.join(self.renamed)}")
        self.notes += self.visuals.notes()
        self.notes += left_out(self.robot, [body.joint for body in self.bodies if body.joint])
        head = [
            f"# The robot {printable(self.robot.name)}, written by `tisserand import`.",
            *(f"# {note}" for note in self.notes),
            f'name = "{name}"',
            "",
            "[scene]",
            "gravity = [0, 0, -9.81]",
            'coordinates = "relative"',
            "",
        ]
        tail = ["[simulation]", "duration = 1", "output = 0.01", ""]
        moving = counted(len(self.bodies) - self.held, "moving body", "moving bodies")
        doc = f"{moving} of {counted(len(self.robot.links), 'link')}, {counted(len(self.joints), 'joint')}"
        return WrittenScene(name, doc, "\n".join([*head, *tables, *tail]), tuple(self.notes))

    def check_masses(self) -> None:
        """Refuse bodies that no scene can have, and scenes without any."""
        problems = list(self.masses.problems(self.bodies[self.held :]))
        if len(self.bodies) == self.held:
            text = "nothing moves: all links are fixed to the root, and this to the ground; import it with --base free"
            problems.append(Problem("", text))
        if problems:
            raise SpecError(tuple(problems), self.source)
        self.notes += self.masses.notes

    def ground(self) -> Iterator[str]:
        """The markers of the ground: what the fixed root carries."""
        if not self.held:
            return
        root = self.bodies[0]
        if root.mass:
            self.notes.append(
                f"{_heavy(root)} ({root.mass:g} kg) is fixed to the ground, so that its mass has no effect; "
                "import with --base free if it moves"
            )
        if shapes := self.visuals.lines(root):
            yield from ["[ground]", *shapes, ""]
        yield from ["[ground.markers]", *self.markers(root), ""]

    def markers(self, body: RobotBody) -> Iterator[str]:
        """The markers of a body as lines of a table: of the joint that moves it, of those on it, and of its links."""
        if body.joint and body.joint.kind is not JointKind.FLOATING:
            yield f"{OWN_MARKER} = {frame_text(HERE, axes_along(body.joint.direction))}"
        for joint, part in joints_on(self.robot, body):
            if joint.kind is not JointKind.FLOATING:
                yield f"{self.first_markers[joint.name]} = {_frame_of_joint(joint, part)}"
        for part in body.parts[1:]:
            yield f"{self.marker_name(body, part.link.name)} = {frame_text(part.placement, np.eye(3))}"

    def body_tables(self) -> Iterator[str]:
        """The bodies that move."""
        for body in self.bodies[self.held :]:
            name, tensor = self.links[body.name], self.masses.tensor(body)
            (xx, xy, xz), (_, yy, yz), (_, _, zz) = tensor
            if len(body.parts) > 1 and "," in _heavy(body):
                yield f"# one body: {_heavy(body)}"
            yield f"[bodies.{name}]" + ("" if body.mass else "  # without mass of its own")
            if body.mass:
                yield f"mass = {number_text(body.mass)}"
                yield f"centre = {list_text(body.centre)}"
                yield f"inertia = {list_text((xx, yy, zz, xy, xz, yz))}"
            if body.joint is None or body.joint.kind is JointKind.FLOATING:
                yield f"start = {self.start(body)}"
            yield from self.visuals.lines(body)
            markers = list(self.markers(body))
            yield from ["", *([f"[bodies.{name}.markers]", *markers, ""] if markers else [])]

    def start(self, body: RobotBody) -> str:
        """Where a free body is while all joints are in their zero positions."""
        placement = self.zero_position(body)
        return f"{{ position = {list_text(placement.position)}, rotation = {axes_text(placement.rotation)} }}"

    def zero_position(self, body: RobotBody) -> Placement:
        """The placement of a body in the frame of the root while all joints are in their zero positions."""
        if body.joint is None:
            return HERE
        carrier, part = self.carriers[body.joint.parent]
        return self.zero_position(carrier).of(part.placement).of(body.joint.origin.placement)

    def joint_tables(self) -> Iterator[str]:
        """Joints, dampers and what makes a joint follow another one."""
        for body in self.bodies:
            joint = body.joint
            if joint is None or joint.kind is JointKind.FLOATING:
                continue
            name = self.joints[joint.name]
            yield from [f"[joints.{name}]", f'kind = "{KINDS[joint.kind]}"', f"between = {self.between(body)}"]
            yield from self.limits(joint)
            if joint.kind.has_one_motion and not joint.mimic:
                yield f"start = {{ {'angle' if joint.kind.turns else 'displacement'} = 0 }}"
            yield ""
            if joint.damping and joint.kind.has_one_motion:
                yield from self.damper(joint, body)
        for joint in self.robot.joints.values():
            if joint.mimic and joint.name not in self.locked:
                leader, follower = self.joints[joint.mimic.joint], self.joints[joint.name]
                yield from [
                    f"[gears.{self.name(f'{follower}_follows')}]",
                    f'joints = ["{leader}", "{follower}"]',
                    f"ratio = {number_text(joint.mimic.multiplier)}",
                    *([f"offset = {number_text(joint.mimic.offset)}"] if joint.mimic.offset else []),
                    "",
                ]

    def between(self, body: RobotBody) -> str:
        """The two markers of the joint that moves a body."""
        assert body.joint
        carrier, _ = self.carriers[body.joint.parent]
        first = f"{self.scene_name(carrier)}.{self.first_markers[body.joint.name]}"
        return f'["{first}", "{self.links[body.name]}.{OWN_MARKER}"]'

    def damper(self, joint: RobotJoint, body: RobotBody) -> Iterator[str]:
        """The viscous damping of a joint."""
        yield f"[springs.{self.name(f'{self.joints[joint.name]}_damping')}]"
        if joint.kind.turns:
            yield from ['kind = "rotational"', "stiffness = 0", f"damping = {number_text(joint.damping)}"]
        else:
            yield from ['kind = "bushing"', f"stiffness = {list_text([0] * 6)}"]
            yield f"damping = {list_text([0, 0, joint.damping, 0, 0, 0])}"
        yield from [f"between = {self.between(body)}", ""]

    def limits(self, joint: RobotJoint) -> Iterator[str]:
        """The limits of a joint with one motion: of its position as a key, of effort and speed as a comment."""
        limits, (unit, effort) = joint.limits, ("rad", "N m") if joint.kind.turns else ("m", "N")
        if limits is None or not joint.kind.has_one_motion:
            return
        others = [(limits.effort, effort), (limits.velocity, f"{unit}/s")]
        comment = ", ".join(f"{value:g} {of}" for value, of in others if value)
        if joint.kind is JointKind.CONTINUOUS or (limits.lower is None and limits.upper is None):
            if comment:
                yield f"# limits: {comment}"
        else:
            yield f"limits = {list_text((limits.lower or 0, limits.upper or 0))}{f'  # {comment}' if comment else ''}"

    def ports(self) -> Iterator[str]:
        """An input for each joint with one motion that does not follow another one, and an output, its position."""
        moved = [b.joint for b in self.bodies if b.joint and b.joint.kind.has_one_motion]
        for joint in moved:
            if joint.mimic:
                continue
            name, load = self.joints[joint.name], "torque" if joint.kind.turns else "force"
            port = self.name(f"{load}_{name}")
            yield from [f"[inputs.{port}]", "value = 0", "", f"[{load}s.{self.name(f'{name}_motor')}]"]
            yield from [f'joint = "{name}"', f'value = {{ input = "{port}" }}', ""]
        for joint in moved:
            name = self.joints[joint.name]
            yield from [f"[outputs.{self.name(f'q_{name}')}]", 'kind = "joint"', f'joint = "{name}"', ""]


def _heavy(body: RobotBody) -> str:
    """The links of a body that have mass."""
    return ", ".join(printable(part.link.name) for part in body.parts if part.link.inertia)


def _frame_of_joint(joint: RobotJoint, part: LinkPart) -> str:
    """The marker of a joint on the body that carries it, by the angles of the robot where no others are added."""
    axes = axes_along(joint.direction)
    exact = np.isin(joint.origin.placement.rotation, (-1, 0, 1)).all()  # as axes, of which no digit is rounded
    if part.placement is HERE and not exact and np.array_equal(axes, np.eye(3)):
        roll, pitch, yaw = joint.origin.rpy
        angles = f'{{ angles = {list_text((yaw, pitch, roll))}, sequence = "zyx" }}'
        return f"{{ at = {list_text(joint.origin.xyz)}, rotation = {angles} }}"
    return frame_text(part.placement.of(joint.origin.placement), axes)
