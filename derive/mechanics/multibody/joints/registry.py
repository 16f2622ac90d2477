"""The registry of joints: one line for each name that a specification may give as `kind`."""

from __future__ import annotations

from derive.mechanics.multibody.joints.joint_type import JointType
from derive.mechanics.multibody.joints.revolute import Revolute
from derive.mechanics.multibody.joints.translational import Translational
from derive.mechanics.multibody.joints.weld import Weld
from derive.registry import Registry

_WELD = Weld()

JOINTS: Registry[JointType] = Registry(
    "joint",
    {
        "revolute": Revolute(),
        "weld": _WELD,
        "fixed": _WELD,
        "translational": Translational(),
    },
)
