"""The registry of joints: one line for each name that a specification may give as `kind`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from derive.mechanics.multibody.joints.revolute import Revolute
from derive.mechanics.multibody.joints.translational import Translational
from derive.mechanics.multibody.joints.weld import Weld
from derive.registry import Registry

if TYPE_CHECKING:
    from derive.mechanics.multibody.joints.joint_type import JointType

_WELD = Weld()

JOINTS: Registry[JointType] = Registry(
    "joint",
    {
        "revolute": Revolute(),
        "weld": _WELD,
        "fixed": _WELD,
        "translational": Translational(),
    },
    doc="""The kinds of joints in the plane by their names, which are the values of `kind` in [joints.NAME].

    `derive.JOINTS.register(name, member)` adds one of your own, a subclass of `derive.extensions.JointType`; see
    `examples/joint_of_my_own.py`.

    Examples:
        >>> import derive
        >>> for name, joint in derive.JOINTS.items():
        ...     print(f"{name}: {joint.doc}")
        revolute: the markers coincide
        weld: the markers coincide and the relative rotation is constant
        fixed: the markers coincide and the relative rotation is constant
        translational: the second marker stays on a line through the first, and the relative rotation is constant
    """,
)
