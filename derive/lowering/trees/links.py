"""The links of trees of rigid bodies: a link for each single motion that a joint leaves, and one for each free body.

A link moves against the one before it by a rotation about, and a displacement along, its axis, which is the z axis of
its frame. The frame of the last link of a body is that of its marker of the joint, turned so that z is the axis; bodies
whose joint leaves several motions have links without mass before it. All numbers are exact, or expressions of
parameters.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property

from derive.algebra import sp
from derive.errors import Problem, SpecError
from derive.lowering.trees.exact_numbers import (
    ZERO,
    Exact,
    Matrix,
    Vector,
    applied,
    exact,
    plus,
    product,
    scalar_product,
    transposed,
)
from derive.lowering.trees.row_loads import refused_actions
from derive.mechanics.axes import AXES
from derive.mechanics.multibody.kinds import BodyInstance
from derive.mechanics.multibody.space.constraints import lead
from derive.mechanics.multibody.space.frame_motion import fixed_axes, fixed_frame
from derive.mechanics.multibody.space.joint_coordinate import AXES_OF
from derive.mechanics.multibody.space.joint_elimination import SpatialSupport, joint_coordinates
from derive.mechanics.multibody.space.joints import SpatialEliminatedJoint
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.mechanics.symbols import Family, identity
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.spatial_bodies import SpatialRigidBody

ONE = Fraction(1)
AT_REST: Vector = (ZERO, ZERO, ZERO)
UNIT: Matrix = ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE))
NO_INERTIA: Matrix = (AT_REST, AT_REST, AT_REST)
TURNED: Mapping[int, Matrix] = {
    0: ((ZERO, ZERO, ONE), (ONE, ZERO, ZERO), (ZERO, ONE, ZERO)),
    1: ((ZERO, ONE, ZERO), (ZERO, ZERO, ONE), (ONE, ZERO, ZERO)),
    2: UNIT,
}
"""The rotations that turn z to an axis, by its number."""


@dataclass(frozen=True)
class LinkInertia:
    """The mass, first moment (3,) and inertia (3, 3) of bodies about a point."""

    mass: Exact = ZERO
    moment: Vector = AT_REST
    tensor: Matrix = NO_INERTIA

    def __add__(self, other: LinkInertia) -> LinkInertia:
        tensor = tuple(plus(*rows) for rows in zip(self.tensor, other.tensor, strict=True))
        return LinkInertia(self.mass + other.mass, plus(self.moment, other.moment), tensor)

    def placed(self, at: BodyPlace) -> LinkInertia:
        """The inertia about the origin of the frame in which the body has a place."""
        A, r = at.attitude, at.origin
        s = applied(A, self.moment)
        g = plus(plus(s, s), tuple(self.mass * x for x in r))  # m r^2 + 2 r . s = r . g
        trace, tensor = scalar_product(r, g), product(product(A, self.tensor), transposed(A))
        moved = tuple(
            tuple(tensor[i][j] + (trace if i == j else ZERO) - (r[i] * g[j] + r[j] * g[i]) / 2 for j in range(3))
            for i in range(3)
        )
        return LinkInertia(self.mass, plus(s, tuple(self.mass * x for x in r)), moved)


@dataclass(frozen=True)
class BodyPlace:
    """The place of a body: the number of its link, -1 for the ground, its axes there (3, 3), and its origin (3,)."""

    link: int
    attitude: Matrix = UNIT
    origin: Vector = AT_REST

    def at(self, axes: Matrix, position: Vector) -> BodyPlace:
        """The place of a marker with these axes and this position in the frame of the body."""
        return BodyPlace(self.link, product(self.attitude, axes), plus(self.origin, applied(self.attitude, position)))


@dataclass(frozen=True)
class TreeLink:
    """A link of a tree.

    parent: the number of the link before it, -1 for the ground. axes (3, 3): those of its frame in that link, before it
    moves; offset (3,): its origin there. turns: 1 if it turns about its axis by its coordinate, else 0; advances: how
    far it is displaced along its axis for a unit of its coordinate. coordinate, row: their indices, of a free body
    those of the first ones. inertia: that of its bodies about its origin, none of a link before the last one of a body.
    ball: of the three links of a joint that leaves all rotations the number of its axis, else -1: these turn against
    the inertial frame, about the axes of the body, by the quaternion from `coordinate` on.
    """

    parent: int
    coordinate: int
    row: int
    axes: Matrix = UNIT
    offset: Vector = AT_REST
    turns: Fraction = ZERO
    advances: Exact = ZERO
    is_free: bool = False
    inertia: LinkInertia = field(default_factory=LinkInertia)
    ball: int = -1

    @property
    def follows(self) -> Fraction:
        """1 if it turns with the link before it, 0 if it is the first of a ball."""
        return ZERO if self.ball == 0 else ONE

    @property
    def is_relative(self) -> Fraction:
        """1 if its rotation is against the link before it, 0 if it is one of a ball."""
        return ONE if self.ball < 0 else ZERO


@dataclass(frozen=True)
class Tree:
    """The links of a mechanism, each followed by all that hangs on it, and the places of its bodies by their names."""

    links: tuple[TreeLink, ...]
    bodies: Mapping[str, BodyPlace]

    @cached_property
    def last(self) -> list[int]:
        """The last of the links that hang on each link, or the link itself: they follow it."""
        result = list(range(len(self.links)))
        for number in reversed(range(len(self.links))):
            if (parent := self.links[number].parent) >= 0:
                result[parent] = max(result[parent], result[number])
        return result

    @property
    def is_chain(self) -> bool:
        """Whether each link hangs on the one before it."""
        return all(link.parent == number - 1 for number, link in enumerate(self.links))


def tree_of(mechanism: SpatialMechanism) -> Tree:
    """The tree of a mechanism whose bodies are all in trees. Raises SpecError with all that is none."""
    problems = tuple(Problem("scene.lowering", f'{text}: write lowering = "flat"') for text in refusals(mechanism))
    if problems:
        raise SpecError(problems)
    made = _Links(mechanism)
    for name in mechanism.order:
        made.add(mechanism.instances_by_name[name])
    return _depth_first(made.links, made.bodies)


def _depth_first(links: Sequence[TreeLink], bodies: Mapping[str, BodyPlace]) -> Tree:
    """The tree with each link followed by all that hangs on it."""
    hanging: dict[int, list[int]] = {}
    for number, link in enumerate(links):
        hanging.setdefault(link.parent, []).append(number)
    order, waiting = list[int](), [*reversed(hanging.get(-1, []))]
    while waiting:
        order.append(waiting.pop())
        waiting += reversed(hanging.get(order[-1], []))
    place = {-1: -1, **{old: new for new, old in enumerate(order)}}
    moved = (replace(links[old], parent=place[links[old].parent]) for old in order)
    return Tree(tuple(moved), {name: replace(of, link=place[of.link]) for name, of in bodies.items()})


class _Links:
    """The links and the places of bodies so far."""

    def __init__(self, mechanism: SpatialMechanism) -> None:
        self.mechanism, self.links, self.bodies = mechanism, list[TreeLink](), dict[str, BodyPlace]()
        self.coordinates = {c.q.name: k for k, c in enumerate(mechanism.coordinates)}
        self.rows = {row.name: k for k, row in enumerate(mechanism.rows)}
        self.joints = {j.own.body: j for j in mechanism.eliminated_joints}

    def add(self, instance: BodyInstance) -> None:
        """Add the links of a body; one that is fixed to another has the link of this one."""
        of, joint = instance.coordinates, self.joints.get(instance.name)
        rows = of.rows
        row, first = (self.rows[rows[0].name], self.coordinates[of.coordinates[0].q.name]) if rows else (0, 0)
        if joint is None:
            self.links.append(TreeLink(-1, first, row, is_free=True))
            place = BodyPlace(len(self.links) - 1)
        else:
            before = marker_place(self.mechanism, self.bodies, joint.known)
            moved = [*self._moved(instance, joint, before, first, row)]
            self.links += moved
            axes, _ = marker_in_body(instance, joint.own.marker)
            turn = TURNED[2]
            if moved:
                before, turn = BodyPlace(len(self.links) - 1), self._last_turn
            if moved and moved[-1].ball >= 0:
                axes = UNIT  # its quaternion is that of the frame of the body
            place = before.at(product(transposed(turn), transposed(axes)), AT_REST)
        self.bodies[instance.name] = place
        if place.link >= 0:
            own = self.links[place.link]
            self.links[place.link] = replace(own, inertia=own.inertia + _inertia(instance).placed(place))

    def _moved(
        self, instance: BodyInstance, joint: SpatialEliminatedJoint, before: BodyPlace, first: int, row: int
    ) -> Iterator[TreeLink]:
        """Yield a link for each motion of the joint of a body."""
        free = joint.type.free(joint.joint) or ()
        motions, is_ball = joint_coordinates(joint.type, free, self._support(instance, joint))
        turned, count = UNIT, len(self.links)
        for k, c in enumerate(motions):
            turn = TURNED[AXES_OF[c.motion]]
            at = before.at(product(transposed(turned), turn), AT_REST)
            advances = (
                exact(c.along, {of.symbol: of.value for of in self.mechanism.constants}) if c.is_rotation else ONE
            )
            turns = ONE if c.is_rotation else ZERO
            yield TreeLink(at.link, first + k, row + k, at.attitude, at.origin, turns, advances)
            before, turned = BodyPlace(count + k), turn
        for axis in range(3) if is_ball else ():
            k = len(motions)
            yield TreeLink(before.link, first + k, row + k + axis, TURNED[axis], before.origin, turns=ONE, ball=axis)
            before, turned = BodyPlace(count + k + axis), TURNED[axis]
        self._last_turn = turned

    @staticmethod
    def _support(instance: BodyInstance, joint: SpatialEliminatedJoint) -> SpatialSupport:
        """The support of a body by a joint, without the motion of the marker that it hangs on."""
        return SpatialSupport(
            body=instance.name,
            motion=instance.component.body.motion,
            own_axes=instance.component.sections[joint.own.marker].axes,
            known=fixed_frame(sp.zeros(3, 1), fixed_axes()),
            attached_to="",
            sign=joint.sign,
            drive=None,
            lead=lead(joint.joint),
        )


def marker_place(mechanism: SpatialMechanism, bodies: Mapping[str, BodyPlace], marker: MarkerRef) -> BodyPlace:
    """The place of a marker of a body that has one, or of the ground."""
    if marker.body == GROUND:
        frame, values = mechanism.ground[marker.marker], {c.symbol: c.value for c in mechanism.constants}
        return BodyPlace(-1, _matrix(frame.axes, values), _vector(frame.position, values))
    return bodies[marker.body].at(*marker_in_body(mechanism.instances_by_name[marker.body], marker.marker))


def marker_in_body(instance: BodyInstance, marker: str) -> tuple[Matrix, Vector]:
    """The axes and the position of a marker in the frame of its body, whose origin is its marker of the joint."""
    section = instance.component.sections[marker]
    values = {c.symbol: c.value for c in section.point.coefficients}
    return _matrix(section.axes, values), _vector(section.point.position, values)


def _inertia(instance: BodyInstance) -> LinkInertia:
    """The inertia of a body about its origin in its frame."""
    values = {
        (of.family, of.components): exact(c.value)
        for c in instance.component.body.constants
        if (of := identity(c.symbol)).owner == ""
    }
    moment = tuple(values.get((Family.C1, (k,)), ZERO) for k in AXES)
    tensor = tuple(tuple(values.get((Family.C3, (min(a, b), max(a, b))), ZERO) for b in AXES) for a in AXES)
    return LinkInertia(values.get((Family.MASS, ()), ZERO), moment, tensor)


def refusals(mechanism: SpatialMechanism) -> Iterator[str]:
    """Yield what a mechanism has that loops along trees do not have."""
    scene, only = mechanism.scene, "loops in relative coordinates have"
    yield from (
        f"{only} no bodies whose motion is prescribed, and drive {joint.drive.name} prescribes one"
        for joint in mechanism.eliminated_joints
        if joint.drive and not joint.keeps_coordinate
    )
    yield from (
        f"{only} rigid bodies alone, and {body.name} is flexible"
        for body in scene.bodies
        if not isinstance(body, SpatialRigidBody)
    )
    for name in refused_actions(mechanism):
        yield f"{only} no loads in joints without a coordinate along or about their axis, and {name} is one"


def _matrix(values: sp.Matrix, numbers: Mapping[sp.Symbol, sp.Expr]) -> Matrix:
    return tuple(tuple(exact(values[i, j], numbers) for j in range(3)) for i in range(3))


def _vector(values: sp.Matrix, numbers: Mapping[sp.Symbol, sp.Expr]) -> Vector:
    return tuple(exact(x, numbers) for x in values)
