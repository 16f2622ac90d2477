"""Kinds of bodies, whose equations are derived once, and instances of bodies, joints and forces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from derive.algebra import sp
from derive.mechanics.body import Body, ExactValues
from derive.mechanics.indexed_equations import IndexedEquations, derive_body
from derive.mechanics.multibody.constraints import constraints
from derive.mechanics.multibody.point_motion import RelativeMotion
from derive.spec.model.forces import SceneForce
from derive.spec.model.joints import Joint
from derive.spec.model.markers import MarkerRef

if TYPE_CHECKING:
    from derive.mechanics.motion.body_motion import Motion
    from derive.mechanics.multibody.bodies.body_type import Component
    from derive.mechanics.multibody.coordinates import CoordinateMap
    from derive.mechanics.multibody.forces.force_type import ForceType
    from derive.mechanics.multibody.joints.joint_type import JointType, PrescribedMotion
    from derive.mechanics.multibody.point_motion import PointMotion
    from derive.mechanics.terms import Constraint, EquationOfMotion, Intermediate, ModelConstant

KEPT = 32
"""The number of kinds, and of instances, whose equations are cached: studies derive mechanisms with equal bodies."""


@dataclass(frozen=True)
class BodyKind:
    """The equations of a free body in its own symbols; instances differ in the values of its constants alone.

    `body` is what they are derived from, with all values 0: which of its integrals vanish, and why, is what makes two
    bodies of one kind.
    """

    body: Body
    equations: IndexedEquations

    @property
    def motion(self) -> Motion:
        """The motion of the free body."""
        return self.body.motion


@dataclass(frozen=True)
class BodyInstance:
    """A component of a mechanism: an instance of a kind, by its number, with its coordinates in the mechanism.

    `complete`: outputs such as reactions and energies need the equations of the free body, and its inertia even where
    its motion is prescribed.
    """

    component: Component
    kind: int
    coordinates: CoordinateMap
    complete: bool = False

    @property
    def name(self) -> str:
        """The name of the component."""
        return self.component.name

    @property
    def moves(self) -> bool:
        """Whether coordinates move the instance; otherwise its motion is prescribed."""
        return bool(self.coordinates.rows or self.coordinates.is_carried)

    @property
    def has_inertia(self) -> bool:
        """Whether the equations contain the constants of the instance, such as its mass."""
        return self.moves or self.complete


@dataclass(frozen=True)
class JointInstance:
    """A joint that is a constraint: its markers are on instances or on the ground."""

    joint: Joint
    type: JointType
    drive: PrescribedMotion | None

    @property
    def multipliers(self) -> int:
        """The number of constraints, one for each row that the joint removes and one for its drive."""
        return len(self.type.removes) + (self.drive is not None)

    def constraints(
        self,
        first: PointMotion,
        second: PointMotion,
        drive: PrescribedMotion | None,
        rows: tuple[EquationOfMotion, ...],
    ) -> tuple[tuple[Intermediate, ...], tuple[Constraint, ...]]:
        """The intermediate quantities and the constraints of the joint and of a drive, for the motions of its markers.

        rows: those of the bodies whose factors in G are wanted.
        """
        return constraints(self.joint, self.type, RelativeMotion(first, second), drive, rows)


@dataclass(frozen=True)
class EliminatedJoint:
    """A joint that has eliminated coordinates of the body it supports, and is no constraint.

    `own` is the marker on that body, `known` the other one, whose motion is known.
    """

    joint: Joint
    type: JointType
    drive: PrescribedMotion | None
    own: MarkerRef
    known: MarkerRef


@dataclass(frozen=True)
class ForceInstance:
    """A force, torque or spring, with the markers of instances that it acts at, and the values of its keys."""

    element: SceneForce
    type: ForceType[Any]
    markers: tuple[MarkerRef, ...]
    values: Mapping[str, Any]


class BodyKinds:
    """The kinds of bodies collected so far; equal kinds are derived once."""

    def __init__(self) -> None:
        self.kinds: list[BodyKind] = []
        self._numbers: dict[Body, int] = {}

    def number(self, body: Body) -> int:
        """The number of the kind of a body; a new kind is derived and added."""
        form = _without_values(body)
        if (number := self._numbers.get(form)) is None:
            number = self._numbers[form] = len(self.kinds)
            self.kinds.append(_kind(form))
        return number


@lru_cache(KEPT)
def _kind(form: Body) -> BodyKind:
    return BodyKind(form, derive_body(form))


def _without_values(body: Body) -> Body:
    def plain(constants: tuple[ModelConstant, ...]) -> tuple[ModelConstant, ...]:
        return tuple(replace(c, value=sp.S.Zero) for c in constants)

    assert isinstance(body.values, ExactValues), "bodies of planar mechanisms have exact integrals"

    return replace(
        body,
        name="",
        doc="",
        frame_doc="",
        mass=sp.S.Zero,
        values=ExactValues(plain(body.values.every)),
        gravity=plain(body.gravity),
        parameters=(),
    )
