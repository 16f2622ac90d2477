"""Reading of a URDF: all faults at once, each with its line; what is not read is counted."""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Iterable
from typing import TypeVar

from derive.errors import Problem, SpecError, quoted
from derive.spec.files.xml_tree import XmlElement, read_xml
from derive.urdf.robot import Inertia, JointKind, Limits, Link, LinkShape, Mimic, Origin, Robot, RobotJoint
from derive.urdf.tree import root_of_tree

Named = TypeVar("Named", Link, RobotJoint)

READ = {
    "robot": ("link", "joint"),
    "link": ("inertial", "visual"),
    "visual": ("origin", "geometry"),
    "joint": ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic"),
    "inertial": ("origin", "mass", "inertia"),
}
"""The elements that are read, by the tag around them."""

SHAPES = ("visual", "collision")
"""The elements that describe the shapes of a link."""

SEVERAL = ("link", "joint", *SHAPES)
"""The elements that are read of which there may be more than one."""

RIGHT_ANGLE = math.pi / 2
ROUNDED_ANGLE = 1e-8
"""The largest difference, rad, from a multiple of a right angle that counts as rounding, as in 1.57079632679."""

TENSOR = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def read_robot(path: str | os.PathLike[str], keep_angles: bool = False) -> Robot:
    """The robot of a URDF file. Raises SpecError with all faults of the file and their lines.

    keep_angles: take angles such as 1.57079632679 as they are written, and not for the right angles that they round.
    """
    return robot_of(read_xml(path), os.fsdecode(path), keep_angles)


def robot_of(root: XmlElement, source: str | None = None, keep_angles: bool = False) -> Robot:
    """The robot of an XML tree, as of `read_robot`; `source` is the file that errors show. Raises SpecError."""
    if root.tag != "robot":
        message = f"a URDF is needed, whose outermost element is <robot>, not <{root.tag[:40]}>"
        raise SpecError((Problem("", message, root.line),), source)
    reader = _Reader(keep_angles)
    name = reader.text(root, "name", "robot")
    links = reader.by_name(reader.link(e) for e in root.all("link"))
    joints = reader.by_name(reader.joint(e) for e in root.all("joint"))
    macros = any(e.tag in ("xacro:property", "xacro:macro") for e in root.children)
    if macros or any(mark in name for name in (*links, *joints) for mark in ("${", "$(")):
        reader.fault(root, "", "these are macros of xacro; write their result to a file first: xacro FILE > robot.urdf")
    if not links:
        reader.fault(root, "", "there is no <link>")
    reader.check_counts(root)
    tree_root = root_of_tree(links, joints, reader.problems)
    if reader.problems:
        raise SpecError(tuple(sorted(reader.problems, key=lambda p: p.line or 0)), source)
    return Robot(name, tree_root, links, joints, dict(sorted(_unread(root).items())), tuple(reader.roundings))


class _Reader:
    """Reads elements and collects their faults; what cannot be read is replaced, so that reading goes on."""

    def __init__(self, keep_angles: bool) -> None:
        self.keep_angles = keep_angles
        self.problems: list[Problem] = []
        self.roundings: list[float] = []

    def fault(self, element: XmlElement, path: str, message: str) -> None:
        """Note a fault at the line of an element."""
        self.problems.append(Problem(path, message, element.line))

    def check_counts(self, around: XmlElement) -> None:
        """Note elements of which only the first would be read."""
        tags = set[str]()
        for element in around.children:
            if element.tag in READ.get(around.tag, ()):
                if element.tag in tags and element.tag not in SEVERAL:
                    self.fault(
                        element, "", f"a second <{element.tag}> in the <{around.tag}> of line {around.line}; remove one"
                    )
                tags.add(element.tag)
                self.check_counts(element)

    def text(self, element: XmlElement, attribute: str, path: str) -> str:
        """An attribute that is required."""
        value = element.attributes.get(attribute, "").strip()
        if not value:
            self.fault(element, path, f'<{element.tag}> needs {attribute}="..."')
        return value

    def numbers(self, text: str, count: int, element: XmlElement, path: str) -> list[float]:
        """So many finite numbers of a text with blanks between them; zeros after a fault."""
        try:
            values = [float(part) for part in text.split()]
        except ValueError:
            values = []
        if len(values) != count or not all(map(math.isfinite, values)):
            number = "a number" if count == 1 else f"{count} numbers"
            self.fault(element, path, f"{number} needed, not {quoted(text)}")
            return [0.0] * count
        return values

    def number(self, element: XmlElement | None, attribute: str, path: str, default: float | None) -> float | None:
        """An attribute that is a number; `default` where it is not given."""
        if element is None or attribute not in element.attributes:
            return default
        return self.numbers(element.attributes[attribute], 1, element, f"{path}.{element.tag}.{attribute}")[0]

    def triple(
        self, element: XmlElement | None, attribute: str, path: str, default: tuple[float, float, float]
    ) -> tuple[float, float, float]:
        """An attribute of three numbers; `default` where it is not given."""
        if element is None or attribute not in element.attributes:
            return default
        x, y, z = self.numbers(element.attributes[attribute], 3, element, f"{path}.{element.tag}.{attribute}")
        return x, y, z

    def origin(self, element: XmlElement, path: str) -> Origin:
        """The placement of a joint or of a centre of mass."""
        origin = element.first("origin")
        xyz, (roll, pitch, yaw) = (self.triple(origin, key, path, (0.0, 0.0, 0.0)) for key in ("xyz", "rpy"))
        return Origin(xyz, (self.angle(roll), self.angle(pitch), self.angle(yaw)))

    def angle(self, value: float) -> float:
        """An angle, or the multiple of a right angle that it rounds."""
        right = round(value / RIGHT_ANGLE) * RIGHT_ANGLE
        difference = abs(value - right)
        if self.keep_angles or not 0 < difference <= ROUNDED_ANGLE:
            return value
        self.roundings.append(difference)
        return right

    def by_name(self, elements: Iterable[Named]) -> dict[str, Named]:
        """Links or joints by their names, which have to be different."""
        result: dict[str, Named] = {}
        for element in elements:
            if element.name in result:
                kind = "link" if isinstance(element, Link) else "joint"
                message = f"there is a {kind} of this name in line {result[element.name].line} already"
                self.problems.append(Problem(f"{kind} {element.name}", message, element.line))
            result[element.name] = element
        return result

    def link(self, element: XmlElement) -> Link:
        """A link; without <inertial> it is a frame alone."""
        name = self.text(element, "name", "link")
        inertial = element.first("inertial")
        visuals, collisions = (
            tuple(self.shape(shape, f"link {name}.{tag}") for shape in element.all(tag)) for tag in SHAPES
        )
        own = self.inertia(inertial, f"link {name}") if inertial else None
        return Link(name, own, element.line, visuals, collisions)

    def shape(self, element: XmlElement, path: str) -> LinkShape:
        """A shape for pictures or for collisions."""
        geometry = element.first("geometry")
        form = geometry.children[0] if geometry and geometry.children else None
        tag, attributes = (form.tag, form.attributes) if form else ("", {})
        return LinkShape(self.origin(element, path), tag, attributes, element.line)

    def inertia(self, element: XmlElement, path: str) -> Inertia | None:
        """Mass, centre and tensor; None where all are zero."""
        mass, tensor = element.first("mass"), element.first("inertia")
        if mass is None or tensor is None:
            self.fault(element, path, "<inertial> needs <mass value=...> and <inertia ixx=... iyy=... izz=...>")
            return None
        self.text(mass, "value", path)
        value = self.number(mass, "value", path, 0.0) or 0.0
        for key in ("ixx", "iyy", "izz"):
            self.text(tensor, key, path)
        entries = [self.number(tensor, key, path, 0.0) or 0.0 for key in TENSOR]
        if value < 0:
            self.fault(mass, f"{path}.mass", f"the mass is {value:g} kg; masses are not negative")
        if value == 0 and not any(entries):
            return None
        xx, xy, xz, yy, yz, zz = entries
        return Inertia(self.origin(element, path), value, (xx, xy, xz, yy, yz, zz))

    def joint(self, element: XmlElement) -> RobotJoint:
        """A joint of any type."""
        name, given = self.text(element, "name", "joint"), self.text(element, "type", "joint")
        path = f"joint {name}"
        kinds = {kind.value: kind for kind in JointKind}
        if given and given not in kinds:
            self.fault(element, path, f"the type is one of {', '.join(kinds)}, not {quoted(given)}")
        kind = kinds.get(given, JointKind.FIXED)
        parent, child = (self.of_link(element, tag, path) for tag in ("parent", "child"))
        known = len(self.problems)
        axis = self.triple(element.first("axis"), "xyz", path, (1.0, 0.0, 0.0))
        if not any(axis) and len(self.problems) == known and kind not in (JointKind.FIXED, JointKind.FLOATING):
            self.fault(element.first("axis") or element, f"{path}.axis", "the axis has no direction")
            axis = (1.0, 0.0, 0.0)
        limit, dynamics = element.first("limit"), element.first("dynamics")
        keys = ("lower", "upper", "effort", "velocity")
        limits = Limits(*(self.number(limit, key, path, None) for key in keys)) if limit else None
        if limits and limits.lower is not None and limits.upper is not None and limits.lower > limits.upper:
            self.fault(limit or element, f"{path}.limit", "lower is above upper; exchange the two")
        damping, friction = (self.number(dynamics, key, path, 0.0) or 0.0 for key in ("damping", "friction"))
        if damping < 0:
            self.fault(dynamics or element, f"{path}.damping", f"damping is not negative, and this is {damping:g}")
        mimic = element.first("mimic")
        return RobotJoint(
            name, kind, parent, child, self.origin(element, path), axis, limits, damping, friction,
            self.mimic(mimic, path) if mimic else None, element.line,
        )  # fmt: skip

    def mimic(self, element: XmlElement, path: str) -> Mimic:
        """The joint that is followed, with the ratio and the offset."""
        multiplier, offset = self.number(element, "multiplier", path, 1.0), self.number(element, "offset", path, 0.0)
        return Mimic(self.text(element, "joint", path), 1.0 if multiplier is None else multiplier, offset or 0.0)

    def of_link(self, element: XmlElement, tag: str, path: str) -> str:
        """The name of the parent or the child of a joint."""
        inner = element.first(tag)
        if inner is None:
            self.fault(element, path, f'a joint needs <{tag} link="..."/>')
            return ""
        return self.text(inner, "link", path)


def _unread(root: XmlElement) -> Counter[str]:
    """The tags directly inside of elements that are read which are not read themselves, with the number of each."""
    counts: Counter[str] = Counter()
    for child in root.children:
        if child.tag in READ.get(root.tag, ()):
            counts += _unread(child)
        elif root.tag in READ:
            counts[child.tag] += 1
    return counts
