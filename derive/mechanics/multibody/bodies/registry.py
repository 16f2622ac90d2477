"""The registry of bodies: one line for each type that a specification may contain."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from derive.mechanics.multibody.bodies.beam import Beam
from derive.mechanics.multibody.bodies.rigid import Rigid
from derive.registry import Registry

if TYPE_CHECKING:
    from derive.mechanics.multibody.bodies.body_type import BodyType

BODIES: Registry[BodyType[Any]] = Registry(
    "body",
    {
        "rigid": Rigid(),
        "beam": Beam(),
    },
    doc="""The types of bodies in the plane by their names; the keys of [bodies.NAME] determine which one a body has.

    `derive.BODIES.register(name, member)` adds one of your own, a subclass of `derive.extensions.BodyType`.

    Examples:
        >>> import derive
        >>> list(derive.BODIES)
        ['rigid', 'beam']
    """,
)
