"""Forces and torques that joints, drives and springs exert."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.outputs.output_type import OutputComponent, OutputComponents, OutputType
from derive.mechanics.multibody.scene_mechanics import Resultant, SceneMechanics
from derive.spec.model.keys import Key, KeyType


class Reaction(OutputType):
    """The force and the torque that a joint exerts on body 2, its drive included."""

    doc = "what a joint exerts on body 2, with its drive"
    labels = ("1", "2", "torque")
    counts_inertia = True
    keys = (Key("joint", KeyType.JOINT, "", "Name of the joint.", required=True),)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return two force components in the inertial frame, and the torque about the second marker."""
        return _resultant(scene.reaction(values["joint"]), f"of joint {values['joint']} on body 2")


class DriveForce(OutputType):
    """The torque or the force by which a drive prescribes the motion of its joint."""

    doc = "the torque or the force of a drive"
    counts_inertia = True
    keys = (Key("drive", KeyType.DRIVE, "", "Name of the drive.", required=True),)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return one component, whose virtual work is that of the drive on the relative coordinate of its joint."""
        drive = next(d for d in scene.scene.drives if d.name == values["drive"])
        driven = JOINTS[next(j.kind for j in scene.scene.joints if j.name == drive.joint)].driven
        assert driven is not None
        doc = f"{'torque' if driven.unit == 'rad' else 'force'} of drive {drive.name} on body 2"
        return OutputComponents((OutputComponent("", driven.force_unit, doc, scene.drive_force(drive)),))


class SpringForce(OutputType):
    """The force and the torque that a spring exerts on its second marker."""

    doc = "what a spring with its damper exerts on its second marker"
    labels = ("1", "2", "torque")
    keys = (Key("spring", KeyType.SPRING, "", "Name of the spring.", required=True),)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return two force components in the inertial frame, and the torque."""
        spring = next(f for f in scene.forces if f.element.name == values["spring"])
        second = spring.markers[-1]
        on_second = scene.force_on(spring, lambda marker: marker == second, scene.position(second))
        return _resultant(on_second, f"of spring {values['spring']} on {second}")


def _resultant(of: Resultant, text: str) -> OutputComponents:
    """The components of a force and a torque, with units and descriptions."""
    forces = [OutputComponent(str(k), "N", f"force {text} along e{k}", sp.expand(of.force[k - 1])) for k in (1, 2)]
    return OutputComponents((*forces, OutputComponent("torque", "N m", f"torque {text}", sp.expand(of.torque))))
