"""Forces and torques that joints, drives and springs exert."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from derive.algebra import sp
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.outputs.output_type import NamedElements, OutputComponent, OutputComponents, OutputType
from derive.spec.model.joints import Drive
from derive.spec.model.keys import Key, KeyType
from derive.spec.model.scene import Scene

if TYPE_CHECKING:
    from derive.mechanics.multibody.joints.relative_rows import RelativeRow
    from derive.mechanics.multibody.kinds import ForceInstance
    from derive.mechanics.multibody.scene_mechanics import Resultant, SceneMechanics


class Reaction(OutputType):
    """The force and the torque that a joint exerts on body 2, its drive included."""

    doc = "what a joint exerts on body 2, with its drive"
    labels = ("1", "2", "torque")
    counts_inertia = True
    keys = (Key("joint", KeyType.JOINT, "", "Name of the joint.", required=True),)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return two force components in the inertial frame, and the torque about the second marker."""
        return _resultant(scene.reaction(values["joint"]))

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the joint, and the axis of each component."""
        return _resultant_docs(f"of joint {values['joint']} on body 2")


class DriveForce(OutputType):
    """The torque or the force by which a drive prescribes the motion of its joint."""

    doc = "the torque or the force of a drive"
    counts_inertia = True
    keys = (Key("drive", KeyType.DRIVE, "", "Name of the drive.", required=True),)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return one component, whose virtual work is that of the drive on the relative coordinate of its joint."""
        drive = _drive(scene.scene, values["drive"])
        force = scene.drive_force(drive)
        return OutputComponents((OutputComponent("", _driven(scene.scene, drive).force_unit, force),))

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the drive, and whether it exerts a torque or a force."""
        drive = _drive(mechanism.scene, values["drive"])
        noun = "torque" if _driven(mechanism.scene, drive).unit == "rad" else "force"
        return (f"{noun} of drive {drive.name} on body 2",)


def _drive(scene: Scene, name: str) -> Drive:
    return next(drive for drive in scene.drives if drive.name == name)


def _driven(scene: Scene, drive: Drive) -> RelativeRow:
    """The relative motion that a drive prescribes."""
    driven = JOINTS[next(joint.kind for joint in scene.joints if joint.name == drive.joint)].driven
    assert driven is not None
    return driven


class SpringForce(OutputType):
    """The force and the torque that a spring exerts on its second marker."""

    doc = "what a spring with its damper exerts on its second marker"
    labels = ("1", "2", "torque")
    keys = (Key("spring", KeyType.SPRING, "", "Name of the spring.", required=True),)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return two force components in the inertial frame, and the torque."""
        spring = _spring(scene, values["spring"])
        second = spring.markers[-1]
        return _resultant(scene.force_on(spring, lambda marker: marker == second, scene.position(second)))

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the spring, its second marker, and the axis of each component."""
        second = _spring(mechanism, values["spring"]).markers[-1]
        return _resultant_docs(f"of spring {values['spring']} on {second}")


def _spring(mechanism: NamedElements, name: str) -> ForceInstance:
    return next(force for force in mechanism.forces if force.element.name == name)


def _resultant(of: Resultant) -> OutputComponents:
    """The components of a force and a torque, with units."""
    forces = [OutputComponent(str(k), "N", sp.expand(of.force[k - 1])) for k in (1, 2)]
    return OutputComponents((*forces, OutputComponent("torque", "N m", sp.expand(of.torque))))


def _resultant_docs(text: str) -> tuple[str, str, str]:
    """The descriptions of these components; `text` follows the noun."""
    return f"force {text} along e1", f"force {text} along e2", f"torque {text}"
