"""The classes with which a joint, a body, a force or an output is defined outside the package.

A joint is a subclass of JointType, which `derive.JOINTS.register("name", MyJoint())` adds to the kinds that a
specification may choose; bodies, forces and outputs likewise with BodyType and `derive.BODIES`, ForceType and
`derive.FORCES`, OutputType and `derive.OUTPUTS`.
A joint names the rows that it removes, or has RelativeRows of its own: functions of the displacement and the rotation
of its second marker relative to the first, as SymPy expressions, whose time derivatives follow. Forces are formulated
with the RelativeMotion between markers, outputs with the SceneMechanics of all bodies.

In space a joint is a SpatialJointType, a spring a SpatialSpringType with a function that gives its MarkerLoads, and an
output a SpatialOutputType with one that gives its SpatialComponents from the SpatialParts of the scene; the registries
are `derive.SPATIAL_JOINTS`, `derive.SPATIAL_SPRINGS` and `derive.SPATIAL_OUTPUTS`.
"""

from __future__ import annotations

from derive.mechanics.multibody.bodies.body_type import BodyType, Component, ComponentDamping, Constant, CrossSection
from derive.mechanics.multibody.bodies.rigid import marker_constants, rigid_component
from derive.mechanics.multibody.coordinates import CoordinateMap
from derive.mechanics.multibody.forces.force_type import ForceType, GeneralisedForce, define, force_terms, torque_terms
from derive.mechanics.multibody.joints.joint_type import Drawing, JointType
from derive.mechanics.multibody.joints.relative_rows import (
    ALONG_AXIS,
    ALONG_E1,
    ALONG_E2,
    NORMAL_TO_AXIS,
    ROTATION,
    Axes,
    RelativeRow,
)
from derive.mechanics.multibody.outputs.output_type import OutputComponent, OutputComponents, OutputType
from derive.mechanics.multibody.point_motion import PointMotion, RelativeMotion
from derive.mechanics.multibody.scene_mechanics import SceneMechanics
from derive.mechanics.multibody.space.forces import ActionLoads, MarkerLoad
from derive.mechanics.multibody.space.frame_motion import FrameMotion
from derive.mechanics.multibody.space.joints import Freedom, SpatialJointType
from derive.mechanics.multibody.space.output_parts import SpatialComponent, SpatialOutputType, SpatialParts
from derive.mechanics.multibody.space.springs import SpatialSpringType
from derive.mechanics.quantity import value as quantity_expression
from derive.spec.model.keys import Key, KeyType

__all__ = [
    "ALONG_AXIS",
    "ALONG_E1",
    "ALONG_E2",
    "NORMAL_TO_AXIS",
    "ROTATION",
    "ActionLoads",
    "Axes",
    "BodyType",
    "Component",
    "ComponentDamping",
    "Constant",
    "CoordinateMap",
    "CrossSection",
    "Drawing",
    "ForceType",
    "FrameMotion",
    "Freedom",
    "GeneralisedForce",
    "JointType",
    "Key",
    "KeyType",
    "MarkerLoad",
    "OutputComponent",
    "OutputComponents",
    "OutputType",
    "PointMotion",
    "RelativeMotion",
    "RelativeRow",
    "SceneMechanics",
    "SpatialComponent",
    "SpatialJointType",
    "SpatialOutputType",
    "SpatialParts",
    "SpatialSpringType",
    "define",
    "force_terms",
    "marker_constants",
    "quantity_expression",
    "rigid_component",
    "torque_terms",
]
