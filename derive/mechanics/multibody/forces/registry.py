"""The registry of forces, one line for each kind; the kinds of a section are the values that `kind` may have there."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from derive.mechanics.multibody.forces.bushing import BushingForce
from derive.mechanics.multibody.forces.force import ForceAtMarker
from derive.mechanics.multibody.forces.linear_spring import LinearSpring
from derive.mechanics.multibody.forces.rotational_spring import RotationalSpring
from derive.mechanics.multibody.forces.torque import TorqueAtMarker
from derive.registry import Registry
from derive.spec.model.forces import SceneForce
from derive.spec.model.scene import Scene

if TYPE_CHECKING:
    from derive.mechanics.multibody.forces.force_type import ForceType

FORCES: Registry[ForceType[Any]] = Registry(
    "force",
    {
        "force": ForceAtMarker(),
        "torque": TorqueAtMarker(),
        "linear": LinearSpring(),
        "rotational": RotationalSpring(),
        "bushing": BushingForce(),
    },
    doc="""The kinds of forces, torques and springs in the plane by their names, which are the values of `kind`.

    `derive.FORCES.register(name, member)` adds one of your own, a subclass of `derive.extensions.ForceType`; see
    `examples/force_of_my_own.py`.

    Examples:
        >>> import derive
        >>> {name: force.section for name, force in derive.FORCES.items()}
        {'force': 'forces', 'torque': 'torques', 'linear': 'springs', 'rotational': 'springs', 'bushing': 'springs'}
    """,
)

DEFAULT_KINDS = {"forces": "force", "torques": "torque", "springs": "linear"}
"""The sections of forces, with the kind of an element that specifies none."""


def kinds(section: str) -> dict[str, ForceType[Any]]:
    """The kinds of a section, which are the values that `kind` may have there, with their types."""
    return {kind: force_type for kind, force_type in FORCES.items() if force_type.section == section}


def elements(scene: Scene) -> Iterator[tuple[SceneForce, ForceType[Any]]]:
    """The forces, torques and springs of a scene with their types. Raises UnknownNameError."""
    for element in (*scene.forces, *scene.torques, *scene.springs):
        yield element, FORCES[element.kind]
