"""The base class of the types of bodies, with keys, components and joint elimination, and the component of a body."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from derive.algebra import sp
from derive.spec.model.joints import Joint
from derive.spec.model.keys import Key
from derive.spec.model.markers import MarkerRef
from derive.spec.model.planar_bodies import SceneBody
from derive.spec.model.quantity import Quantity
from derive.spec.model.spatial_beam import SpatialBody

if TYPE_CHECKING:
    from derive.mechanics.body import Body
    from derive.mechanics.motion.material_points import MaterialPoint
    from derive.mechanics.terms import ModelConstant


@cache
def no_rotation() -> sp.ImmutableMatrix:
    """The axes of a marker frame that is not rotated against its body."""
    return sp.ImmutableMatrix(sp.eye(3))


@dataclass(frozen=True)
class CrossSection:
    """A cross-section of a body: its material point, and its rotation by each assumed mode (none in a rigid body).

    In space it is the frame of a marker, with the axes of this frame in that of the undeformed body as columns of
    `axes`, and its rotation vectors by unit amplitudes of the modes, `twists`; `second_twists` (N, N) are those of
    second order, s_ij of 1/2 sum alpha_i alpha_j s_ij, empty at first order.
    """

    point: MaterialPoint
    rotations: tuple[ModelConstant, ...] = ()
    axes: sp.ImmutableMatrix = field(default_factory=no_rotation)
    twists: tuple[sp.ImmutableMatrix, ...] = ()
    second_twists: tuple[tuple[sp.ImmutableMatrix, ...], ...] = ()


@dataclass(frozen=True)
class Component:
    """A body with its own coordinates, whose names begin with `name`; the names of its constants begin with `group`.

    The equal pieces of a rod share their constants, and therefore `body`. `sections` are the cross-sections of the
    component by their names; `markers` are the names of those that the specification declares, for the body
    `specified`.
    """

    name: str
    group: str
    body: Body
    sections: Mapping[str, CrossSection]
    markers: tuple[str, ...]
    specified: str

    @property
    def point_constants(self) -> tuple[ModelConstant, ...]:
        """The constants of the cross-sections."""
        return tuple(c for s in self.sections.values() for c in (*s.point.coefficients, *s.rotations))


@dataclass(frozen=True)
class ComponentDamping:
    """Damping of the deformation of a body in several components, which it couples: forces - B alphadot, N.

    Amplitudes are counted through the components; `entries` are those of B with i <= j that do not vanish, as symbols
    of `constants`.
    """

    components: tuple[str, ...]
    entries: Mapping[tuple[int, int], sp.Symbol]
    constants: tuple[ModelConstant, ...]


B = TypeVar("B", bound=SceneBody | SpatialBody)


@dataclass(frozen=True)
class Constant:
    """A physical constant of a body that may be a run-time parameter: what it is, and whether it must be positive."""

    value: Quantity | None
    doc: str
    positive: bool = False


class BodyType(ABC, Generic[B]):
    """A type of body in a mechanism. Subclasses are registered in `registry.BODIES`.

    doc: a description, in a clause; identifying_keys: a table with one of these keys describes a body of this type
    (none for the rigid body, which all other tables describe); keys: the keys of its table besides `markers` and
    `start`; empty for bodies whose tables the specification layer defines itself.
    """

    doc: ClassVar[str]
    identifying_keys: ClassVar[tuple[str, ...]] = ()
    keys: ClassVar[tuple[Key, ...]] = ()

    @abstractmethod
    def components(self, body: B, gravity: tuple[ModelConstant, ...]) -> tuple[Component, ...]:
        """Return the components of a body as bodies of the equations of motion, before joints constrain them."""

    @abstractmethod
    def constants(self, body: B) -> Iterator[Constant]:
        """Return the constants that may be run-time parameters, in the order in which parameters are listed."""

    def about(self, body: B, marker: str, gravity: tuple[ModelConstant, ...]) -> Component | None:
        """The body with its origin O in a marker, for joints that eliminate coordinates; None if it keeps all."""
        return None

    def missing(self, body: B) -> tuple[str, ...]:
        """The keys that the body needs to move freely and does not have."""
        return ()

    def joints(self, body: B) -> tuple[Joint, ...]:
        """The joints between the components of the body."""
        return ()

    def damping(self, body: B) -> ComponentDamping | None:
        """The damping of the deformation that acts between the components of the body; None if there is none."""
        return None

    def forces(self, body: B) -> tuple[Any, ...]:
        """The forces, in space torques as well, that loads of the body exert on points of its components."""
        return ()

    def located(self, body: B, marker: str) -> MarkerRef:
        """The component that a marker lies on, and the name of the marker there."""
        return MarkerRef(body.name, marker)

    def note(self, body: B) -> str:
        """A sentence on the body for users of the generated code; empty if there is nothing to be noted."""
        return ""
