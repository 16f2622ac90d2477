"""Descriptions of robots of others, and of chains of revolute bodies, as one URDF that all makers read.

Shapes, damping, friction and mimics are left out, since only some makers know them; joints may be locked. The root of a
robot with a free base hangs on the link `world` by a floating joint, which all read alike. Chains have random bodies,
each with a frame at its joint; their tables for C by hand come from the same numbers.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from derive.spec.model.markers import MarkerRef
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.toml.read import parse
from derive.urdf.read import read_robot
from derive.urdf.written_scene import written_scene

Array = NDArray[np.float64]

PACKAGE, FOLDER = "example-robot-data", "cmeel.prefix/share/example-robot-data/robots"
NOT_ALIKE = {"link": ("visual", "collision"), "joint": ("dynamics", "mimic", "limit", "safety_controller")}
"""The elements within links and joints that not all makers read, or not all alike."""


@dataclass(frozen=True)
class Robot:
    """A robot of the package: its file, whether its base is free, and the joints that are locked."""

    file: str
    free: bool = False
    locked: tuple[str, ...] = ()


ROBOTS = {
    "ur5": Robot("ur_description/urdf/ur5_robot.urdf"),
    "panda": Robot("panda_description/urdf/panda.urdf", locked=("panda_finger_joint1", "panda_finger_joint2")),
    "solo12": Robot("solo_description/robots/solo12.urdf", free=True),
    "anymal": Robot("anymal_b_simple_description/robots/anymal.urdf", free=True),
    "simple_humanoid": Robot("simple_humanoid_description/urdf/simple_humanoid.urdf", free=True),
    "talos": Robot("talos_data/robots/talos_reduced.urdf", free=True),
    "centauro": Robot("centauro_description/urdf/centauro.urdf", free=True),
}


def robot_text(name: str, robot: Robot) -> str:
    """The URDF of a robot of the package. Raises PackageNotFoundError without it."""
    root = ET.parse(package_file(robot.file)).getroot()
    root.set("name", name)
    for child in list(root):
        if child.tag not in NOT_ALIKE:
            root.remove(child)
        for tag in NOT_ALIKE.get(child.tag, ()):
            for part in child.findall(tag):
                child.remove(part)
        if child.tag == "joint":
            _simplify(child, robot.locked)
    if robot.free:
        children = {joint.find("child").get("link") for joint in root.iter("joint")}  # type: ignore[union-attr]
        first = next(link.get("name", "") for link in root.iter("link") if link.get("name") not in children)
        ET.SubElement(root, "link", name="world")
        base = ET.SubElement(root, "joint", name="base", type="floating")
        ET.SubElement(base, "parent", link="world")
        ET.SubElement(base, "child", link=first)
    return ET.tostring(root, encoding="unicode")


def _simplify(joint: ET.Element, locked: Sequence[str]) -> None:
    """Lock a joint, or let it turn by an angle without limits, of which a URDF needs some."""
    kind = joint.get("type", "")
    if joint.get("name") in locked:
        joint.set("type", "fixed")
    elif kind in ("revolute", "continuous", "prismatic"):
        joint.set("type", "revolute" if kind == "continuous" else kind)
        ET.SubElement(joint, "limit", lower="-9", upper="9", effort="9e9", velocity="9e9")


def package_file(name: str) -> Path:
    """A file of the package of robots."""
    return Path(str(distribution(PACKAGE).locate_file(f"{FOLDER}/{name}")))


def has_robots() -> bool:
    """Whether the package of robots is installed."""
    try:
        return package_file(ROBOTS["ur5"].file).exists()
    except PackageNotFoundError:
        return False


@dataclass(frozen=True, eq=False)
class ChainBody:
    """A body of a chain in the frame at its joint: mass, centre, inertia about that, and the frame of the next joint.

    turn: the axes of the frame of the next joint as columns.
    """

    mass: float
    centre: Array
    inertia: Array
    place: Array
    turn: Array


def chain_bodies(count: int) -> list[ChainBody]:
    """Bodies with random numbers, those of the chains by which the C by hand has been tested."""
    rng, bodies = np.random.default_rng(count), []
    for _ in range(count):
        mass, centre, factor = rng.uniform(0.5, 2), rng.normal(size=3) * 0.3, rng.normal(size=(3, 3))
        inertia, place = 0.05 * (factor @ factor.T + 3 * np.eye(3)), rng.normal(size=3) * 0.4
        inertia = 0.5 * np.trace(inertia) * np.eye(3) - 0.5 * inertia  # that of a body: no moment exceeds the others
        turn = Rotation.from_rotvec(rng.normal(size=3)).as_matrix()
        bodies.append(ChainBody(mass, centre, inertia, place, turn))
    return bodies


def chain_text(count: int) -> str:
    """The URDF of a chain whose first joint is at the origin of the ground."""
    root = ET.Element("robot", name=f"chain_{count}")
    ET.SubElement(root, "link", name="ground_link")
    parent, place, turn = "ground_link", np.zeros(3), np.eye(3)
    for i, body in enumerate(chain_bodies(count)):
        link = ET.SubElement(root, "link", name=f"link{i}")
        inertial = ET.SubElement(link, "inertial")
        ET.SubElement(inertial, "origin", xyz=_numbers(body.centre))
        ET.SubElement(inertial, "mass", value=repr(float(body.mass)))
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = (map(repr, row) for row in body.inertia.tolist())
        ET.SubElement(inertial, "inertia", ixx=xx, ixy=xy, ixz=xz, iyy=yy, iyz=yz, izz=zz)
        joint = ET.SubElement(root, "joint", name=f"joint{i}", type="revolute")
        angles = Rotation.from_matrix(turn).as_euler("xyz")
        ET.SubElement(joint, "origin", xyz=_numbers(place), rpy=_numbers(angles))
        ET.SubElement(joint, "parent", link=parent)
        ET.SubElement(joint, "child", link=f"link{i}")
        ET.SubElement(joint, "axis", xyz="0 0 1")
        _simplify(joint, ())
        parent, place, turn = f"link{i}", body.place, body.turn
    return ET.tostring(root, encoding="unicode")


def chain_tables(count: int) -> Array:
    """The tables of the C by hand: inertia about the joint, axes in the frame before, mass times centre, next joint."""
    tables, turn = [], np.eye(3)
    for body in chain_bodies(count):
        skew = np.cross(body.centre, np.eye(3)).T  # skew @ x is the vector product of the centre and x
        mixed = body.mass * skew
        inertia = np.block([[body.mass * np.eye(3), -mixed], [mixed, body.inertia - mixed @ skew]])
        rows = np.zeros((6, 8))
        rows[:, :3], rows[:, 4:7] = inertia[:, :3], inertia[:, 3:]
        axes = np.hstack([turn, np.zeros((3, 1))])
        tables += [rows.ravel(), axes.ravel(), [*body.mass * body.centre, 0, *body.place, 0]]
        turn = body.turn
    return np.concatenate(tables)


def scene_of(case: str, folder: Path, coordinates: str) -> tuple[Path, SpatialScene]:
    """The description of a case, and its scene: without markers at which no joint acts; chains without inputs."""
    chain = case.startswith("chain_")
    path = folder / f"{case}.urdf"
    path.write_text(chain_text(chain_count(case)) if chain else robot_text(case, ROBOTS[case]))
    scene = parse(written_scene(read_robot(path, keep_angles=True), "fixed").text)  # no maker rounds angles
    assert isinstance(scene, SpatialScene)
    if chain:
        scene = replace(scene, inputs=(), torques=())
    acted_on = {end for joint in scene.joints for end in (joint.first, joint.second)}
    bodies = tuple(
        replace(body, markers=tuple(m for m in body.markers if MarkerRef(body.name, m.name) in acted_on))
        for body in scene.bodies
    )
    changed: Any = {"coordinates": coordinates, "outputs": (), "bodies": bodies}
    return path, replace(scene, **changed)


def chain_count(case: str) -> int:
    """The number of bodies of a chain, from its name."""
    return int(case.removeprefix("chain_"))


def _numbers(values: Array) -> str:
    return " ".join(repr(float(x)) for x in values)
