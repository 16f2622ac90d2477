"""What a joint, a body or a force from outside the package is written with.

A joint is a subclass of JointType, which `derive.JOINTS.register("name", MyJoint())` adds to the kinds that a
specification may choose; bodies and forces likewise with BodyType and `derive.BODIES`, ForceType and `derive.FORCES`.
The constraints of a joint are formulated with the RelativeMotion between its markers: displacement and rotation, each
with two time derivatives, as SymPy expressions.
"""

from __future__ import annotations

from derive.mechanics.multibody.bodies.body_type import BodyType, Component, ComponentDamping, Constant, CrossSection
from derive.mechanics.multibody.bodies.rigid import marker_constants, rigid_component
from derive.mechanics.multibody.coordinates import CoordinateMap
from derive.mechanics.multibody.forces.force_type import ForceType, GeneralisedForce, define, force_terms, torque_terms
from derive.mechanics.multibody.joints.joint_type import (
    Drawing,
    DrivenCoordinate,
    JointEquations,
    JointType,
    Multiplier,
    PrescribedMotion,
    Support,
)
from derive.mechanics.multibody.keys import Key, KeyType
from derive.mechanics.multibody.point_motion import PointMotion, RelativeMotion
from derive.mechanics.quantity import value as quantity_expression

__all__ = [
    "BodyType",
    "Component",
    "ComponentDamping",
    "Constant",
    "CoordinateMap",
    "CrossSection",
    "Drawing",
    "DrivenCoordinate",
    "ForceType",
    "GeneralisedForce",
    "JointEquations",
    "JointType",
    "Key",
    "KeyType",
    "Multiplier",
    "PointMotion",
    "PrescribedMotion",
    "RelativeMotion",
    "Support",
    "define",
    "force_terms",
    "marker_constants",
    "quantity_expression",
    "rigid_component",
    "torque_terms",
]
